// `hb tune` as a constrained minimisation: from scene numbers to goal and conditions, and what came of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hb/design.hpp"
#include "tools/tune_design.hpp"
#include "tools/tune_metric.hpp"

namespace hb::tools {

// A number that follows a variable: factor times it.
struct TiedNumber {
  std::string path;
  double factor = 1;
};

struct TuneVariable {
  std::string path;
  double lower = 0, upper = 0, start = 0;
  std::optional<double> moved_from;  // the scene's value if that lies outside the bounds
  std::vector<TiedNumber> tied;
};

struct TuneTask {
  SceneSource source;
  std::vector<TuneVariable> variables;
  Goal goal;
  std::vector<Keep> keeps;
  SpeedSpan span;
  bool in_rpm = true;  // how speeds are shown
  std::map<std::string, double> heights;  // given by flag
  Settings settings;
  DesignOptions options;
};

// A metric before and after.
struct TuneRow {
  Metric metric;
  MetricValue before, after;
};

struct TuneCondition {
  Keep keep;
  double value = 0;  // at the tuned design
  bool met = false;
  double excess = 0;  // how far beyond the bound, relative to it (margins: to the start's); <= 0 if met
  double multiplier = 0;  // what the goal gains per unit of excess allowed
  bool active = false;
};

struct TuneResult {
  DesignResult design;
  std::vector<double> start, tuned;  // of the variables
  double goal_before = 0, goal_after = 0;
  std::vector<TuneRow> rows;
  std::vector<TuneCondition> conditions;
  std::optional<DesignSensitivity> sensitivity;
  std::optional<double> damping_sensitivity;  // d ln goal / d ln internal damping of all links
  std::optional<DesignCurves> curves_before, curves_after;
  int not_closing = 0, refused = 0, without_response = 0;  // designs tried that were none
  int rounds = 1;  // searches, each from the last and with more speeds
  bool verified = false;  // the conditions hold and the goal stands on four times the speeds
  std::string goal_unit;  // empty for weighted sums
};

[[nodiscard]] std::vector<Override> overrides_at(const TuneTask& task, const std::vector<double>& x);

// Throws UsageError and SceneError for what cannot be at the start.
[[nodiscard]] TuneResult tune(const TuneTask& task);

}  // namespace hb::tools
