#include "tools/command/tune_variables.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/parameter_range.hpp"

namespace hb::tools {
namespace {

constexpr double largest = std::numeric_limits<double>::max();

// The scene with one number replaced must be a scene, turning through or not.
void require_scene(const SceneSource& source, const std::string& path, double value) {
  try {
    (void)source.with({number_override(path, value)});
  } catch (const ObstructedLinkage&) {  // an infeasible design
  }
}

void require_mechanism(const char* flag, const std::string& path) {
  if (path.starts_with("analysis.") || path.starts_with("units."))
    throw UsageError(fmt::format("{}: found {}, allowed: numbers of the mechanism", flag, path));
}

void add_ties(const TuneFlags& flags, const SceneSource& source, std::vector<TuneVariable>& variables) {
  for (const std::string& text : flags.tie) {
    const NamedRange tie = named_range("--tie", text);
    const std::size_t star = tie.range.rfind('*');
    const bool scaled = star != std::string::npos && star > 0;
    TiedNumber tied{tie.path, 1};
    const std::string path = scaled ? tie.range.substr(star + 1) : tie.range;
    if (scaled)
      tied.factor = number_flag("--tie", tie.range.substr(0, star), -largest, largest, "PATH=PATH or PATH=FACTOR*PATH");
    const auto leader = std::ranges::find(variables, path, &TuneVariable::path);
    if (leader == variables.end())
      throw UsageError(fmt::format("--tie: found \"{}\", allowed: PATH=FACTOR*VARIED with one of --vary, {}", text,
                                   fmt::join(flags.vary, ", ")));
    for (const TuneVariable& variable : variables) {
      bool taken = variable.path == tie.path;
      for (const TiedNumber& other : variable.tied) taken = taken || other.path == tie.path;
      if (taken) throw UsageError(fmt::format("--tie: found {}, which is varied or tied already", tie.path));
    }
    require_mechanism("--tie", tie.path);
    (void)source.value(tie.path);
    leader->tied.push_back(tied);
  }
}

}  // namespace

std::pair<double, double> bounds_flag(const std::string& flag, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string allowed = "FROM:TO, two finite numbers with FROM < TO";
  if (colon == std::string::npos)
    throw UsageError(fmt::format("{}: found \"{}\", a single value; allowed: {}", flag, text, allowed));
  const double a = number_flag(flag, text.substr(0, colon), -largest, largest, allowed);
  const double b = number_flag(flag, text.substr(colon + 1), -largest, largest, allowed);
  if (a == b) throw UsageError(fmt::format("{}: found \"{}\", an empty range; allowed: {}", flag, text, allowed));
  if (!(a < b) || !std::isfinite(b - a))
    throw UsageError(
        fmt::format("{}: found \"{}\", which runs backwards or is too wide; allowed: {}", flag, text, allowed));
  return {a, b};
}

bool is_speed(const TuneVariable& variable) { return variable.path == range_from || variable.path == range_to; }

void start_at(TuneVariable& variable, double value, Remarks& remarks) {
  variable.start = std::clamp(value, variable.lower, variable.upper);
  if (variable.start == value) return;
  variable.moved_from = value;
  remarks.push_back(fmt::format("{} = {:g} lies outside {:g} to {:g}; the search starts at {:g}", variable.path, value,
                                variable.lower, variable.upper, variable.start));
}

std::vector<TuneVariable> tune_variables(const TuneFlags& flags, const SceneSource& source, Remarks& remarks) {
  std::vector<TuneVariable> result;
  for (const std::string& text : flags.vary) {
    const NamedRange range = named_range("--vary", text);
    const auto [a, b] = bounds_flag("--vary " + range.path, range.range);
    TuneVariable variable{range.path, a, b, a, std::nullopt, {}};
    for (const TuneVariable& other : result)
      if (other.path == range.path) throw UsageError(fmt::format("--vary: found {} twice, allowed: once", range.path));
    require_mechanism("--vary", range.path);
    if (!is_speed(variable)) start_at(variable, source.value(range.path), remarks);
    result.push_back(std::move(variable));
  }
  add_ties(flags, source, result);
  // Conditions between numbers (a wall within its tube) are the search's business; each alone must be possible at one
  // end at least.
  for (const TuneVariable& variable : result) {
    if (is_speed(variable)) continue;
    try {
      require_scene(source, variable.path, variable.lower);
    } catch (const SceneError& problem) {
      require_scene(source, variable.path, variable.start);
      if (variable.lower <= 0)
        throw UsageError(fmt::format("--vary {}={:g}:{:g}: its lower bound makes no scene: {}", variable.path,
                                     variable.lower, variable.upper, problem.what()));
    }
  }
  return result;
}

}  // namespace hb::tools
