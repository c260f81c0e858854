#include "hb/analysis/tune/tune_report.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "hb/analysis/range_warnings.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

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

std::vector<RodMargin> judged(std::vector<MetricValue> margins) {
  std::vector<RodMargin> rods;
  for (MetricValue& margin : margins) {
    RodMargin& rod = rods.emplace_back(RodMargin{margin.where, std::move(margin), std::nullopt});
    const double value = rod.margin.value, error = rod.margin.error;
    if (!std::isnan(value))
      rod.verdict = value > error ? Verdict::stable : value < -error ? Verdict::unstable : Verdict::undecided;
  }
  return rods;
}

// Besides what was asked, of elastic links; the stress where all of them have a section.
std::vector<Metric> always_shown(const Scene& scene) {
  std::vector<Metric> metrics = {{MetricKind::deflection, "", 1, "deflection"}, {MetricKind::margin, "", 1, "stable"}};
  const auto* linkage = std::get_if<Linkage>(&scene.model);
  if (!linkage) return metrics;
  const std::vector<int> links = elastic_links(*linkage);
  if (links.empty()) return {};
  metrics.push_back({MetricKind::mass, "", 1, "mass"});
  metrics.push_back({MetricKind::theory, "", 1, "theory"});
  if (std::ranges::all_of(links, [&](int link) { return body_at(*linkage, link)->elastic->section_height > 0; }))
    metrics.push_back({MetricKind::total_stress, "", 1, "total-stress"});
  return metrics;
}

// Values and curves before and after.
void compare_designs(TuneSearch& search, const Scene& scene, TuneResult& result) {
  const TuneTask& task = search.task();
  std::vector<Metric> shown;
  for (const GoalTerm& term : task.goal.terms) shown.push_back(term.metric);
  for (const Keep& keep : task.keeps)
    if (std::ranges::find(shown, keep.metric) == shown.end()) shown.push_back(keep.metric);
  for (const Metric& metric : always_shown(scene))
    if (std::ranges::find(shown, metric) == shown.end()) shown.push_back(metric);
  const auto report = [&](const std::vector<double>& x) {
    return search.space().report(x, shown, TuneSearch::verification, TuneSearch::verification_tolerance);
  };
  DesignSpace::Report before = report(result.start), after = report(result.tuned);
  for (std::size_t k = 0; k < shown.size(); ++k)
    result.rows.push_back({shown[k], before.values[k], after.values[k], before.confirmed[k], after.confirmed[k]});
  result.margins_before = judged(std::move(before.margins));
  result.margins_after = judged(std::move(after.margins));
  result.curves_before = std::move(before.curves);
  result.curves_after = std::move(after.curves);
  result.span_before = span_at(task, result.start);
  result.span_after = span_at(task, result.tuned);
}

void report_goal(TuneSearch& search, const Scene& scene, TuneResult& result) {
  const Goal& goal = search.task().goal;
  const DesignAims& aims = search.aims();
  const TuneRow& first = result.rows.front();
  result.goal_before = goal.weighted ? aims.goal(numbers_of(search.space().values(result.start))) : first.before.value;
  result.goal_after = aims.goal(numbers_of(search.confirmed()));
  result.goal_error = goal.weighted ? aims.goal_error(search.confirmed()) : first.after.error;
  if (!goal.weighted) result.goal_unit = unit_of(goal.terms[0].metric.kind, scene);
}

constexpr double active = 1e-3;  // excess from which a condition holds the goal

void report_sensitivity(TuneSearch& search, TuneResult& result) {
  const DesignAims& aims = search.aims();
  result.sensitivity = design_sensitivity(search.problem(), result.design.x, active);
  if (!result.sensitivity) return;
  result.slope_left_over = slope_left_over(*result.sensitivity, result.design);
  result.goal_gradient = aims.sign() * result.sensitivity->upward;
  for (std::size_t k = 0; k < aims.goal_parts().size(); ++k)
    if (result.sensitivity->weights(static_cast<Eigen::Index>(k)) > 0)
      result.worst_at_once.push_back(aims.goal_parts()[k].name);
  if (result.worst_at_once.size() < 2) result.worst_at_once.clear();
}

// Of each condition the part that is nearest to its bound; relaxing the bound relaxes all parts.
void report_conditions(const TuneSearch& search, TuneResult& result) {
  const DesignAims& aims = search.aims();
  const std::vector<Keep>& keeps = search.task().keeps;
  const std::vector<double>& best = search.best();
  for (const Keep& keep : keeps) {
    TuneCondition& condition = result.conditions.emplace_back();
    condition.keep = keep;
    condition.met = true;
    if (const std::size_t k = result.conditions.size() - 1; k < best.size()) {
      condition.best = best[k];
      condition.best_meets = keep.at_least ? best[k] >= keep.bound : best[k] <= keep.bound;
    }
  }
  const std::vector<double> values = numbers_of(search.confirmed());
  const Eigen::VectorXd errors = aims.allowance_for(search.confirmed());
  std::vector<double> nearest(keeps.size(), -HUGE_VAL);  // largest excess with its error
  for (std::size_t j = 0; j < aims.parts().size(); ++j) {
    const auto& [keep, of] = aims.parts()[j];
    const auto row = static_cast<Eigen::Index>(j);
    TuneCondition& condition = result.conditions[of];
    if (result.sensitivity) condition.multiplier += result.sensitivity->multipliers(row);
    const double value = aims.value_of(keep.metric, values), excess = aims.excess(keep, value);
    condition.met = condition.met && excess + errors(row) <= 0;
    // The room kept for the error is part of what the search is held by.
    condition.active = condition.active || excess + std::max(errors(row), aims.allowance(row)) >= -active;
    if (excess + errors(row) <= nearest[of]) continue;
    nearest[of] = excess + errors(row);
    condition.where = keep.metric.name;
    condition.unit = aims.unit_of(keep);
    condition.value = value;
    condition.error = errors(row) * aims.unit_of(keep);
    condition.excess = excess;
  }
}

