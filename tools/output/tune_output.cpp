#include "tools/output/tune_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/scene/scene_keys.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/scene_in_folder.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

double positive_degrees(double angle) {
  const double degrees = std::fmod(angle * degrees_per_radian, 360);
  return degrees < 0 ? degrees + 360 : degrees;
}

std::string label(MetricKind kind, bool linkage) {
  switch (kind) {
    case MetricKind::deflection:
      return linkage ? "largest deflection" : "largest |q_i|";
    case MetricKind::stress:
      return "largest bending stress";
    case MetricKind::total_stress:
      return "largest stress";
    case MetricKind::safety:
      return "least safety";
    case MetricKind::force:
      return "largest joint force";
    case MetricKind::torque_ripple:
      return "torque ripple";
    case MetricKind::mass:
      return "mass of elastic links";
    case MetricKind::frequency:
      return "lowest natural frequency";
    case MetricKind::margin:
      return "stability margin";
    case MetricKind::margin_per_turn:
      return "margin per turn";
    case MetricKind::theory:
      return "theory error";
    case MetricKind::clearance:
      return "clearance";
    case MetricKind::speed_range:
      return "speed range";
  }
  return "";
}

std::string label(const Metric& metric, const Scene& scene) {
  return label(metric.kind, std::holds_alternative<Linkage>(scene.model)) +
         (metric.name.empty() ? "" : " " + metric.name) +
         (metric.kind == MetricKind::clearance ? fmt::format(" of orders 1..{}", metric.orders) : "");
}

double shown_speed(const TuneTask& task, double speed, const Units& units) {
  return task.in_rpm ? rpm_of(speed, units) : speed;
}

std::string span_text(const TuneTask& task, const SpeedSpan& span, const Units& units) {
  const std::string unit = speed_unit(task, units);
  const double from = shown_speed(task, span.from, units), to = shown_speed(task, span.to, units);
  return from == to ? fmt::format("{:.6g} {}", from, unit) : fmt::format("{:.6g} to {:.6g} {}", from, to, unit);
}

Json span_json(const TuneTask& task, const SpeedSpan& span, const Units& units) {
  return {{task.in_rpm ? "rpm" : "omega", {shown_speed(task, span.from, units), shown_speed(task, span.to, units)}}};
}

// "CD, 3000 rpm, 0.512 l, 123.45 deg"
std::string place(const TuneTask& task, const MetricValue& value, const Units& units) {
  std::string text = value.where;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (value.speed) add(fmt::format("{:.6g} {}", *value.speed / task.speed_unit, speed_unit(task, units)));
  if (value.position) add(fmt::format("{:.4f} l", *value.position));
  if (value.crank_angle) add(fmt::format("{:.2f} deg", positive_degrees(*value.crank_angle)));
  if (!value.against.empty()) add("against " + value.against);
  return text;
}

// Digits as far as the error allows and two more; > or < where more speeds show another value.
std::string worst_text(const MetricValue& value, bool confirmed, MetricKind kind) {
  const std::string mark = confirmed ? "" : better_large(kind) ? "<" : ">";
  const int digits = kind == MetricKind::theory ? 2 : trusted_digits(value.value, value.error);
  return mark + fmt::format("{:.{}g}", value.value, digits);
}

std::string at_bound(const TuneVariable& variable, double x) {
  const double slack = 1e-6 * (variable.upper - variable.lower);
  if (x - variable.lower <= slack) return "at its lower bound";
  if (variable.upper - x <= slack) return "at its upper bound";
  return "";
}

const char* status_word(DesignStatus status) {
  switch (status) {
    case DesignStatus::optimal:
      return "optimal";
    case DesignStatus::stopped:
      return "stopped";
    case DesignStatus::infeasible:
      return "infeasible";
  }
  return "";
}

// What the goal gains when the bound is relaxed by a hundredth of the condition's unit.
double gain(const TuneCondition& condition) { return 0.01 * condition.multiplier; }

// "CD.section.height = 8 (tied; scene: 7.746)"
std::string changes_text(const TuneTask& task) {
  std::string text;
  for (const StartChange& change : start_changes(task))
    text += fmt::format("{}{} = {:.8g} ({}; scene: {:.8g})", text.empty() ? "" : ", ", change.path, change.value,
                        change.tied ? "tied" : "moved", change.scene);
  return text;
}

