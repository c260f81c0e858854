#include "tools/tune_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/json_output.hpp"
#include "tools/output_units.hpp"
#include "tools/wording.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;

double shown_speed(const TuneTask& task, double speed, const Units& units) {
  return task.in_rpm ? rpm_from_speed(speed, units) : speed;
}

std::string speed_unit(const TuneTask& task, const Units& units) {
  return task.in_rpm ? "rpm" : fmt::format("rad/{}", units.time);
}

std::string label(MetricKind kind) {
  switch (kind) {
    case MetricKind::deflection:
      return "largest deflection";
    case MetricKind::stress:
      return "largest bending stress";
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
    case MetricKind::clearance:
      return "clearance";
  }
  return "";
}

std::string label(const Metric& metric) {
  return label(metric.kind) + (metric.name.empty() ? "" : " " + metric.name) +
         (metric.kind == MetricKind::clearance ? fmt::format(" of orders 1..{}", metric.orders) : "");
}

std::string place(const TuneTask& task, const MetricValue& value, const Units& units) {
  std::string text = value.where;
  if (value.speed)
    text += fmt::format("{}{:.6g} {}", text.empty() ? "" : ", ", shown_speed(task, *value.speed, units),
                        speed_unit(task, units));
  return text;
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

std::string bound_text(const Keep& keep, const Units& units) {
  const std::string unit = unit_of(keep.metric.kind, units);
  return fmt::format("{} {:g}{}{}", keep.at_least ? ">=" : "<=", keep.bound, unit.empty() ? "" : " ", unit);
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json metric_json(const TuneTask& task, const MetricValue& value, const Units& units) {
  Json json = {{"value", number(value.value)}};
  if (!value.where.empty()) json["at"] = value.where;
  if (value.speed) json[task.in_rpm ? "rpm" : "omega"] = shown_speed(task, *value.speed, units);
  return json;
}

}  // namespace

std::string shortfall(const TuneResult& result) {
  if (result.design.status == DesignStatus::infeasible) {
    std::string names;
    for (const TuneCondition& condition : result.conditions)
      if (!condition.met) names += (names.empty() ? "" : ", ") + condition.keep.text;
    return fmt::format("no design within the bounds meets all conditions; at the nearest one not met: {}", names);
  }
  if (!result.verified) return "the worst cases found on more speeds differ from those of the search";
  if (result.design.status == DesignStatus::stopped)
    return "the analyses allowed ran out before the search had settled";
  return "";
}

std::string tune_table(const TuneTask& task, const TuneResult& result, const Scene& scene) {
  const Units& units = scene.units;
  std::string text = fmt::format("{}\nminimise {}", scene_name(scene), task.goal.text);
  if (task.span.from == task.span.to) {
    text += fmt::format(" at {:g} {}\n", shown_speed(task, task.span.from, units), speed_unit(task, units));
  } else {
    text += fmt::format(" over {:g} to {:g} {}\n", shown_speed(task, task.span.from, units),
                        shown_speed(task, task.span.to, units), speed_unit(task, units));
  }
  const std::string problem = shortfall(result);
  text += problem.empty() ? "a design was found that meets every condition\n" : "NOT REACHED: " + problem + "\n";

  text += fmt::format("\n{:<28}{:>15}{:>15}  {}\n", "variable", "before", "after", "bounds");
  for (std::size_t i = 0; i < task.variables.size(); ++i) {
    const TuneVariable& variable = task.variables[i];
    const std::string bound = at_bound(variable, result.tuned[i]);
    text += fmt::format("{:<28}{:>15.8g}{:>15.8g}  {:g} to {:g}{}\n", variable.path, result.start[i], result.tuned[i],
                        variable.lower, variable.upper, bound.empty() ? "" : ", " + bound);
    for (const TiedNumber& tied : variable.tied)
      text += fmt::format("{:<28}{:>15.8g}{:>15.8g}  tied to {}\n", tied.path, tied.factor * result.start[i],
                          tied.factor * result.tuned[i], variable.path);
  }

  text += fmt::format("\n{:<36}{:>13}{:>13}  {:<8}  {}\n", "worst case", "before", "after", "unit", "after: where");
  for (const TuneRow& row : result.rows) {
    text += fmt::format("{:<36}{:>13.7g}{:>13.7g}  {:<8}  {}\n", label(row.metric), row.before.value, row.after.value,
                        unit_of(row.metric.kind, units), place(task, row.after, units));
    if (row.metric.kind == MetricKind::margin && !(row.after.value > 0))
      text += "  the tuned design is not stable over all these speeds: its response there would not be seen\n";
  }
  text +=
      fmt::format("{:<36}{:>13.7g}{:>13.7g}  {}\n", "goal", result.goal_before, result.goal_after, result.goal_unit);

  if (!result.conditions.empty()) text += "\ncondition                            bound               \n";
  for (const TuneCondition& condition : result.conditions) {
    text += fmt::format("{:<36} {:<20}{}", label(condition.keep.metric), bound_text(condition.keep, units),
                        !condition.met     ? fmt::format("NOT MET: {:.7g}", condition.value)
                        : condition.active ? "active"
                                           : "met with room");
    if (condition.met && condition.active && condition.multiplier > 0)
      text += fmt::format(": relaxed by 1 % of its unit, the goal gains {:.3g}{}{} ({:.3g} %)", gain(condition),
                          result.goal_unit.empty() ? "" : " ", result.goal_unit,
                          100 * gain(condition) / std::abs(result.goal_after));
    text += "\n";
  }

  if (result.sensitivity && result.goal_after != 0) {
    text += "\n1 % more of      changes the goal by\n";
    for (std::size_t i = 0; i < task.variables.size(); ++i) {
      const double change = result.sensitivity->goal_gradient(static_cast<Eigen::Index>(i)) * result.tuned[i];
      text += fmt::format("{:<28}{:>+10.3g} %\n", task.variables[i].path, change / result.goal_after);
    }
    if (result.damping_sensitivity)
      text += fmt::format("{:<28}{:>+10.3g} %\n", "internal damping, all links", *result.damping_sensitivity);
  }

  text += fmt::format("\n{} designs analysed: {}\n", result.design.trials.size(), result.design.evidence);
  if (result.not_closing > 0) text += fmt::format("{} designs tried do not close over the turn\n", result.not_closing);
  if (result.refused > 0) text += fmt::format("{} designs tried are no possible scene\n", result.refused);
  if (result.without_response > 0)
    text += fmt::format("{} designs tried have no periodic solution at some speed\n", result.without_response);
  if (result.verified) text += "worst cases confirmed on four times the speeds\n";
  return text;
}

Json tune_json(const TuneTask& task, const TuneResult& result, const Scene& scene) {
  const Units& units = scene.units;
  Json json = {{"title", scene_name(scene)}, {"minimise", task.goal.text}};
  json["over"] = {{task.in_rpm ? "rpm" : "omega",
                   {shown_speed(task, task.span.from, units), shown_speed(task, task.span.to, units)}}};
  json["status"] = status_word(result.design.status);
  json["verified"] = result.verified;
  const std::string problem = shortfall(result);
  json["shortfall"] = problem.empty() ? Json() : Json(problem);
  json["goal"] = {
      {"before", number(result.goal_before)}, {"after", number(result.goal_after)}, {"unit", result.goal_unit}};
  Json& variables = json["variables"] = Json::array();
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
      entry["goal_gradient"] = result.sensitivity->goal_gradient(k);
      entry["multiplier_lower"] = result.sensitivity->below(k);
      entry["multiplier_upper"] = result.sensitivity->above(k);
    }
    Json tied = Json::object();
    for (const TiedNumber& number : variable.tied) tied[number.path] = number.factor * result.tuned[i];
    if (!tied.empty()) entry["tied"] = std::move(tied);
    variables.push_back(std::move(entry));
  }
  Json& metrics = json["metrics"] = Json::array();
  for (const TuneRow& row : result.rows) {
    metrics.push_back({{"metric", row.metric.text},
                       {"unit", unit_of(row.metric.kind, units)},
                       {"before", metric_json(task, row.before, units)},
                       {"after", metric_json(task, row.after, units)}});
  }
  Json& conditions = json["conditions"] = Json::array();
  for (const TuneCondition& condition : result.conditions) {
    conditions.push_back({{"condition", condition.keep.text},
                          {"value", number(condition.value)},
                          {"bound", condition.keep.bound},
                          {"met", condition.met},
                          {"active", condition.active},
                          {"multiplier", condition.multiplier},
                          {"gain_of_1_percent", gain(condition)}});
  }
  if (result.damping_sensitivity) json["damping_sensitivity"] = *result.damping_sensitivity;
  json["analyses"] = result.design.trials.size();
  json["not_closing"] = result.not_closing;
  json["refused"] = result.refused;
  json["without_response"] = result.without_response;
  json["evidence"] = result.design.evidence;
  json["units"] = units_json(units);
  return json;
}

