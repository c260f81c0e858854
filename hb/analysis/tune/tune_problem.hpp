// Design as a constrained minimisation: from scene numbers to goal and conditions, and what came of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/tune/tune_design.hpp"
#include "hb/analysis/tune/tune_metric.hpp"
#include "hb/analysis/tune/tune_space.hpp"
#include "hb/engine/design/design.hpp"

namespace hb {

// A number that follows a variable: factor times it.
struct TiedNumber {
  std::string path;
  double factor = 1;
};

// An end of the speed range may be a variable too.
inline constexpr const char* range_from = "over.from";
inline constexpr const char* range_to = "over.to";

struct TuneVariable {
  std::string path;  // a number of the family, range_from or range_to
  double lower = 0, upper = 0, start = 0;
  std::optional<double> moved_from;  // the scene's value if that lies outside the bounds
  std::vector<TiedNumber> tied;
};

struct TuneTask {
  SceneFamily family;
  std::vector<TuneVariable> variables;
  Goal goal;
  std::vector<Keep> keeps;
  SpeedSpan span;
  bool in_rpm = true;  // how speeds are given and shown
  double speed_unit = 1;  // rad per unit time in one of those
  std::map<std::string, double> heights;  // given beside the scene
  Settings settings;
  DesignOptions options;
};

// A metric before and after.
struct TuneRow {
  Metric metric;
  MetricValue before, after;
  bool before_confirmed = false, after_confirmed = false;  // on four times the speeds; if not, it is at least as bad
};

struct TuneCondition {
  Keep keep;
  // Of the rod or joint nearest to the bound, or furthest beyond it, with the error counted.
  std::string where;  // empty: one number
  double value = 0, error = 0;  // at the tuned design; estimate
  bool met = false;  // by the value with its error
  double excess = 0;  // how far the value is beyond the bound, relative to it (margins: to the start's)
  double best = 0;  // value of the design that does best by this condition alone, of all tried
  bool best_meets = false;
  double unit = 1;  // of excess: the bound, or a margin at the start
  double multiplier = 0;  // what the goal gains per unit of excess allowed
  bool active = false;
};

// Whether every disturbance of a link dies out over all speeds, by its margin and the error of that.
struct RodMargin {
  std::string rod;
  MetricValue margin;  // and the speed where it is least
  std::optional<Verdict> verdict;  // empty: no margin
};

struct TuneResult {
  DesignResult design;
  std::vector<std::size_t> condition_of;  // of each of its conditions: the place in TuneTask::keeps
  std::vector<double> start, tuned;  // of the variables
  double goal_before = 0, goal_after = 0, goal_error = 0;  // estimated error of goal_after
  Eigen::VectorXd goal_gradient;  // with respect to the variables, for more of them; empty: not found
  std::vector<std::string> worst_at_once;  // rods that hold the goal together, where it has a kink
  std::vector<std::string> without_effect;  // variables on which neither goal nor conditions depend
  std::vector<TuneRow> rows;
  std::vector<RodMargin> margins_before, margins_after;  // of every elastic link, asked for or not
  std::vector<TuneCondition> conditions;
  std::optional<DesignSensitivity> sensitivity;
  double slope_left_over = 0;  // of the slopes of goal, conditions and bounds: 0 where they balance
  // d ln goal / d ln internal damping of all links, at fixed variables, and of the best goal: active conditions move.
  std::optional<double> damping_sensitivity, damping_sensitivity_of_best;
  std::optional<DesignCurves> curves_before, curves_after;
  TuneCounts counts;  // until the search had ended; gradients: all
  int analyses_after = 0;  // beside the designs tried: neighbours and other dampings, for slopes at the design found
  int without_response = 0;  // designs tried that have no periodic solution at some speed
  int num_modes = 0;  // kept of each rod's series
  int rounds = 1;  // searches, each from the last with more speeds, more modes or more room for errors
  int confirmations = 0;  // analyses on four times the speeds
  bool agrees = false;  // goal and conditions are the same on four times the speeds
  bool holds = false;  // the conditions do with the errors of their values, or there is no such design
  bool modes_suffice = false;  // for the tolerance, where their number is chosen
  bool verified() const { return agrees && holds && modes_suffice; }
  std::string goal_unit;  // empty for weighted sums
  SpeedSpan span_before, span_after;
  std::vector<std::string> warnings;  // of the scenes before and after, and of the bounds: place_warnings()
  std::vector<Stage> stages;
};

// Of the family's numbers.
[[nodiscard]] Numbers numbers_at(const TuneTask& task, const std::vector<double>& x);

// What the design before has otherwise than the scene: a number moved into its bounds, or tied.
struct StartChange {
  std::string path;
  double value = 0, scene = 0;
  bool tied = false;
};
[[nodiscard]] std::vector<StartChange> start_changes(const TuneTask& task);

[[nodiscard]] std::string speed_unit(const TuneTask& task, const Units& units);  // "rpm", "rad/s"
[[nodiscard]] bool speeds_vary(const TuneTask& task);
[[nodiscard]] SpeedSpan span_at(const TuneTask& task, const std::vector<double>& x);

[[nodiscard]] std::vector<double> start_of(const TuneTask& task);

// Throws RequestError and SceneError for what cannot be at the start.
[[nodiscard]] TuneResult tune(const TuneTask& task, const Work& work);

}  // namespace hb