// "1 % of the bound (0.02 mm)"
std::string relaxation(const TuneCondition& condition, const Scene& scene) {
  const std::string unit = unit_of(condition.keep.metric.kind, scene);
  const char* what = condition.unit == condition.keep.bound ? "the bound"
                     : is_margin(condition.keep.metric)     ? "the margin at the start"
                                                            : "1";
  return fmt::format("1 % of {} ({:.3g}{}{})", what, 0.01 * condition.unit, unit.empty() ? "" : " ", unit);
}

// "NOT MET: rocker, 0.061 +/- 2.2e-01; ...", with the best that this condition alone could have.
std::string not_met_text(const TuneResult& result, const TuneCondition& condition, const Scene& scene) {
  const MetricKind kind = condition.keep.metric.kind;
  std::string text = fmt::format("NOT MET: {}{}{}", condition.where, condition.where.empty() ? "" : ", ",
                                 with_error(condition.value, condition.error));
  if (condition.excess <= 0)
    text += is_margin(condition.keep.metric)
                ? "; it is met with the modes kept, but those left out may change it so far"
                : "; the value meets the bound, but not with its error: more --modes may";
  if (result.design.status != DesignStatus::infeasible) return text;
  const std::string unit = unit_of(kind, scene);
  text += fmt::format("; best of all designs tried {:.6g}{}{}", condition.best, unit.empty() ? "" : " ", unit);
  if (!condition.best_meets) return text + ", which does not meet it either";
  return text + (result.conditions.size() > 1 ? ", which meets it, but not together with the others" : "");
}

// The first-order conditions hold: the slopes of goal and conditions balance. Where several rods or speeds are worst at
// once the goal has a kink, its slopes belong to one side, and neither they nor the multipliers say what a change
// gains.
bool smooth(const TuneResult& result) {
  constexpr double largest_residual = 0.02;
  return result.sensitivity && result.slope_left_over <= largest_residual;
}

std::string bound_text(const Keep& keep, const Scene& scene) {
  const std::string unit = unit_of(keep.metric.kind, scene);
  return fmt::format("{} {:g}{}{}", keep.at_least ? ">=" : "<=", keep.bound, unit.empty() ? "" : " ", unit);
}

Json metric_json(const TuneTask& task, const MetricValue& value, bool confirmed, const Units& units) {
  Json json = {{"value", number(value.value)}, {"error", number(value.error)}, {"confirmed", confirmed}};
  if (value.theory_error) json["theory_error"] = number(*value.theory_error);
  if (!value.where.empty()) json["at"] = value.where;
  if (value.speed) json[task.in_rpm ? "rpm" : "omega"] = shown_speed(task, *value.speed, units);
  if (!value.against.empty()) json["against"] = value.against;
  if (value.position) json["x_over_l"] = *value.position;
  if (value.crank_angle) json["crank_angle"] = scene_angle(*value.crank_angle, units);
  return json;
}

std::string not_met(const TuneResult& result) {
  std::string names;
  for (const TuneCondition& condition : result.conditions)
    if (!condition.met) names += (names.empty() ? "" : ", ") + condition.keep.text;
  return names;
}

// "Six-link mechanism: the design found is stable (AB, CD) over 300 to 3000 rpm; before: UNSTABLE because of AB"
std::string outcome_line(const TuneTask& task, const TuneResult& result, const Scene& scene) {
  const std::string after = mechanism_verdict(tune_verdicts(result.margins_after)),
                    before = mechanism_verdict(tune_verdicts(result.margins_before));
  std::string line = scene_name(scene);
  if (!after.empty())
    line += fmt::format(": the {} is {} {} {}",
                        result.design.status == DesignStatus::infeasible ? "nearest design" : "design found", after,
                        result.span_after.from == result.span_after.to ? "at" : "over",
                        span_text(task, result.span_after, scene.units));
  if (!before.empty()) line += fmt::format("; before: {}", before);
  return line + "\n";
}