CsvFile history_csv(const TuneTask& task, const TuneResult& result) {
  CsvFile file;
  file.name = "history.csv";
  file.comment = {"Designs in the order tried; goal nan: no such design. excess > 0: beyond the bound."};
  for (const TuneVariable& variable : task.variables) file.columns.push_back(variable.path);
  file.columns.push_back("goal");
  for (const Keep& keep : task.keeps) file.columns.push_back("excess of " + keep.text);
  const auto n = static_cast<Eigen::Index>(task.variables.size()), m = static_cast<Eigen::Index>(task.keeps.size());
  file.rows =
      Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(result.design.trials.size()), n + 1 + m, std::nan(""));
  for (std::size_t k = 0; k < result.design.trials.size(); ++k) {
    const DesignTrial& trial = result.design.trials[k];
    auto row = file.rows.row(static_cast<Eigen::Index>(k));
    row.head(n) = trial.x.transpose();
    if (!trial.values) continue;
    row(n) = trial.values->goal;
    row.tail(m) = trial.values->conditions.transpose();
  }
  return file;
}

CsvFile curves_csv(const TuneTask& task, const DesignCurves& curves, const Scene& scene, bool after) {
  const OutputUnits units = output_units(scene);
  CsvFile file;
  file.name = after ? "curves_after.csv" : "curves_before.csv";
  file.comment = {fmt::format("{}, {} tuning: largest deflection over rod and turn, largest growth rate",
                              scene_name(scene), after ? "after" : "before")};
  file.columns.push_back("speed [" + speed_unit(task, scene.units) + "]");
  for (const std::string& rod : curves.rods) file.columns.push_back("deflection " + rod + bracketed(units.response));
  file.columns.push_back("growth rate [" + units.rate + "]");
  const auto rods = static_cast<Eigen::Index>(curves.rods.size());
  file.rows.resize(static_cast<Eigen::Index>(curves.speed.size()), rods + 2);
  for (std::size_t k = 0; k < curves.speed.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    file.rows(i, 0) = shown_speed(task, curves.speed[k], scene.units);
    file.rows.row(i).segment(1, rods) = curves.deflection.row(i);
    file.rows(i, rods + 1) = curves.growth(i);
  }
  return file;
}