// Neither by its slopes, which vanish at a minimum too, nor half way to the farther bound.
bool without_effect(const DesignProblem& problem, const TuneResult& result, Eigen::Index i) {
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
void damping_sensitivity(TuneSearch& search, TuneResult& result) {
  const TuneTask& task = search.task();
  const Numbers tuned = numbers_at(task, result.tuned);
  const SceneFamily as_tuned = task.family.with(tuned);
  const std::vector<std::string> damping = as_tuned.damping_paths();
  const Scene scene = as_tuned.scene();
  const auto* linkage = std::get_if<Linkage>(&scene.model);
  if (!linkage || damping.empty() || !(std::abs(result.goal_after) > 0)) return;
  DesignSpace space = search.space_of(
      [&](const std::vector<double>& factor) {
        Numbers numbers = tuned;
        for (const std::string& path : damping) {
          if (const double value = as_tuned.value(path); value > 0) numbers.push_back({path, factor[0] * value});
        }
        return numbers;
      },
      [&](const std::vector<double>&) { return span_at(task, result.tuned); });
  const DesignProblem problem = search.problem_over(space, {1}, {0.5}, {1.5}, true);
  const auto sensitivity = design_sensitivity(problem, Eigen::VectorXd::Ones(1));
  if (!sensitivity) return;
  const double own = sensitivity->upward(0);
  result.damping_sensitivity = search.aims().sign() * own / result.goal_after;
  if (!result.sensitivity) return;
  const DesignSensitivity& held = *result.sensitivity;
  const double fixed = held.weights.sum() > 0 ? held.weights.dot(sensitivity->gradient.parts.col(0)) : own;
  const double best = fixed + held.multipliers.dot(sensitivity->gradient.conditions.col(0));
  result.damping_sensitivity_of_best = search.aims().sign() * best / result.goal_after;
}

// Bounds need not be reached: only what was hardly meant matters there.
std::vector<std::string> warnings_of(const TuneTask& task, const TuneResult& result) {
  std::vector<double> lower, upper;
  for (const TuneVariable& variable : task.variables) {
    lower.push_back(variable.lower);
    upper.push_back(variable.upper);
  }
  return place_warnings(task.family, {{numbers_at(task, result.start), "the design before"},
                                      {numbers_at(task, result.tuned), "the design found"},
                                      {numbers_at(task, lower), "the lower bounds", Concern::gravity},
                                      {numbers_at(task, upper), "the upper bounds", Concern::gravity}});
}

void stages(const TuneSearch& search, double report_seconds, TuneResult& result) {
  const TuneCounts& counts = search.counts();
  std::string computed, skipped;
  const auto say = [&](bool asked, const char* what) {
    std::string& text = asked ? computed : skipped;
    text += (text.empty() ? "" : ", ") + std::string(what);
  };
  const auto any = [&](auto&& holds) { return std::ranges::any_of(search.aims().metrics(), holds); };
  say(any([](const Metric& m) {
        return depends_on_speed(m.kind) && !is_margin(m) && m.kind != MetricKind::clearance &&
               m.kind != MetricKind::speed_range;
      }),
      "response");
  say(any(is_margin), "stability");
  say(any(needs_forces), "joint forces");
  const TuneCounts& searched = search.searched();
  result.stages.push_back({"designs", searched.analyses_seconds,
                           fmt::format("{} analysed{}: {}", searched.analyses,
                                       result.design.num_for_slopes == 0
                                           ? ""
                                           : fmt::format(", {} of them for slopes", result.design.num_for_slopes),
                                       computed.empty() ? "no speeds" : computed),
                           false});
  if (result.analyses_after > 0)
    result.stages.push_back({"slopes at the design found", counts.analyses_seconds - searched.analyses_seconds,
                             fmt::format("{} analysed with a number changed", result.analyses_after), false});
  if (!skipped.empty()) result.stages.push_back({skipped, 0, "no goal and no condition needs it", true});
  result.stages.push_back({"gradients", counts.gradients_seconds,
                           fmt::format("{} by adjoint, {} by differences of whole analyses", counts.gradients,
                                       counts.gradients_by_differences),
                           false});
  result.stages.push_back({"verification", search.confirmation_seconds(),
                           fmt::format("on {} times the speeds", TuneSearch::verification), false});
  result.stages.push_back({"curves", report_seconds, "before and after", false});
}

}  // namespace

void report_design(TuneSearch& search, TuneResult& result) {
  const TuneTask& task = search.task();
  const Scene scene = search.scene_at(result.start);
  const Stopwatch watch;
  compare_designs(search, scene, result);
  const double report_seconds = watch.seconds();
  report_goal(search, scene, result);
  report_sensitivity(search, result);
  report_conditions(search, result);
  for (std::size_t i = 0; result.sensitivity && i < task.variables.size(); ++i)
    if (without_effect(search.problem(), result, static_cast<Eigen::Index>(i)))
      result.without_effect.push_back(task.variables[i].path);
  damping_sensitivity(search, result);
  result.num_modes = search.num_modes();
  result.counts = search.searched();
  result.counts.gradients = search.counts().gradients;
  result.counts.gradients_by_differences = search.counts().gradients_by_differences;
  result.analyses_after = search.counts().analyses - search.searched().analyses;
  result.without_response = search.without_response();
  result.warnings = warnings_of(task, result);
  stages(search, report_seconds, result);
}

}  // namespace hb
