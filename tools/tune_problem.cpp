#include "tools/tune_problem.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
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

bool is_margin(const Metric& metric) {
  return metric.kind == MetricKind::margin || metric.kind == MetricKind::margin_per_turn;
}

bool is_speed(const TuneVariable& variable) { return variable.path == range_from || variable.path == range_to; }

// Names of all that a condition without a name holds for; empty where it is one number.
std::vector<std::string> names_of(const SceneModel& model, const Metric& metric) {
  std::vector<std::string> names;
  switch (metric.kind) {
    case MetricKind::deflection:
    case MetricKind::stress:
    case MetricKind::frequency:
    case MetricKind::margin:
    case MetricKind::margin_per_turn:
      for (const RodModel& rod : model.rods)
        if (rod.reported) names.push_back(rod.name);
      break;
    case MetricKind::force:
      if (model.linkage())
        for (const JointForce& joint : forces_of(model, 1, {}).joints) names.push_back(joint.name);
      break;
    default:
      break;
  }
  if (!metric.name.empty() || names.size() < 2) names.clear();
  return names;
}

class Tuner {
 public:
  explicit Tuner(const TuneTask& task) : task_(task), settings_(task.settings) {
    for (const Keep& keep : task.keeps) {
      if (!is_margin(keep.metric)) continue;
      per_turn_ = keep.metric.kind == MetricKind::margin_per_turn;
      margin_ = keep.bound;
    }
    for (const GoalTerm& term : task.goal.terms) add_metric(term.metric);
    for (const Keep& keep : task.keeps) add_metric(keep.metric);
    settings_.only = {false, true, std::ranges::any_of(metrics_, needs_forces), false};
  }

  TuneResult run() {
    TuneResult result;
    result.start = start();
    split_conditions(make_model(task_.source.with(overrides_at(task_, result.start)), settings_));
    for (const Part& part : parts_) result.condition_of.push_back(part.of);
    DesignSpace space = space_of([this](const std::vector<double>& x) { return overrides_at(task_, x); },
                                 [this](const std::vector<double>& x) { return span_at(task_, x); });
    // What is wrong with the question shows at the start.
    start_values_ = numbers_of(space.values(result.start));
    for (const GoalTerm& term : task_.goal.terms) {
      const double value = value_of(term.metric, start_values_);
      if (task_.goal.weighted && !(std::isfinite(value) && value != 0))
        throw UsageError(
            fmt::format("--minimise: found {} with the value {} at the start, allowed in a weighted sum: "
                        "quantities that exist there and are not 0",
                        term.metric.text, value));
    }
    const bool speeds_vary = std::ranges::any_of(task_.variables, is_speed);
    std::vector<double> lower, upper;
    for (const TuneVariable& variable : task_.variables) {
      lower.push_back(variable.lower);
      upper.push_back(variable.upper);
    }
    DesignProblem problem = problem_over(space, result.start, lower, upper, !speeds_vary);
    result.design = first_search(problem);
    verify(space, problem, result);
    result.tuned = to_vector(result.design.x);
    report(space, problem, result);
    result.counts = counts_;
    result.without_response = without_response_;
    stages(result);
    return result;
  }

 private:
  // A condition on the worst of several rods or joints has a kink where another becomes the worst: one each is smooth.
  struct Part {
    Keep keep;
    std::size_t of;  // place in task_.keeps
  };
  void split_conditions(const SceneModel& model) {
    metrics_.clear();
    for (const GoalTerm& term : task_.goal.terms) add_metric(term.metric);
    for (std::size_t j = 0; j < task_.keeps.size(); ++j) {
      const Keep& keep = task_.keeps[j];
      const std::vector<std::string> names = names_of(model, keep.metric);
      if (names.empty()) parts_.push_back({keep, j});
      for (const std::string& name : names) {
        Part part{keep, j};
        part.keep.metric.name = name;
        part.keep.metric.text += ":" + name;
        parts_.push_back(std::move(part));
      }
    }
    for (const Part& part : parts_) add_metric(part.keep.metric);
  }
  void add_metric(const Metric& metric) {
    if (std::ranges::find(metrics_, metric) == metrics_.end()) metrics_.push_back(metric);
  }

  DesignSpace space_of(DesignSpace::At overrides, DesignSpace::SpanAt span) {
    return {task_.source, settings_, task_.heights, std::move(overrides), std::move(span), metrics_,
            margin_,      per_turn_, counts_};
  }