std::string variables_text(const TuneTask& task, const TuneResult& result) {
  std::string text = fmt::format("\n{:<28}{:>15}{:>15}  {}\n", "variable", "before", "after", "bounds");
  for (std::size_t i = 0; i < task.variables.size(); ++i) {
    const TuneVariable& variable = task.variables[i];
    const std::string bound = at_bound(variable, result.tuned[i]);
    text += fmt::format("{:<28}{:>15.8g}{:>15.8g}  {:g} to {:g}{}\n", variable.path, result.start[i], result.tuned[i],
                        variable.lower, variable.upper, bound.empty() ? "" : ", " + bound);
    for (const TiedNumber& tied : variable.tied)
      text += fmt::format("{:<28}{:>15.8g}{:>15.8g}  tied to {}\n", tied.path, tied.factor * result.start[i],
                          tied.factor * result.tuned[i], variable.path);
  }
  return text;
}

std::string theory_text(const MetricValue& value) {
  if (!value.theory_error) return "";
  return std::isfinite(*value.theory_error) ? fmt::format("{:.1e}", *value.theory_error) : "beyond";
}

std::string worst_cases_text(const TuneTask& task, const TuneResult& result, const Scene& scene) {
  std::string text =
      fmt::format("\n{:<34}{:>17}{:>17}{:>10}{:>10}  {}\n", "worst case", "before", "after", "error", "theory", "unit");
  bool confirmed = true, judged = false, unstable_before = false, unstable_after = false;
  for (const TuneRow& row : result.rows) {
    const MetricKind kind = row.metric.kind;
    text += fmt::format("{:<34}{:>17}{:>17}{:>10}{:>10}  {}\n", label(row.metric, scene),
                        worst_text(row.before, row.before_confirmed, kind),
                        worst_text(row.after, row.after_confirmed, kind),
                        row.after.error > 0 ? fmt::format("{:.1e}", row.after.error) : "", theory_text(row.after),
                        unit_of(kind, scene));
    judged = judged || row.after.theory_error.has_value();
    confirmed = confirmed && row.before_confirmed && row.after_confirmed;
    unstable_before = unstable_before || (is_margin(row.metric) && !(row.before.value > 0));
    unstable_after = unstable_after || (is_margin(row.metric) && !(row.after.value > 0));
  }
  if (task.goal.weighted)
    text += fmt::format("{:<34}{:>17.7g}{:>17.{}g}{:>10.1e}\n", "goal", result.goal_before, result.goal_after,
                        trusted_digits(result.goal_after, result.goal_error), result.goal_error);
  if (!confirmed)
    text += "  > or <: another value on four times the speeds; the worst case is at least the one shown\n";
  if (judged) text += "  theory: what the exact model would change there of the value after, in its unit\n";
  if (std::ranges::any_of(result.rows, [](const TuneRow& row) { return row.metric.kind == MetricKind::stress; }))
    text += "  bending alone: the axial force adds |N|/area to it (total-stress has both together)\n";
  for (const bool after : {false, true})
    if (after ? unstable_after : unstable_before)
      text += fmt::format("  the design {} is not stable over all these speeds: its response there would not be seen\n",
                          after ? "after" : "before");
  return text;
}

std::string places_text(const TuneTask& task, const TuneResult& result, const Scene& scene) {
  std::size_t width = 38;
  for (const TuneRow& row : result.rows) width = std::max(width, place(task, row.before, scene.units).size());
  std::string text = fmt::format("\n{:<36}{:<{}}  {}\n", "where", "before", width, "after");
  for (const TuneRow& row : result.rows) {
    const std::string before = place(task, row.before, scene.units), after = place(task, row.after, scene.units);
    if (!before.empty() || !after.empty())
      text += fmt::format("{:<36}{:<{}}  {}\n", label(row.metric, scene), before, width, after);
  }
  return text;
}

