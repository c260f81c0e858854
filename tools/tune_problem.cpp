#include "tools/tune_problem.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

#include "tools/command.hpp"

namespace hb::tools {
namespace {

constexpr int verification = 4;  // times the speeds of the search
constexpr double verification_tolerance = 1e-6;  // of goal and conditions, relative
constexpr int most_rounds = 3;

std::vector<double> to_vector(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

Eigen::VectorXd to_eigen(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

bool needs_forces(const Metric& metric) {
  return metric.kind == MetricKind::force || metric.kind == MetricKind::torque_ripple;
}

class Tuner {
 public:
  explicit Tuner(const TuneTask& task) : task_(task), settings_(task.settings) {
    const auto add = [&](const Metric& metric) {
      if (std::ranges::find(metrics_, metric) == metrics_.end()) metrics_.push_back(metric);
    };
    for (const GoalTerm& term : task.goal.terms) add(term.metric);
    for (const Keep& keep : task.keeps) {
      add(keep.metric);
      if (keep.metric.kind == MetricKind::margin || keep.metric.kind == MetricKind::margin_per_turn) {
        per_turn_ = keep.metric.kind == MetricKind::margin_per_turn;
        margin_ = keep.bound;
      }
    }
    settings_.only = {false, true, std::ranges::any_of(metrics_, needs_forces), false};
    const std::vector<std::string> paths = task.source.numeric_paths();
    numbers_.insert(paths.begin(), paths.end());
  }

  TuneResult run() {
    TuneResult result;
    result.start = start();
    // What is wrong with the question shows at the start.
    const std::vector<MetricValue> at_start = metric_values(result.start, task_.span, metrics_);
    for (std::size_t k = 0; k < metrics_.size(); ++k) start_values_.push_back(at_start[k].value);
    for (const GoalTerm& term : task_.goal.terms) {
      const double value = value_of(term.metric, start_values_);
      if (task_.goal.weighted && !(std::isfinite(value) && value != 0))
        throw UsageError(
            fmt::format("--minimise: found {} with the value {} at the start, allowed in a weighted sum: "
                        "quantities that exist there and are not 0",
                        term.metric.text, value));
    }

    DesignProblem problem = problem_from(result.start);
    result.design = first_search(problem);
    SpeedSpan fine = task_.span;
    fine.num_nodes *= verification;
    // Worst cases on more speeds; where the search was wrong, once more with those.
    while (true) {
      const std::vector<double> x = to_vector(result.design.x);
      const auto checked = design_values(metric_values(x, fine, metrics_));
      const DesignValues& values = result.design.values;
      const double scale = std::max(std::abs(values.goal), 1e-300);
      result.verified = checked && std::abs(checked->goal - values.goal) <= verification_tolerance * scale &&
                        (values.conditions.size() == 0 ||
                         (checked->conditions - values.conditions).maxCoeff() <= verification_tolerance);
      if (result.verified || result.rounds == most_rounds || task_.span.from == task_.span.to) break;
      ++result.rounds;
      span_nodes_ *= 2;
      problem = problem_from(x);
      DesignOptions local = task_.options;
      local.algorithm = DesignAlgorithm::cobyla;
      local.max_evaluations = std::max(50, task_.options.max_evaluations / 2);
      DesignResult again = optimise(problem, local);
      again.trials.insert(again.trials.begin(), result.design.trials.begin(), result.design.trials.end());
      again.num_missing += result.design.num_missing;
      again.evidence = result.design.evidence + "; with more speeds " + again.evidence;
      result.design = std::move(again);
    }
    result.tuned = to_vector(result.design.x);
    report(problem, fine, result);
    result.not_closing = not_closing_;
    result.refused = refused_;
    result.without_response = without_response_;
    return result;
  }

 private:
  DesignResult first_search(const DesignProblem& problem) const {
    bool any = false;
    DesignProblem watched = problem;
    watched.evaluate = [&](const Eigen::VectorXd& x) {
      std::optional<DesignValues> values = problem.evaluate(x);
      any = any || values.has_value();
      return values;
    };
    try {
      return optimise(watched, task_.options);
    } catch (const std::invalid_argument&) {
      if (any) throw;
      throw UsageError(
          "--vary: found no design within the bounds that closes and has a periodic solution over all these "
          "speeds; allowed: bounds and speeds with some");
    }
  }

  std::vector<double> start() const {
    std::vector<double> x;
    for (const TuneVariable& variable : task_.variables) x.push_back(variable.start);
    return x;
  }

  SceneModel model_at(const std::vector<Override>& overrides) const {
    return make_model(task_.source.with(overrides), settings_);
  }

  // A section known by its shape gives its height from area and J.
  SectionHeights heights_of(const SceneModel& model) const {
    SectionHeights heights = task_.heights;
    const Linkage* linkage = model.linkage();
    if (!linkage || heights.contains("*")) return heights;
    for (const int link : elastic_links(*linkage)) {
      const Body& body = *body_at(*linkage, link);
      if (heights.contains(body.name)) continue;
      const double F = body.elastic->area, r2 = body.elastic->second_moment / F;  // radius of gyration squared
      const auto has = [&](const char* key) {
        return numbers_.contains(body.name + ".section." + key) ||
               numbers_.contains(body.name + ".elastic.section." + key);
      };
      if (has("height")) {
        heights[body.name] = std::sqrt(12 * r2);  // J = F h^2/12
      } else if (has("wall")) {
        // J = F (D^2 + d^2)/16, F = pi (D^2 - d^2)/4
        heights[body.name] = std::sqrt((16 * r2 + 4 * F / std::numbers::pi) / 2);
      } else if (has("diameter")) {
        heights[body.name] = 4 * std::sqrt(r2);  // J = F D^2/16
      }
    }
    return heights;
  }

  std::vector<MetricValue> metric_values(const std::vector<Override>& overrides, SpeedSpan span,
                                         const std::vector<Metric>& metrics) const {
    const SceneModel model = model_at(overrides);
    DesignAnalysis analysis(model, settings_, span, heights_of(model), margin_, per_turn_);
    std::vector<MetricValue> values;
    for (const Metric& metric : metrics) values.push_back(analysis.value(metric));
    return values;
  }
  std::vector<MetricValue> metric_values(const std::vector<double>& x, SpeedSpan span,
                                         const std::vector<Metric>& metrics) const {
    return metric_values(overrides_at(task_, x), span, metrics);
  }

  double value_of(const Metric& metric, const std::vector<double>& values) const {
    return values[static_cast<std::size_t>(std::ranges::find(metrics_, metric) - metrics_.begin())];
  }

  double goal_of(const std::vector<double>& values) const {
    double sum = 0;
    for (const GoalTerm& term : task_.goal.terms) {
      const double value = value_of(term.metric, values);
      sum += task_.goal.weighted ? term.weight * value / value_of(term.metric, start_values_) : value;
    }
    return sum;
  }

  // The unit of a condition: its bound; a margin's is the start's where that is larger.
  double scale_of(const Keep& keep) const {
    const double at_start = std::abs(value_of(keep.metric, start_values_));
    const bool margin = keep.metric.kind == MetricKind::margin || keep.metric.kind == MetricKind::margin_per_turn;
    double scale = keep.bound;
    if (margin && std::isfinite(at_start)) scale = std::max(scale, at_start);
    return scale > 0 ? scale : 1;
  }
  double excess_of(const Keep& keep, double value) const {
    return (keep.at_least ? keep.bound - value : value - keep.bound) / scale_of(keep);
  }

  std::optional<DesignValues> design_values(const std::vector<MetricValue>& metrics) const {
    std::vector<double> values;
    for (const MetricValue& metric : metrics) values.push_back(metric.value);
    DesignValues result;
    result.goal = goal_of(values);
    result.conditions.resize(static_cast<Eigen::Index>(task_.keeps.size()));
    for (std::size_t j = 0; j < task_.keeps.size(); ++j)
      result.conditions(static_cast<Eigen::Index>(j)) =
          excess_of(task_.keeps[j], value_of(task_.keeps[j].metric, values));
    if (!std::isfinite(result.goal) || !result.conditions.allFinite()) return std::nullopt;
    return result;
  }

  std::optional<DesignValues> evaluate(const std::vector<double>& x) {
    SpeedSpan span = task_.span;
    span.num_nodes *= span_nodes_;
    try {
      std::optional<DesignValues> values = design_values(metric_values(x, span, metrics_));
      if (!values) ++without_response_;
      return values;
    } catch (const ObstructedLinkage&) {
      ++not_closing_;
    } catch (const SceneError&) {
      ++refused_;
    }
    return std::nullopt;
  }

  DesignProblem problem_from(const std::vector<double>& x) {
    DesignProblem problem;
    std::vector<double> lower, upper;
    for (const TuneVariable& variable : task_.variables) {
      lower.push_back(variable.lower);
      upper.push_back(variable.upper);
    }
    problem.lower = to_eigen(lower);
    problem.upper = to_eigen(upper);
    problem.start = to_eigen(x);
    problem.num_conditions = static_cast<int>(task_.keeps.size());
    problem.evaluate = [this](const Eigen::VectorXd& y) { return evaluate(to_vector(y)); };
    return problem;
  }

  void report(const DesignProblem& problem, SpeedSpan fine, TuneResult& result) {
    // Besides what was asked: deflection, margin and mass always.
    std::vector<Metric> shown = metrics_;
    std::vector<MetricKind> more = {MetricKind::deflection, MetricKind::margin};
    if (std::holds_alternative<Linkage>(task_.source.with(overrides_at(task_, result.start)).model))
      more.push_back(MetricKind::mass);
    const char* const words[] = {"deflection", "stable", "mass"};
    for (std::size_t k = 0; k < more.size(); ++k) {
      const Metric metric{more[k], "", 1, words[k]};
      if (std::ranges::find(shown, metric) == shown.end()) shown.push_back(metric);
    }
    const auto values = [&](const std::vector<double>& x, std::optional<DesignCurves>& curves) {
      const SceneModel model = model_at(overrides_at(task_, x));
      DesignAnalysis analysis(model, settings_, fine, heights_of(model), margin_, per_turn_);
      std::vector<MetricValue> found;
      for (const Metric& metric : shown) found.push_back(analysis.value(metric));
      curves = analysis.curves();
      return found;
    };
    const std::vector<MetricValue> before = values(result.start, result.curves_before);
    const std::vector<MetricValue> after = values(result.tuned, result.curves_after);
    std::vector<double> values_before, values_after;
    for (std::size_t k = 0; k < shown.size(); ++k) {
      result.rows.push_back({shown[k], before[k], after[k]});
      if (k >= metrics_.size()) continue;
      values_before.push_back(before[k].value);
      values_after.push_back(after[k].value);
    }
    result.goal_before = goal_of(values_before);
    result.goal_after = goal_of(values_after);
    const SceneModel model = model_at(overrides_at(task_, result.tuned));
    if (!task_.goal.weighted) result.goal_unit = unit_of(task_.goal.terms[0].metric.kind, model.scene.units);

    constexpr double active = 1e-3;
    result.sensitivity = design_sensitivity(problem, result.design.x, active);
    for (std::size_t j = 0; j < task_.keeps.size(); ++j) {
      TuneCondition condition;
      condition.keep = task_.keeps[j];
      condition.value = value_of(condition.keep.metric, values_after);
      condition.excess = excess_of(condition.keep, condition.value);
      // Search and verification agree to the tolerance; what they differ by is not a violation.
      condition.met = condition.excess <= verification_tolerance;
      condition.active = std::abs(condition.excess) <= active;
      if (result.sensitivity) condition.multiplier = result.sensitivity->multipliers(static_cast<Eigen::Index>(j));
      result.conditions.push_back(std::move(condition));
    }
    result.damping_sensitivity = damping_sensitivity(model, result.tuned);
  }

  // Central difference in the logarithm of the internal damping of all links together.
  std::optional<double> damping_sensitivity(const SceneModel& model, const std::vector<double>& x) const {
    const Linkage* linkage = model.linkage();
    if (!linkage) return std::nullopt;
    constexpr double step = 0.02;
    const auto goal_with = [&](double factor) {
      std::vector<Override> overrides = overrides_at(task_, x);
      for (const int link : elastic_links(*linkage)) {
        const Body& body = *body_at(*linkage, link);
        if (body.elastic->internal_damping > 0)
          overrides.push_back(
              number_override(body.name + ".damping_internal", factor * body.elastic->internal_damping));
      }
      const auto values = design_values(metric_values(overrides, task_.span, metrics_));
      return values ? values->goal : std::nan("");
    };
    const double more = goal_with(std::exp(step)), less = goal_with(std::exp(-step));
    const double slope = (more - less) / (2 * step * 0.5 * (more + less));
    if (!std::isfinite(slope)) return std::nullopt;
    return slope;
  }

  const TuneTask& task_;
  Settings settings_;
  std::vector<Metric> metrics_;
  std::set<std::string> numbers_;  // paths that the scene gives
  std::vector<double> start_values_;
  double margin_ = 0;
  bool per_turn_ = false;
  int span_nodes_ = 1;  // times the speeds of the span
  int not_closing_ = 0, refused_ = 0, without_response_ = 0;
};

}  // namespace

std::vector<Override> overrides_at(const TuneTask& task, const std::vector<double>& x) {
  std::vector<Override> overrides;
  for (std::size_t i = 0; i < x.size(); ++i) {
    overrides.push_back(number_override(task.variables[i].path, x[i]));
    for (const TiedNumber& tied : task.variables[i].tied)
      overrides.push_back(number_override(tied.path, tied.factor * x[i]));
  }
  return overrides;
}

TuneResult tune(const TuneTask& task) { return Tuner(task).run(); }

}  // namespace hb::tools