  // Worst cases on more speeds; where the search was wrong, once more with those.
  void verify(DesignSpace& space, DesignProblem& problem, TuneResult& result) {
    while (true) {
      const std::vector<double> x = to_vector(result.design.x);
      const auto began = std::chrono::steady_clock::now();
      const auto checked = design_values(space.values(x, verification));
      verification_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      const DesignValues& values = result.design.values;
      const double scale = std::max(std::abs(values.goal), 1e-300);
      result.verified = checked && std::abs(checked->goal - values.goal) <= verification_tolerance * scale &&
                        (values.conditions.size() == 0 ||
                         (checked->conditions - values.conditions).maxCoeff() <= verification_tolerance);
      if (result.verified || result.rounds == most_rounds || task_.span.from == task_.span.to) return;
      ++result.rounds;
      space.refine(2);
      problem.start = result.design.x;
      DesignOptions local = task_.options;
      local.algorithm = DesignAlgorithm::cobyla;
      local.max_evaluations = std::max(50, task_.options.max_evaluations / 2);
      DesignResult again = optimise(problem, local);
      again.trials.insert(again.trials.begin(), result.design.trials.begin(), result.design.trials.end());
      again.num_missing += result.design.num_missing;
      again.num_gradients += result.design.num_gradients;
      again.evidence = result.design.evidence + "; with more speeds " + again.evidence;
      result.design = std::move(again);
    }
  }

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

  static std::vector<double> numbers_of(const std::vector<MetricValue>& values) {
    std::vector<double> numbers;
    for (const MetricValue& value : values) numbers.push_back(value.value);
    return numbers;
  }

  std::size_t place_of(const Metric& metric) const {
    return static_cast<std::size_t>(std::ranges::find(metrics_, metric) - metrics_.begin());
  }
  double value_of(const Metric& metric, const std::vector<double>& values) const { return values[place_of(metric)]; }

  // As it is minimised: what is to be large has its sign turned.
  double goal_sign() const { return task_.goal.maximise ? -1 : 1; }
  double goal_of(const std::vector<double>& values) const {
    double sum = 0;
    for (const GoalTerm& term : task_.goal.terms) sum += goal_factor(term) * value_of(term.metric, values);
    return sum;
  }
  double goal_factor(const GoalTerm& term) const {
    return task_.goal.weighted ? term.weight / value_of(term.metric, start_values_) : 1;
  }

  // The unit of a condition: its bound; a margin's is the start's where that is larger.
  double scale_of(const Keep& keep) const {
    const double at_start = std::abs(value_of(keep.metric, start_values_));
    double scale = keep.bound;
    if (is_margin(keep.metric) && std::isfinite(at_start)) scale = std::max(scale, at_start);
    return scale > 0 ? scale : 1;
  }
  double excess_of(const Keep& keep, double value) const {
    return (keep.at_least ? keep.bound - value : value - keep.bound) / scale_of(keep);
  }

  std::optional<DesignValues> design_values(const std::vector<MetricValue>& metrics) const {
    const std::vector<double> values = numbers_of(metrics);
    DesignValues result;
    result.goal = goal_sign() * goal_of(values);
    result.conditions.resize(static_cast<Eigen::Index>(parts_.size()));
    for (std::size_t j = 0; j < parts_.size(); ++j)
      result.conditions(static_cast<Eigen::Index>(j)) =
          excess_of(parts_[j].keep, value_of(parts_[j].keep.metric, values));
    if (!std::isfinite(result.goal) || !result.conditions.allFinite()) return std::nullopt;
    return result;
  }