std::string conditions_text(const TuneResult& result, const Scene& scene) {
  std::string text;
  if (!result.conditions.empty()) text += "\ncondition                            bound               \n";
  for (const TuneCondition& condition : result.conditions) {
    text += fmt::format("{:<36} {:<20}{}", label(condition.keep.metric, scene), bound_text(condition.keep, scene),
                        !condition.met     ? not_met_text(result, condition, scene)
                        : condition.active ? "active"
                                           : "met with room");
    if (condition.met && condition.active && condition.multiplier > 0 && smooth(result))
      text += fmt::format(": relaxed by {}, the goal gains {:.3g}{}{} ({:.3g} %)", relaxation(condition, scene),
                          gain(condition), result.goal_unit.empty() ? "" : " ", result.goal_unit,
                          100 * gain(condition) / std::abs(result.goal_after));
    text += "\n";
  }
  return text;
}

// "+1.2 %"; what is too small to matter, and may be rounding, in words.
std::string per_cent(double change) {
  constexpr double least = 1e-3;
  if (change == 0) return "  nothing";
  if (std::abs(change) < least) return fmt::format("  less than {:g} %", least);
  return fmt::format("{:>+10.3g} %", change);
}

std::string changes_of_goal_text(const TuneTask& task, const TuneResult& result) {
  std::string text;
  if (result.sensitivity && !smooth(result) && result.design.status == DesignStatus::optimal)
    text += fmt::format(
        "several worst cases meet at this design: changes below hold to one side, and what relaxing a condition gains "
        "is not given ({:.0f} % of the goal's slope is not balanced)\n",
        100 * result.slope_left_over);
  if (result.goal_gradient.size() > 0 && result.goal_after != 0) {
    text += fmt::format("\n{:<38}{}\n", "1 % more of", "  changes the goal by");
    if (!result.worst_at_once.empty())
      text += fmt::format("  {} are worst at once: less changes the goal in another way than more\n",
                          fmt::join(result.worst_at_once, " and "));
    for (std::size_t i = 0; i < task.variables.size(); ++i) {
      const double change = result.goal_gradient(static_cast<Eigen::Index>(i)) * result.tuned[i];
      text += fmt::format("{:<38}{}\n", task.variables[i].path, per_cent(change / result.goal_after));
    }
    if (result.damping_sensitivity)
      text += fmt::format("{:<38}{}\n", "internal damping, all links", per_cent(*result.damping_sensitivity));
    if (result.damping_sensitivity_of_best)
      text +=
          fmt::format("{:<38}{}\n", "  it, and the variables follow it", per_cent(*result.damping_sensitivity_of_best));
  }
  return text;
}

std::string search_text(const TuneResult& result, const Scene& scene) {
  std::string text = fmt::format("\n{} designs analysed: {}, and {} on four times the speeds\n",
                                 result.design.trials.size() + static_cast<std::size_t>(result.confirmations),
                                 result.design.evidence, result.confirmations);
  if (result.design.num_for_slopes > 0)
    text +=
        fmt::format("{} of these are neighbours of others, for slopes by differences\n", result.design.num_for_slopes);
  if (result.analyses_after > 0)
    text += fmt::format("{} more of the design found with a number changed, for its slopes\n", result.analyses_after);
  if (result.counts.gradients > 0)
    text += counted(result.counts.gradients, "gradient") + " from adjoint solutions and Floquet vectors\n";
  if (result.counts.not_closing > 0)
    text += fmt::format("designs tried that do not close over the turn: {}\n", result.counts.not_closing);
  if (result.counts.refused > 0)
    text += fmt::format("designs tried that are no possible scene: {}\n", result.counts.refused);
  if (result.without_response > 0)
    text += fmt::format("designs tried that have no periodic solution at some speed: {}\n", result.without_response);
  if (std::holds_alternative<Linkage>(scene.model)) text += counted(result.num_modes, "mode") + " of each rod\n";
  if (result.agrees) text += "worst cases confirmed on four times the speeds\n";
  if (result.holds && !result.conditions.empty() && result.design.status != DesignStatus::infeasible)
    text += "conditions hold with the estimated errors of their values\n";
  return text;
}