std::vector<Figure> curves_figures(const TuneTask& task, const TuneResult& result, const Scene& scene) {
  if (!result.curves_before || !result.curves_after || task.span.from == task.span.to) return {};
  const OutputUnits units = output_units(scene);
  const std::vector<std::string>& rods = result.curves_after->rods;
  Figure figure;
  figure.name = "before_after";
  figure.height = 720;
  const double from = shown_speed(task, task.span.from, scene.units), to = shown_speed(task, task.span.to, scene.units);
  figure.commands = fmt::format(
      "set multiplot layout 2,1 title {} margins char 14, char 22, char 4, char 3 spacing char 0, char 2\n"
      "set xrange [{}:{}]\nset key outside right top\nset grid\nset logscale y\nunset xlabel\nset format y '%g'\nset "
      "format x ''\n"
      "set ylabel 'largest deflection{}'\n",
      quoted(scene_name(scene) + ": before (dashed) and after tuning"), from, to, bracketed(units.response));
  std::string above, below;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    for (const bool after : {false, true}) {
      above += fmt::format("{}'{}' using 1:{} with lines lw 2 lc {} {} title {}", above.empty() ? "plot " : ", \\\n  ",
                           after ? "curves_after.csv" : "curves_before.csv", r + 2, r + 1, after ? "dt 1" : "dt 2",
                           quoted(rods[r] + (after ? " after" : " before")));
    }
  }
  for (const bool after : {false, true}) {
    below += fmt::format("{}'{}' using 1:{} with lines lw 2 lc {} {} title '{}'", after ? ", \\\n  " : "plot ",
                         after ? "curves_after.csv" : "curves_before.csv", rods.size() + 2, after ? 4 : 7,
                         after ? "dt 1" : "dt 2", after ? "after" : "before");
  }
  figure.commands += above + "\n";
  figure.commands += fmt::format(
      "unset logscale y\nset format x '%g'\nset xlabel 'crank speed [{}]'\n"
      "set ylabel 'growth rate [{}]'\n{}\nunset multiplot\n",
      speed_unit(task, scene.units), units.rate, below);
  return {figure};
}

std::string tuned_scene(const TuneTask& task, const TuneResult& result, const std::filesystem::path& scene_file,
                        const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const std::string text = task.source.text_with(overrides_at(task, result.tuned));
  const fs::path from = fs::absolute(scene_file).parent_path(), to = fs::absolute(folder);
  // Values of keys called `file`: file = "..." or '...'. Anything else (comments, longer names, "" or '\'\'') stays.
  std::string changed;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t key = std::min(text.find("file", at), text.size());
    changed.append(text, at, key - at);
    const auto in_name = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    };
    std::size_t value = std::min(key + 4, text.size());
    const bool whole = key == 0 || !in_name(text[key - 1]);
    while (value < text.size() && (text[value] == ' ' || text[value] == '\t')) ++value;
    const bool assigned = value < text.size() && text[value] == '=';
    value += assigned ? 1 : 0;
    while (value < text.size() && (text[value] == ' ' || text[value] == '\t')) ++value;
    const char quote = value < text.size() ? text[value] : '\0';
    const std::size_t end = text.find_first_of(std::string{quote, '\n'}, value + 1);
    if (whole && assigned && (quote == '"' || quote == '\'') && end != std::string::npos && text[end] == quote) {
      const fs::path file = text.substr(value + 1, end - value - 1);
      const bool stays = file.is_absolute() || file.empty();
      changed.append(text, key, value - key);
      changed += stays ? text.substr(value, end + 1 - value)
                       : fmt::format("\"{}\"", (from / file).lexically_relative(to).string());
      at = end + 1;
    } else {
      const std::size_t next = std::min(key + 4, text.size());
      changed.append(text, key, next - key);
      at = next;
    }
  }
  return changed;
}

}  // namespace hb::tools