  // Rows of `slopes` are the metrics'.
  DesignGradient design_gradient(const Eigen::MatrixXd& slopes) const {
    DesignGradient result;
    result.goal = Eigen::VectorXd::Zero(slopes.cols());
    for (const GoalTerm& term : task_.goal.terms)
      result.goal += goal_sign() * goal_factor(term) * slopes.row(row_of(term.metric)).transpose();
    result.conditions.resize(static_cast<Eigen::Index>(parts_.size()), slopes.cols());
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      const Keep& keep = parts_[j].keep;
      result.conditions.row(static_cast<Eigen::Index>(j)) =
          (keep.at_least ? -1 : 1) / scale_of(keep) * slopes.row(row_of(keep.metric));
    }
    return result;
  }
  Eigen::Index row_of(const Metric& metric) const { return static_cast<Eigen::Index>(place_of(metric)); }

  DesignProblem problem_over(DesignSpace& space, const std::vector<double>& start, const std::vector<double>& lower,
                             const std::vector<double>& upper, bool with_gradient) {
    DesignProblem problem;
    problem.lower = to_eigen(lower);
    problem.upper = to_eigen(upper);
    problem.start = to_eigen(start);
    problem.num_conditions = static_cast<int>(parts_.size());
    problem.evaluate = [this, &space](const Eigen::VectorXd& x) -> std::optional<DesignValues> {
      const std::vector<MetricValue>* metrics = space.try_values(to_vector(x));
      if (!metrics) return std::nullopt;
      std::optional<DesignValues> values = design_values(*metrics);
      if (!values) ++without_response_;
      return values;
    };
    if (!with_gradient) return problem;
    problem.gradient = [this, &space, lower, upper](const Eigen::VectorXd& x) -> std::optional<DesignGradient> {
      const std::optional<Eigen::MatrixXd> slopes = space.gradients(to_vector(x), lower, upper);
      if (!slopes) return std::nullopt;
      return design_gradient(*slopes);
    };
    return problem;
  }

  void report(DesignSpace& space, const DesignProblem& problem, TuneResult& result) {
    // Besides what was asked: deflection, margin and mass always.
    std::vector<Metric> shown;
    for (const GoalTerm& term : task_.goal.terms) shown.push_back(term.metric);
    for (const Keep& keep : task_.keeps)
      if (std::ranges::find(shown, keep.metric) == shown.end()) shown.push_back(keep.metric);
    std::vector<MetricKind> more = {MetricKind::deflection, MetricKind::margin};
    const Scene scene = task_.source.with(overrides_at(task_, result.start));
    if (std::holds_alternative<Linkage>(scene.model)) more.push_back(MetricKind::mass);
    const char* const words[] = {"deflection", "stable", "mass"};
    for (std::size_t k = 0; k < more.size(); ++k) {
      const Metric metric{more[k], "", 1, words[k]};
      if (std::ranges::find(shown, metric) == shown.end()) shown.push_back(metric);
    }
    const auto began = std::chrono::steady_clock::now();
    DesignSpace::Report before = space.report(result.start, shown, 1);
    DesignSpace::Report after = space.report(result.tuned, shown, 1);
    report_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    for (std::size_t k = 0; k < shown.size(); ++k) result.rows.push_back({shown[k], before.values[k], after.values[k]});
    result.curves_before = std::move(before.curves);
    result.curves_after = std::move(after.curves);
    result.span_before = span_at(task_, result.start);
    result.span_after = span_at(task_, result.tuned);
    const std::vector<double> values_after = numbers_of(space.values(result.tuned));
    result.goal_before = goal_of(start_values_);
    result.goal_after = goal_of(values_after);
    if (!task_.goal.weighted) result.goal_unit = unit_of(task_.goal.terms[0].metric.kind, scene.units);

    constexpr double active = 1e-3;
    result.sensitivity = design_sensitivity(problem, result.design.x, active);
    if (result.sensitivity) result.goal_gradient = goal_sign() * result.sensitivity->gradient.goal;
    // Of each condition the part that is nearest to its bound; relaxing the bound relaxes all parts.
    for (const Keep& keep : task_.keeps) {
      TuneCondition& condition = result.conditions.emplace_back();
      condition.keep = keep;
      condition.excess = -HUGE_VAL;
    }
    for (std::size_t j = 0; j < parts_.size(); ++j) {
      TuneCondition& condition = result.conditions[parts_[j].of];
      if (result.sensitivity) condition.multiplier += result.sensitivity->multipliers(static_cast<Eigen::Index>(j));
      const double value = value_of(parts_[j].keep.metric, values_after);
      const double excess = excess_of(parts_[j].keep, value);
      if (excess <= condition.excess) continue;
      condition.value = value;
      condition.excess = excess;
      // Search and verification agree to the tolerance; what they differ by is not a violation.
      condition.met = excess <= verification_tolerance;
      condition.active = std::abs(excess) <= active;
    }
    damping_sensitivity(result);
  }

  // One variable, a factor on the internal damping of all links, at the tuned design. Of the best goal,
  //     df*/dp = df/dp + sum_j lambda_j dg_j/dp.
  void damping_sensitivity(TuneResult& result) {
    const std::vector<Override> tuned = overrides_at(task_, result.tuned);
    const Scene scene = task_.source.with(tuned);
    const auto* linkage = std::get_if<Linkage>(&scene.model);
    if (!linkage || !(std::abs(result.goal_after) > 0)) return;
    DesignSpace space = space_of(
        [&](const std::vector<double>& factor) {
          std::vector<Override> overrides = tuned;
          for (const int link : elastic_links(*linkage)) {
            const Body& body = *body_at(*linkage, link);
            if (body.elastic->internal_damping > 0)
              overrides.push_back(
                  number_override(body.name + ".damping_internal", factor[0] * body.elastic->internal_damping));
          }
          return overrides;
        },
        [&](const std::vector<double>&) { return span_at(task_, result.tuned); });
    const DesignProblem problem = problem_over(space, {1}, {0.5}, {1.5}, true);
    const auto sensitivity = design_sensitivity(problem, Eigen::VectorXd::Ones(1));
    if (!sensitivity) return;
    const double own = sensitivity->gradient.goal(0);
    result.damping_sensitivity = goal_sign() * own / result.goal_after;
    if (!result.sensitivity) return;
    const double best = own + result.sensitivity->multipliers.dot(sensitivity->gradient.conditions.col(0));
    result.damping_sensitivity_of_best = goal_sign() * best / result.goal_after;
  }

  void stages(TuneResult& result) const {
    std::string computed, skipped;
    const auto say = [&](bool asked, const char* what) {
      std::string& text = asked ? computed : skipped;
      text += (text.empty() ? "" : ", ") + std::string(what);
    };
    const auto any = [&](auto&& holds) { return std::ranges::any_of(metrics_, holds); };
    say(any([](const Metric& m) {
          return depends_on_speed(m.kind) && !is_margin(m) && m.kind != MetricKind::clearance &&
                 m.kind != MetricKind::speed_range;
        }),
        "response");
    say(any(is_margin), "stability");
    say(any(needs_forces), "joint forces");
    const auto count = [](int number, const char* what) { return fmt::format("{} {}", number, what); };
    result.stages.push_back({"designs", counts_.analyses_seconds,
                             count(counts_.analyses, "analysed: ") + (computed.empty() ? "no speeds" : computed),
                             false});
    if (!skipped.empty()) result.stages.push_back({skipped, 0, "no goal and no condition needs it", true});
    result.stages.push_back({"gradients", counts_.gradients_seconds,
                             fmt::format("{} by adjoint, {} by differences of whole analyses", counts_.gradients,
                                         counts_.gradients_by_differences),
                             false});
    result.stages.push_back(
        {"verification", verification_seconds_, fmt::format("on {} times the speeds", verification), false});
    result.stages.push_back({"curves", report_seconds_, "before and after", false});
  }

  const TuneTask& task_;
  Settings settings_;
  std::vector<Metric> metrics_;
  std::vector<Part> parts_;  // the conditions of the search
  std::vector<double> start_values_;
  double margin_ = 0;
  bool per_turn_ = false;
  TuneCounts counts_;
  int without_response_ = 0;
  double verification_seconds_ = 0, report_seconds_ = 0;
};

}  // namespace

std::vector<Override> overrides_at(const TuneTask& task, const std::vector<double>& x) {
  std::vector<Override> overrides;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (is_speed(task.variables[i])) continue;
    overrides.push_back(number_override(task.variables[i].path, x[i]));
    for (const TiedNumber& tied : task.variables[i].tied)
      overrides.push_back(number_override(tied.path, tied.factor * x[i]));
  }
  return overrides;
}

std::string speed_unit(const TuneTask& task, const Units& units) {
  return task.in_rpm ? "rpm" : fmt::format("rad/{}", units.time);
}

SpeedSpan span_at(const TuneTask& task, const std::vector<double>& x) {
  SpeedSpan span = task.span;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_speed(task.variables[i])) continue;
    (task.variables[i].path == range_from ? span.from : span.to) = x[i] * task.speed_unit;
  }
  return span;
}

TuneResult tune(const TuneTask& task) { return Tuner(task).run(); }

}  // namespace hb::tools
