#include "hb/analysis/tune/tune_problem.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "hb/analysis/tune/tune_report.hpp"
#include "hb/analysis/tune/tune_search.hpp"

namespace hb {
namespace {

bool is_speed(const TuneVariable& variable) { return variable.path == range_from || variable.path == range_to; }

}  // namespace

Numbers numbers_at(const TuneTask& task, const std::vector<double>& x) {
  Numbers numbers;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (is_speed(task.variables[i])) continue;
    numbers.push_back({task.variables[i].path, x[i]});
    for (const TiedNumber& tied : task.variables[i].tied) numbers.push_back({tied.path, tied.factor * x[i]});
  }
  return numbers;
}

std::vector<StartChange> start_changes(const TuneTask& task) {
  std::vector<StartChange> changes;
  for (const TuneVariable& variable : task.variables) {
    if (variable.moved_from && *variable.moved_from != variable.start)
      changes.push_back({variable.path, variable.start, *variable.moved_from, false});
    for (const TiedNumber& tied : variable.tied) {
      const double value = tied.factor * variable.start, scene = task.family.value(tied.path);
      if (value != scene) changes.push_back({tied.path, value, scene, true});
    }
  }
  return changes;
}

std::string speed_unit(const TuneTask& task, const Units& units) {
  return task.in_rpm ? "rpm" : fmt::format("rad/{}", units.time);
}

bool speeds_vary(const TuneTask& task) { return std::ranges::any_of(task.variables, is_speed); }

SpeedSpan span_at(const TuneTask& task, const std::vector<double>& x) {
  SpeedSpan span = task.span;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_speed(task.variables[i])) continue;
    (task.variables[i].path == range_from ? span.from : span.to) = x[i] * task.speed_unit;
  }
  return span;
}

std::vector<double> start_of(const TuneTask& task) {
  std::vector<double> x;
  for (const TuneVariable& variable : task.variables) x.push_back(variable.start);
  return x;
}

TuneResult tune(const TuneTask& task, const Work& work) {
  TuneSearch search(task, work);
  TuneResult result;
  search.run(result);
  report_design(search, result);
  return result;
}

}  // namespace hb