Json variables_json(const TuneTask& task, const TuneResult& result) {
  Json variables = Json::array();
  for (std::size_t i = 0; i < task.variables.size(); ++i) {
    const TuneVariable& variable = task.variables[i];
    Json entry = {{"path", variable.path},
                  {"before", result.start[i]},
                  {"after", result.tuned[i]},
                  {"lower", variable.lower},
                  {"upper", variable.upper}};
    if (variable.moved_from) entry["moved_from"] = *variable.moved_from;
    if (result.sensitivity) {
      const auto k = static_cast<Eigen::Index>(i);
      entry["goal_gradient"] = result.goal_gradient(k);
      entry["multiplier_lower"] = result.sensitivity->below(k);
      entry["multiplier_upper"] = result.sensitivity->above(k);
    }
    Json tied = Json::object();
    for (const TiedNumber& number : variable.tied) tied[number.path] = number.factor * result.tuned[i];
    if (!tied.empty()) entry["tied"] = std::move(tied);
    variables.push_back(std::move(entry));
  }
  return variables;
}

Json conditions_json(const TuneResult& result) {
  Json conditions = Json::array();
  for (const TuneCondition& condition : result.conditions) {
    conditions.push_back({{"condition", condition.keep.text},
                          {"value", number(condition.value)},
                          {"error", number(condition.error)},
                          {"at", condition.where},
                          {"best_tried", number(condition.best)},
                          {"bound", condition.keep.bound},
                          {"met", condition.met},
                          {"active", condition.active},
                          {"multiplier", smooth(result) ? Json(condition.multiplier) : Json()},
                          {"gain_of_1_percent", smooth(result) ? Json(gain(condition)) : Json()}});
  }
  return conditions;
}

}  // namespace

std::string shortfall(const TuneResult& result) {
  if (result.design.status == DesignStatus::infeasible)
    return fmt::format(
        "no design that meets all conditions was found within the bounds{}; at the nearest one not met: {}",
        result.design.out_of_analyses ? " by the analyses or the time allowed" : "", not_met(result));
  if (!result.agrees) return "the worst cases found on more speeds differ from those of the search";
  if (!result.modes_suffice)
    return fmt::format("the design found needs more modes for the tolerance than the {} of the search",
                       result.num_modes);
  if (!result.holds) return "with the errors of their values these conditions may not be met: " + not_met(result);
  if (result.design.status == DesignStatus::stopped)
    return "the analyses or the time allowed ran out before the search had settled";
  return "";
}

const char* scene_file(const TuneResult& result) {
  return result.design.status == DesignStatus::infeasible ? nearest_file : tuned_file;
}

NamedVerdicts tune_verdicts(const std::vector<RodMargin>& margins) {
  NamedVerdicts verdicts;
  for (const RodMargin& rod : margins) verdicts.emplace_back(rod.rod, rod.verdict);
  return verdicts;
}

std::string tune_table(const TuneTask& task, const TuneResult& result, const Scene& scene) {
  const Units& units = scene.units;
  std::string text = outcome_line(task, result, scene);
  text += fmt::format("{} {}", task.goal.maximise ? "maximise" : "minimise", task.goal.text);
  text += result.span_after.from == result.span_after.to ? " at " : " over ";
  text += span_text(task, result.span_after, units);
  if (speeds_vary(task)) text += fmt::format(" (found; before: {})", span_text(task, result.span_before, units));
  text += "\n";
  const std::string problem = shortfall(result);
  const char* found = task.keeps.empty() ? "a design was found\n" : "a design was found that meets every condition\n";
  text += problem.empty() ? found : "NOT REACHED: " + problem + "\n";
  text += variables_text(task, result);
  if (const std::string changes = changes_text(task); !changes.empty())
    text += "before: the scene with " + changes + "\n";
  text += worst_cases_text(task, result, scene) + places_text(task, result, scene) + conditions_text(result, scene) +
          changes_of_goal_text(task, result);
  for (const std::string& path : result.without_effect)
    text += fmt::format("the goal and conditions do not depend on {} here\n", path);
  text += search_text(result, scene);
  for (const std::string& warning : result.warnings) text += fmt::format("WARNING: {}\n", warning);
  return text;
}

