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
#include "tools/command/range_units.hpp"

namespace hb::tools {
namespace {

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

// What a bare speed is in: that of --over, of the speed flags or of the scene.
std::string speed_axis(const TuneFlags& flags, const SceneSource& source) {
  if (!flags.over.empty()) return flags.over.starts_with("omega") ? "omega" : "rpm";
  if (!flags.rpm.empty() || !flags.omega.empty()) return flags.rpm.empty() ? "omega" : "rpm";
  const std::vector<std::string> paths = source.numeric_paths();
  const auto in_omega = [](const std::string& path) { return path.starts_with("analysis.omega"); };
  return std::ranges::any_of(paths, in_omega) ? "omega" : "rpm";
}

void add_ties(const TuneFlags& flags, const SceneSource& source, std::vector<TuneVariable>& variables) {
  for (const std::string& text : flags.tie) {
    const NamedRange tie = named_range("--tie", text, "PATH=PATH or PATH=FACTOR*PATH, as in CD.J=AB.J");
    const std::size_t star = tie.range.rfind('*');
    const bool scaled = star != std::string::npos && star > 0;
    TiedNumber tied{tie.path, 1};
    const std::string path = scaled ? tie.range.substr(star + 1) : tie.range;
    if (scaled)
      tied.factor = number_flag("--tie", tie.range.substr(0, star), -largest_number, largest_number,
                                "PATH=PATH or PATH=FACTOR*PATH");
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

// A second moment that changes while area and mass stay: no section does that.
void remark_on_second_moments(const std::vector<TuneVariable>& variables, Remarks& remarks) {
  const auto changed = [&](const std::string& path) {
    return std::ranges::any_of(variables, [&](const TuneVariable& variable) {
      return variable.path == path || std::ranges::find(variable.tied, path, &TiedNumber::path) != variable.tied.end();
    });
  };
  for (const TuneVariable& variable : variables) {
    if (!variable.path.ends_with(".J")) continue;
    const std::string link = variable.path.substr(0, variable.path.size() - 2);
    if (changed(link + ".area")) continue;
    remarks.push_back(
        fmt::format("{} varies while area and mass stay as the scene gives them; of a link with `section`, its height "
                    "changes all three",
                    variable.path));
    return;
  }
}

}  // namespace

std::pair<double, double> bounds_flag(const std::string& flag, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string allowed = "FROM:TO, two finite numbers with FROM < TO";
  if (colon == std::string::npos)
    throw UsageError(fmt::format("{}: found \"{}\", a single value; allowed: {}", flag, text, allowed));
  const double a = number_flag(flag, text.substr(0, colon), -largest_number, largest_number, allowed);
  const double b = number_flag(flag, text.substr(colon + 1), -largest_number, largest_number, allowed);
  if (a == b) throw UsageError(fmt::format("{}: found \"{}\", an empty range; allowed: {}", flag, text, allowed));
  if (!(a < b) || !std::isfinite(b - a))
    throw UsageError(
        fmt::format("{}: found \"{}\", which runs backwards or is too wide; allowed: {}", flag, text, allowed));
  return {a, b};
}

bool is_speed_range(const TuneVariable& variable) { return variable.path == range_from || variable.path == range_to; }

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
    const NamedRange range = named_range("--vary", text, "PATH=FROM:TO, as in AB.J=20:200");
    const std::string flag = "--vary " + range.path;
    const bool speed = range.path == range_from || range.path == range_to;
    const std::string path = speed ? speed_axis(flags, source) : range.path;
    const auto [a, b] = bounds_flag(flag, plain_range(flag, range.range, ThirdNumber::step, source, path));
    TuneVariable variable{range.path, a, b, a, std::nullopt, {}};
    for (const TuneVariable& other : result)
      if (other.path == range.path) throw UsageError(fmt::format("--vary: found {} twice, allowed: once", range.path));
    require_mechanism("--vary", range.path);
    if (!is_speed_range(variable)) start_at(variable, source.value(range.path), remarks);
    result.push_back(std::move(variable));
  }
  add_ties(flags, source, result);
  remark_on_second_moments(result, remarks);
  // Conditions between numbers (a wall within its tube) are the search's business; each alone must be possible at one
  // end at least.
  for (const TuneVariable& variable : result) {
    if (is_speed_range(variable)) continue;
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
