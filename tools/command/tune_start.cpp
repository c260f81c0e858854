#include "tools/command/tune_start.hpp"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "hb/analysis/linkage_analysis.hpp"
#include "tools/command/command.hpp"

namespace hb::tools {

void close_start(TuneTask& task, Remarks& remarks) {
  std::string obstruction;
  const auto closes = [&](const std::vector<double>& x) {
    try {
      Settings settings;
      settings.modes = 1;
      (void)make_model(task.family.scene(numbers_at(task, x)), settings);
      return true;
    } catch (const ObstructedLinkage& problem) {
      if (obstruction.empty()) obstruction = problem.what();
    }
    return false;
  };
  if (closes(start_of(task))) return;
  // The first that closes of evenly spread designs: fractions of k/g, k/g^2, ... with g^(n+1) = g + 1 (M. Roberts'
  // additive recurrence).
  constexpr int count = 400;
  const std::size_t n = task.variables.size();
  double g = 2;
  for (int k = 0; k < 60; ++k) g = std::pow(1 + g, 1.0 / static_cast<double>(n + 1));
  std::optional<std::vector<double>> found;
  for (int k = 0; k < count && !found; ++k) {
    std::vector<double> x;
    for (const TuneVariable& variable : task.variables) {
      const double u = std::fmod(0.5 + k * std::pow(g, -static_cast<double>(x.size() + 1)), 1.0);
      x.push_back(variable.lower + u * (variable.upper - variable.lower));
    }
    try {
      if (closes(x)) found = std::move(x);
    } catch (const SceneError&) {  // no possible scene
    }
  }
  if (!found)
    throw UsageError(
        fmt::format("--vary: found no design within the bounds whose linkage closes, of {} looked at ({}); allowed: "
                    "bounds with some",
                    count, obstruction));
  std::string start;
  for (std::size_t i = 0; i < n; ++i) {
    TuneVariable& variable = task.variables[i];
    if (is_speed_range(variable)) continue;
    if (!variable.moved_from) variable.moved_from = variable.start;
    variable.start = (*found)[i];
    start += fmt::format("{}{} = {:.6g}", start.empty() ? "" : ", ", variable.path, variable.start);
  }
  remarks.push_back(
      fmt::format("the linkage does not close at the start; the search starts from {}, where it does", start));
}

void start_speeds(TuneTask& task, Remarks& remarks) {
  double lowest_to = task.span.to / task.speed_unit, highest_from = task.span.from / task.speed_unit;
  bool any = false;
  for (TuneVariable& variable : task.variables) {
    if (!is_speed_range(variable)) continue;
    any = true;
    const bool from = variable.path == range_from;
    if (!(variable.lower > 0))
      throw UsageError(fmt::format("--vary: found {} from {:g}, allowed: speeds > 0", variable.path, variable.lower));
    start_at(variable, (from ? task.span.from : task.span.to) / task.speed_unit, remarks);
    (from ? highest_from : lowest_to) = from ? variable.upper : variable.lower;
  }
  if (any && !(highest_from < lowest_to))
    throw UsageError(
        fmt::format("--vary: found speed ranges from {:g} to {:g}, allowed: from below to", highest_from, lowest_to));
}

}  // namespace hb::tools
