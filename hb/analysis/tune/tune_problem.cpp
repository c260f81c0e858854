#include "hb/analysis/tune/tune_problem.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace hb {
namespace {

constexpr int verification = 4;  // times the speeds of the search
constexpr double verification_tolerance = 1e-6;  // of goal and conditions, relative
constexpr int most_rounds = 4;

std::vector<double> to_vector(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

Eigen::VectorXd to_eigen(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

bool is_speed(const TuneVariable& variable) { return variable.path == range_from || variable.path == range_to; }

// What does not balance of the slopes over the largest of them; at a minimum inside, where all vanish, over the goal or
// what it differed by among the designs tried, whichever is less, per bounds' distance.
double slope_left_over(const DesignSensitivity& sensitivity, const DesignResult& design) {
  if (sensitivity.left_over == 0) return 0;
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const DesignTrial& trial : design.trials) {
    if (!trial.values) continue;
    least = std::min(least, trial.values->goal);
    most = std::max(most, trial.values->goal);
  }
  const double steepest = sensitivity.left_over / sensitivity.residual;
  return sensitivity.left_over / std::max(steepest, std::min(most - least, std::abs(design.values.goal)));
}

std::vector<double> numbers_of(const std::vector<MetricValue>& values) {
  std::vector<double> numbers;
  for (const MetricValue& value : values) numbers.push_back(value.value);
  return numbers;
}

class Tuner {
 public:
  Tuner(const TuneTask& task, const Work& work) : task_(task), work_(work), settings_(task.settings) {
    // Joint forces and the theory error, which is always reported, need every rod.
    settings_.only = {false, true, true, false};
    start_ = start_of(task);
    for (const TuneVariable& variable : task.variables) {
      lower_.push_back(variable.lower);
      upper_.push_back(variable.upper);
    }
    if (auto_modes()) settings_.modes = modes_needed(start_, {});
    aims_ = std::make_unique<DesignAims>(task.goal, task.keeps, make_model(scene_at(start_), settings_));
  }

  TuneResult run() {
    TuneResult result;
    result.start = start_;
    for (const ConditionPart& part : aims_->parts()) result.condition_of.push_back(part.of);
    DesignSpace space = space_of([this](const std::vector<double>& x) { return numbers_at(task_, x); },
                                 [this](const std::vector<double>& x) { return span_at(task_, x); });
    // What is wrong with the question shows at the start.
    aims_->scale_by(numbers_of(space.values(start_)));
    DesignProblem problem = problem_over(space, start_, lower_, upper_, !speeds_vary(task_));
    result.design = first_search(problem);
    confirm(space, problem, result);
    result.tuned = to_vector(result.design.x);
    report(space, problem, result);
    result.num_modes = std::get<int>(settings_.modes);
    result.counts = counts_;
    result.without_response = without_response_;
    stages(result);
    return result;
  }

 private:
  bool auto_modes() const { return is_auto(task_.settings.modes); }
  Scene scene_at(const std::vector<double>& x) const { return task_.family.scene(numbers_at(task_, x)); }

  // As many as the ends of the range and `speeds` need.
  int modes_needed(const std::vector<double>& x, std::vector<double> speeds) const {
    const bool margin =
        std::ranges::any_of(task_.keeps, [](const Keep& keep) { return is_margin(keep.metric); }) ||
        std::ranges::any_of(task_.goal.terms, [](const GoalTerm& term) { return is_margin(term.metric); });
    Settings settings = task_.settings;
    settings.only = {true, margin, false, false};
    const SceneModel model = make_model(scene_at(x), settings);
    const SpeedSpan span = span_at(task_, x);
    speeds.insert(speeds.end(), {span.from, span.to});
    int modes = 1;
    for (const double speed : speeds) modes = most_modes(analyse(model, speed, settings).rods, modes);
    return modes;
  }

  DesignSpace space_of(DesignSpace::At numbers, DesignSpace::SpanAt span) {
    return {task_.family,      settings_, task_.heights, std::move(numbers), std::move(span), aims_->metrics(),
            aims_->required(), counts_,   work_};
  }

  // The worst cases on more speeds, with the errors of their values, and with the modes needed at this design. Where
  // that is not what the search knew, it goes on from there.
  void confirm(DesignSpace& space, DesignProblem& problem, TuneResult& result) {
    while (true) {
      const std::vector<double> x = to_vector(result.design.x);
      const auto began = std::chrono::steady_clock::now();
      const std::vector<MetricValue> values = confirmed_ = space.values(x, verification);
      ++result.confirmations;
      const auto checked = aims_->design_values(numbers_of(values));
      const DesignValues& known = result.design.values;
      const bool conditions = known.conditions.size() > 0;
      Eigen::VectorXd off = Eigen::VectorXd::Zero(known.conditions.size()), needed = aims_->allowance_for(values);
      if (checked) off = checked->conditions - known.conditions;
      result.agrees = checked &&
                      std::abs(checked->goal - known.goal) <= verification_tolerance * std::abs(known.goal) &&
                      (!conditions || off.maxCoeff() <= verification_tolerance);
      // Excess without allowance, with the error.
      result.holds = result.design.status == DesignStatus::infeasible || !conditions ||
                     (checked && (checked->conditions - aims_->allowance + needed).maxCoeff() <= 0);
      int modes = std::get<int>(settings_.modes);
      if (auto_modes()) {
        std::vector<double> speeds;
        for (const MetricValue& value : values)
          if (value.speed) speeds.push_back(*value.speed);
        modes = std::max(modes, modes_needed(x, speeds));
      }
      result.modes_suffice = modes == std::get<int>(settings_.modes);
      verification_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();

      const int left = task_.options.max_evaluations - static_cast<int>(result.design.trials.size()) -
                       result.confirmations - 1;  // the next confirmation
      if (result.verified() || result.rounds == most_rounds || left < 1 || !needed.allFinite()) return;
      if (task_.options.stop && task_.options.stop()) return;
      ++result.rounds;
      std::string why;
      if (!result.agrees) {
        space.refine(2);
        why += ", more speeds";
      }
      if (!result.modes_suffice) {
        settings_.modes = modes;
        space.forget();
        aims_->scale_by(numbers_of(space.values(start_)));
        why += fmt::format(", {} modes", modes);
      }
      if (!result.holds) {
        // A little more than the errors, which are not quite the same at the next design.
        aims_->allowance = aims_->allowance.cwiseMax(1.05 * (needed + off.cwiseMax(0)));
        why += ", room for the values' errors";
      }
      problem.start = result.design.x;
      DesignOptions local = task_.options;
      local.only_local = true;
      local.max_evaluations = left;
      DesignResult again = optimise(problem, local);
      again.trials.insert(again.trials.begin(), result.design.trials.begin(), result.design.trials.end());
      again.num_missing += result.design.num_missing;
      again.num_gradients += result.design.num_gradients;
      const char* gap = again.evidence.starts_with(',') ? "" : " ";
      again.evidence = fmt::format("{}; with{}{}{}", result.design.evidence, why.substr(1), gap, again.evidence);
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
    DesignOptions options = task_.options;
    options.max_evaluations = std::max(1, options.max_evaluations - 1);  // and the confirmation
    try {
      return optimise(watched, options);
    } catch (const std::invalid_argument&) {
      if (any) throw;
      throw RequestError("vary", "no design", "bounds and speeds with some",
                         "found no design within the bounds that closes and has a periodic solution over all these "
                         "speeds; allowed: bounds and speeds with some");
    }
  }

  DesignProblem problem_over(DesignSpace& space, const std::vector<double>& start, const std::vector<double>& lower,
                             const std::vector<double>& upper, bool with_gradient) {
    DesignProblem problem;
    problem.lower = to_eigen(lower);
    problem.upper = to_eigen(upper);
    problem.start = to_eigen(start);
    problem.num_conditions = static_cast<int>(aims_->parts().size());
    problem.num_parts = static_cast<int>(aims_->goal_parts().size());
    problem.evaluate = [this, &space](const Eigen::VectorXd& x) -> std::optional<DesignValues> {
      const std::vector<MetricValue>* metrics = space.try_values(to_vector(x));
      if (!metrics) return std::nullopt;
      const std::vector<double> numbers = numbers_of(*metrics);
      std::optional<DesignValues> values = aims_->design_values(numbers);
      if (!values) ++without_response_;
      if (values) note_best(numbers);
      return values;
    };
    if (!with_gradient) return problem;
    problem.gradient = [this, &space, lower, upper](const Eigen::VectorXd& x) -> std::optional<DesignGradient> {
      const std::optional<Eigen::MatrixXd> slopes = space.gradients(to_vector(x), lower, upper);
      if (!slopes) return std::nullopt;
      return aims_->design_gradient(*slopes, numbers_of(space.values(to_vector(x))));
    };
    return problem;
  }

  // What each condition could have alone.
  void note_best(const std::vector<double>& numbers) {
    std::vector<double> values;  // by condition, of its worst part
    for (const auto& [keep, of] : aims_->parts()) {
      const double value = aims_->value_of(keep.metric, numbers);
      if (of == values.size()) {
        values.push_back(value);
      } else {
        values[of] = keep.at_least ? std::min(values[of], value) : std::max(values[of], value);
      }
    }
    if (best_.empty()) best_ = values;
    for (std::size_t j = 0; j < values.size(); ++j)
      best_[j] = task_.keeps[j].at_least ? std::max(best_[j], values[j]) : std::min(best_[j], values[j]);
  }

  static std::vector<RodMargin> judged(std::vector<MetricValue> margins) {
    std::vector<RodMargin> rods;
    for (MetricValue& margin : margins) {
      RodMargin& rod = rods.emplace_back(RodMargin{margin.where, std::move(margin), std::nullopt});
      const double value = rod.margin.value, error = rod.margin.error;
      if (!std::isnan(value))
        rod.verdict = value > error ? Verdict::stable : value < -error ? Verdict::unstable : Verdict::undecided;
    }
    return rods;
  }

  // Besides what was asked; the stress where all elastic links have a section.
  static std::vector<Metric> always_shown(const Scene& scene) {
    std::vector<Metric> metrics = {{MetricKind::deflection, "", 1, "deflection"},
                                   {MetricKind::margin, "", 1, "stable"}};
    const auto* linkage = std::get_if<Linkage>(&scene.model);
    if (!linkage) return metrics;
    metrics.push_back({MetricKind::mass, "", 1, "mass"});
    const std::vector<int> links = elastic_links(*linkage);
    if (links.empty()) return metrics;
    metrics.push_back({MetricKind::theory, "", 1, "theory"});
    if (std::ranges::all_of(links, [&](int link) { return body_at(*linkage, link)->elastic->section_height > 0; }))
      metrics.push_back({MetricKind::total_stress, "", 1, "total-stress"});
    return metrics;
  }

  void report(DesignSpace& space, const DesignProblem& problem, TuneResult& result) {
    std::vector<Metric> shown;
    for (const GoalTerm& term : task_.goal.terms) shown.push_back(term.metric);
    for (const Keep& keep : task_.keeps)
      if (std::ranges::find(shown, keep.metric) == shown.end()) shown.push_back(keep.metric);
    const Scene scene = scene_at(start_);
    for (const Metric& metric : always_shown(scene))
      if (std::ranges::find(shown, metric) == shown.end()) shown.push_back(metric);
    const auto began = std::chrono::steady_clock::now();
    DesignSpace::Report before = space.report(result.start, shown, verification, verification_tolerance);
    DesignSpace::Report after = space.report(result.tuned, shown, verification, verification_tolerance);
    report_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    for (std::size_t k = 0; k < shown.size(); ++k)
      result.rows.push_back({shown[k], before.values[k], after.values[k], before.confirmed[k], after.confirmed[k]});
    result.margins_before = judged(std::move(before.margins));
    result.margins_after = judged(std::move(after.margins));
    result.curves_before = std::move(before.curves);
    result.curves_after = std::move(after.curves);
    result.span_before = span_at(task_, result.start);
    result.span_after = span_at(task_, result.tuned);
    const std::vector<double> values_after = numbers_of(confirmed_);
    result.goal_before =
        task_.goal.weighted ? aims_->goal(numbers_of(space.values(start_))) : result.rows.front().before.value;
    result.goal_after = aims_->goal(values_after);
    result.goal_error = task_.goal.weighted ? aims_->goal_error(confirmed_) : result.rows.front().after.error;
    if (!task_.goal.weighted) result.goal_unit = unit_of(task_.goal.terms[0].metric.kind, scene);

    constexpr double active = 1e-3;
    result.sensitivity = design_sensitivity(problem, result.design.x, active);
    if (result.sensitivity) {
      result.slope_left_over = slope_left_over(*result.sensitivity, result.design);
      result.goal_gradient = aims_->sign() * result.sensitivity->upward;
      for (std::size_t k = 0; k < aims_->goal_parts().size(); ++k)
        if (result.sensitivity->weights(static_cast<Eigen::Index>(k)) > 0)
          result.worst_at_once.push_back(aims_->goal_parts()[k].name);
      if (result.worst_at_once.size() < 2) result.worst_at_once.clear();
    }
    // Of each condition the part that is nearest to its bound; relaxing the bound relaxes all parts.
    for (const Keep& keep : task_.keeps) {
      TuneCondition& condition = result.conditions.emplace_back();
      condition.keep = keep;
      condition.met = true;
      if (const std::size_t k = result.conditions.size() - 1; k < best_.size()) {
        condition.best = best_[k];
        condition.best_meets = keep.at_least ? best_[k] >= keep.bound : best_[k] <= keep.bound;
      }
    }
    const Eigen::VectorXd errors = aims_->allowance_for(confirmed_);
    std::vector<double> nearest(task_.keeps.size(), -HUGE_VAL);  // largest excess with its error
    for (std::size_t j = 0; j < aims_->parts().size(); ++j) {
      const auto& [keep, of] = aims_->parts()[j];
      const auto row = static_cast<Eigen::Index>(j);
      TuneCondition& condition = result.conditions[of];
      if (result.sensitivity) condition.multiplier += result.sensitivity->multipliers(row);
      const double value = aims_->value_of(keep.metric, values_after), excess = aims_->excess(keep, value);
      condition.met = condition.met && excess + errors(row) <= 0;
      // The room kept for the error is part of what the search is held by.
      condition.active = condition.active || excess + std::max(errors(row), aims_->allowance(row)) >= -active;
      if (excess + errors(row) <= nearest[of]) continue;
      nearest[of] = excess + errors(row);
      condition.where = keep.metric.name;
      condition.unit = aims_->unit_of(keep);
      condition.value = value;
      condition.error = errors(row) * aims_->unit_of(keep);
      condition.excess = excess;
    }
    for (std::size_t i = 0; result.sensitivity && i < task_.variables.size(); ++i)
      if (without_effect(problem, result, static_cast<Eigen::Index>(i)))
        result.without_effect.push_back(task_.variables[i].path);
    damping_sensitivity(result);
  }

  // Neither by its slopes, which vanish at a minimum too, nor half way to the farther bound.
  bool without_effect(const DesignProblem& problem, const TuneResult& result, Eigen::Index i) const {
    constexpr double slight = 1e-7;
    const DesignGradient& slopes = result.sensitivity->gradient;
    const DesignValues& here = result.design.values;
    const double goal = slight * std::abs(here.goal), width = problem.upper(i) - problem.lower(i);
    if (width * std::abs(slopes.goal(i)) > goal || (width * slopes.parts.col(i).array().abs() > goal).any() ||
        (width * slopes.conditions.col(i).array().abs() > slight).any())
      return false;
    Eigen::VectorXd x = result.design.x;
    const bool up = problem.upper(i) - x(i) > x(i) - problem.lower(i);
    x(i) = 0.5 * (x(i) + (up ? problem.upper : problem.lower)(i));
    const std::optional<DesignValues> there = problem.evaluate(x);
    return there && std::abs(there->goal - here.goal) <= goal &&
           ((there->parts - here.parts).array().abs() <= goal).all() &&
           ((there->conditions - here.conditions).array().abs() <= slight).all();
  }

  // One variable, a factor on the internal damping of all links, at the tuned design. Of the best goal,
  //     df*/dp = sum_k mu_k df_k/dp + sum_j lambda_j dg_j/dp.
  void damping_sensitivity(TuneResult& result) {
    const Numbers tuned = numbers_at(task_, result.tuned);
    const SceneFamily as_tuned = task_.family.with(tuned);
    const std::vector<std::string> damping = as_tuned.damping_paths();
    const Scene scene = as_tuned.scene();
    const auto* linkage = std::get_if<Linkage>(&scene.model);
    if (!linkage || damping.empty() || !(std::abs(result.goal_after) > 0)) return;
    DesignSpace space = space_of(
        [&](const std::vector<double>& factor) {
          Numbers numbers = tuned;
          for (const std::string& path : damping) {
            if (const double value = as_tuned.value(path); value > 0) numbers.push_back({path, factor[0] * value});
          }
          return numbers;
        },
        [&](const std::vector<double>&) { return span_at(task_, result.tuned); });
    const DesignProblem problem = problem_over(space, {1}, {0.5}, {1.5}, true);
    const auto sensitivity = design_sensitivity(problem, Eigen::VectorXd::Ones(1));
    if (!sensitivity) return;
    const double own = sensitivity->upward(0);
    result.damping_sensitivity = aims_->sign() * own / result.goal_after;
    if (!result.sensitivity) return;
    const DesignSensitivity& held = *result.sensitivity;
    const double fixed = held.weights.sum() > 0 ? held.weights.dot(sensitivity->gradient.parts.col(0)) : own;
    const double best = fixed + held.multipliers.dot(sensitivity->gradient.conditions.col(0));
    result.damping_sensitivity_of_best = aims_->sign() * best / result.goal_after;
  }

  void stages(TuneResult& result) const {
    std::string computed, skipped;
    const auto say = [&](bool asked, const char* what) {
      std::string& text = asked ? computed : skipped;
      text += (text.empty() ? "" : ", ") + std::string(what);
    };
    const auto any = [&](auto&& holds) { return std::ranges::any_of(aims_->metrics(), holds); };
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
  const Work& work_;
  Settings settings_;
  std::vector<double> start_, lower_, upper_;
  std::unique_ptr<DesignAims> aims_;
  std::vector<MetricValue> confirmed_;  // of the tuned design, by metric
  TuneCounts counts_;
  std::vector<double> best_;  // of all designs, by condition alone
  int without_response_ = 0;
  double verification_seconds_ = 0, report_seconds_ = 0;
};

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

TuneResult tune(const TuneTask& task, const Work& work) { return Tuner(task, work).run(); }

}  // namespace hb