Json tune_json(const TuneTask& task, const TuneResult& result, const Scene& scene, bool stats) {
  const Units& units = scene.units;
  Json json = {{"title", scene.title}, {task.goal.maximise ? "maximise" : "minimise", task.goal.text}};
  json["over"] = span_json(task, result.span_after, units);
  if (speeds_vary(task)) json["over_before"] = span_json(task, result.span_before, units);
  json["status"] = status_word(result.design.status);
  json["verified"] = result.verified();
  json["modes"] = result.num_modes;
  if (const std::optional<Verdict> verdict = worst_of(tune_verdicts(result.margins_after)))
    json["verdict"] = to_string(*verdict);
  if (const std::optional<Verdict> verdict = worst_of(tune_verdicts(result.margins_before)))
    json["verdict_before"] = to_string(*verdict);
  const std::string problem = shortfall(result);
  json["shortfall"] = problem.empty() ? Json() : Json(problem);
  if (!problem.empty()) json["notes"] = Json::array({problem});
  json["goal"] = {{"before", number(result.goal_before)},
                  {"after", number(result.goal_after)},
                  {"error", number(result.goal_error)},
                  {"unit", result.goal_unit}};
  json["variables"] = variables_json(task, result);
  Json& changes = json["before_differs"] = Json::array();  // from the scene
  for (const StartChange& change : start_changes(task))
    changes.push_back({{"path", change.path}, {"value", change.value}, {"scene", change.scene}, {"tied", change.tied}});
  Json& metrics = json["metrics"] = Json::array();
  for (const TuneRow& row : result.rows) {
    metrics.push_back({{"metric", row.metric.text},
                       {"unit", unit_of(row.metric.kind, scene)},
                       {"before", metric_json(task, row.before, row.before_confirmed, units)},
                       {"after", metric_json(task, row.after, row.after_confirmed, units)}});
  }
  json["conditions"] = conditions_json(result);
  if (result.sensitivity) json["slope_left_over"] = number(result.slope_left_over);
  if (!result.warnings.empty()) json["warnings"] = result.warnings;
  json["without_effect"] = result.without_effect;
  json["worst_at_once"] = result.worst_at_once;
  if (result.damping_sensitivity) json["damping_sensitivity"] = *result.damping_sensitivity;
  if (result.damping_sensitivity_of_best) json["damping_sensitivity_of_best"] = *result.damping_sensitivity_of_best;
  json["analyses"] = result.design.trials.size() + static_cast<std::size_t>(result.confirmations);
  json["confirmations"] = result.confirmations;
  json["analyses_for_slopes"] = result.design.num_for_slopes;
  json["analyses_after"] = result.analyses_after;
  json["gradients"] = result.counts.gradients;
  json["not_closing"] = result.counts.not_closing;
  json["refused"] = result.counts.refused;
  json["without_response"] = result.without_response;
  json["evidence"] = result.design.evidence;
  json["units"] = units_json(units);
  if (stats) add_stats(json, result.stages, task.settings);
  return json;
}

std::string tuned_scene(const SceneSource& source, const TuneTask& task, const TuneResult& result, const Units& units,
                        const std::filesystem::path& scene_file, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::vector<Override> overrides;
  for (const Number& number : numbers_at(task, result.tuned))
    overrides.push_back(number_override(number.path, number.value));
  // A range given as omega has no place in a scene: there it is said above alone.
  if (speeds_vary(task) && task.in_rpm) {
    const std::vector<std::string> paths = source.numeric_paths();
    const auto has = [&](const char* path) { return std::ranges::find(paths, path) != paths.end(); };
    const double from = rpm_of(result.span_after.from, units), to = rpm_of(result.span_after.to, units);
    constexpr int usual_steps = 50;
    const double step = has("analysis.rpm.2") ? source.value("analysis.rpm.2") : (to - from) / usual_steps;
    if (!has("analysis.omega"))
      overrides.push_back(
          {"analysis.rpm", from < to ? fmt::format("[{}, {}, {}]", from, to, step) : fmt::format("{}", from)});
  }
  const std::string text = source.text_with(overrides);
  const fs::path from = fs::absolute(scene_file).parent_path(), to = fs::absolute(folder);
  std::string changed;
  if (const std::string problem = shortfall(result); !problem.empty()) changed = "# NOT REACHED: " + problem + "\n";
  if (speeds_vary(task)) changed += "# Speeds found: " + span_text(task, result.span_after, units) + "\n";
  return changed + in_folder(text, from, to);
}

}  // namespace hb::tools
