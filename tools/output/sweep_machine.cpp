#include "tools/output/sweep_machine.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/output/json.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

using StressValue = std::function<double(const StressPoint&)>;
using MachineValue = std::function<double(const MachinePoint&)>;

const StressPoint* stress_at(const SweepPoint& point, std::size_t r) {
  return r < point.rods.size() && point.rods[r].stress ? &*point.rods[r].stress : nullptr;
}

double or_none(const std::optional<double>& value) { return value.value_or(no_number); }

enum class StressKind { stress, factor, length, angle };

struct StressQuantity {
  const char* key;
  const char* column;  // of the CSV; empty: the document alone
  StressValue value;
  StressKind kind;
};

const std::vector<StressQuantity>& stress_quantities() {
  using enum StressKind;
  static const std::vector<StressQuantity> list = {
      {"axial", "axial stress [MPa]", [](const StressPoint& p) { return p.axial; }, stress},
      {"axial_error", "axial stress error [MPa]", [](const StressPoint& p) { return p.axial_error; }, stress},
      {"bending", "bending stress [MPa]", [](const StressPoint& p) { return p.bending; }, stress},
      {"bending_error", "bending stress error [MPa]", [](const StressPoint& p) { return p.bending_error; }, stress},
      {"max_abs", "stress [MPa]", [](const StressPoint& p) { return p.max_abs; }, stress},
      {"x", "", [](const StressPoint& p) { return p.x; }, length},
      {"crank_angle", "", [](const StressPoint& p) { return p.crank_angle; }, angle},
      {"mean", "mean stress [MPa]", [](const StressPoint& p) { return p.mean; }, stress},
      {"amplitude", "stress amplitude [MPa]", [](const StressPoint& p) { return p.amplitude; }, stress},
      {"error", "stress error [MPa]", [](const StressPoint& p) { return p.error; }, stress},
      {"yield_safety", "yield safety", [](const StressPoint& p) { return or_none(p.yield_safety); }, factor},
      {"yield_safety_error", "yield safety error",
       [](const StressPoint& p) { return p.yield_safety ? p.yield_safety_error : no_number; }, factor},
      {"fatigue_safety", "fatigue safety", [](const StressPoint& p) { return or_none(p.fatigue_safety); }, factor},
      {"fatigue_safety_error", "fatigue safety error",
       [](const StressPoint& p) { return p.fatigue_safety ? p.fatigue_safety_error : no_number; }, factor}};
  return list;
}

// The quantities that some point of the rod has.
std::vector<const StressQuantity*> quantities_of(const std::vector<SweepPoint>& points, std::size_t r) {
  std::vector<const StressQuantity*> found;
  for (const StressQuantity& quantity : stress_quantities())
    if (std::ranges::any_of(points, [&](const SweepPoint& point) {
          const StressPoint* stress = stress_at(point, r);
          return stress && !std::isnan(quantity.value(*stress));
        }))
      found.push_back(&quantity);
  return found;
}

Json of_machine(const std::vector<const MachinePoint*>& points, const MachineValue& value) {
  Json array = Json::array();
  for (const MachinePoint* point : points) array.push_back(point ? number(value(*point)) : Json(nullptr));
  return array;
}

// In the order of MachinePoint::bearings.
std::vector<std::string> bearing_names(const SweepResult& result) {
  std::vector<std::string> names;
  for (const std::string& component : result.joint_components) {
    std::string name = component.substr(0, component.rfind(' '));
    if (names.empty() || names.back() != name) names.push_back(std::move(name));
  }
  return names;
}

struct Worst {
  const SweepPoint* at = nullptr;
  double value = 0;
};

// The largest, or smallest, of the points; numbers that there are not are passed over.
Worst worst_of(const SweepResult& result, bool smallest, const std::function<double(const SweepPoint&)>& value) {
  Worst worst;
  for (const SweepPoint* point : all_points(result)) {
    const double here = value(*point);
    if (std::isnan(here)) continue;
    if (!worst.at || (smallest ? here < worst.value : here > worst.value)) worst = {point, here};
  }
  return worst;
}

// Where the periodic motion is stable and the linear theory holds: elsewhere, above all beside a resonance without
// bound, no machine has these loads.
bool trusted(const SweepScene& scene, const SweepResult& result, const SweepPoint& point) {
  const bool theory = has_theory(scene, result);
  return std::ranges::none_of(point.rods, [&](const RodPoint& rod) {
    return (rod.stability && rod.stability->stability.verdict == Verdict::unstable) || beyond_limits(rod) ||
           (theory && beyond_theory(rod.theory_error));
  });
}

// "of all points", or of those that are trusted.
std::string whose_largest(const SweepScene& scene, const SweepResult& result) {
  const std::vector<const SweepPoint*> points = all_points(result);
  const auto holds = [&](const SweepPoint* point) { return trusted(scene, result, *point); };
  return std::ranges::all_of(points, holds) ? "of all points" : "where stable and within the linear theory";
}

std::string place_text(const SweepScene& scene, const Worst& worst) {
  const std::string unit = axis_unit(scene);
  return fmt::format("at {}{:.6g}{}", is_speed(scene) ? "" : scene.axis().path + " = ", worst.at->x,
                     unit.empty() ? "" : " " + unit);
}

struct MachineColumn {
  std::string name;
  MachineValue value;
};

std::vector<MachineColumn> machine_columns(const SweepScene& scene, const std::vector<std::string>& names) {
  const OutputUnits units = output_units(scene.scene());
  const double watt = units.moment / scene.scene().units.time_in_s;
  std::vector<MachineColumn> columns;
  for (std::size_t j = 0; j < names.size(); ++j)
    columns.push_back(
        {names[j] + " resultant [N]", [j, units](const MachinePoint& m) { return units.force * m.bearings[j]; }});
  const auto add = [&](const char* name, double factor, const MachineValue& value) {
    columns.push_back({name, [factor, value](const MachinePoint& m) { return factor * value(m); }});
  };
  add("shaking force [N]", units.force, [](const MachinePoint& m) { return m.shaking_force; });
  add("shaking moment smallest [N m]", units.moment, [](const MachinePoint& m) { return m.shaking_moment.min; });
  add("shaking moment largest [N m]", units.moment, [](const MachinePoint& m) { return m.shaking_moment.max; });
  add("torque mean [N m]", units.moment, [](const MachinePoint& m) { return m.drive.mean; });
  add("torque rms [N m]", units.moment, [](const MachinePoint& m) { return m.drive.rms; });
  add("power mean [W]", watt, [](const MachinePoint& m) { return m.drive.mean_power; });
  add("power rms [W]", watt, [](const MachinePoint& m) { return m.drive.rms_power; });
  add("power smallest [W]", watt, [](const MachinePoint& m) { return m.drive.smallest_power; });
  add("power largest [W]", watt, [](const MachinePoint& m) { return m.drive.largest_power; });
  add("energy fluctuation [J]", units.moment, [](const MachinePoint& m) { return m.drive.energy_fluctuation; });
  add("speed fluctuation", 1, [](const MachinePoint& m) { return or_none(m.speed_fluctuation); });
  add("error of resultants [N]", units.force, [](const MachinePoint& m) { return m.bearing_error; });
  add("error of the shaking force [N]", units.force, [](const MachinePoint& m) { return m.shaking_force_error; });
  add("error of the shaking moment [N m]", units.moment, [](const MachinePoint& m) { return m.shaking_moment_error; });
  add("error of torques [N m]", units.moment, [](const MachinePoint& m) { return m.torque_error; });
  add("error of powers [W]", watt, [](const MachinePoint& m) { return m.power_error; });
  add("error of the energy fluctuation [J]", units.moment, [](const MachinePoint& m) { return m.energy_error; });
  add("error of the speed fluctuation", 1, [](const MachinePoint& m) { return or_none(m.speed_fluctuation_error); });
  return columns;
}

}  // namespace

void add_stress(Json& rod, std::size_t r, const std::vector<SweepPoint>& points, const Units& units) {
  for (const StressQuantity* quantity : quantities_of(points, r)) {
    Json& array = rod["stress"][quantity->key] = Json::array();
    for (const SweepPoint& point : points) {
      const StressPoint* stress = stress_at(point, r);
      const double factor = quantity->kind == StressKind::angle ? scene_angle(1, units) : 1;
      array.push_back(stress ? number(factor * quantity->value(*stress)) : Json(nullptr));
    }
  }
}

void add_machine(Json& document, const SweepResult& result) {
  std::vector<const MachinePoint*> points;
  for (const SweepPoint& point : result.points) points.push_back(point.machine ? &*point.machine : nullptr);
  add_machine(document, bearing_names(result), points);
}

void add_machine(Json& document, const std::vector<std::string>& names,
                 const std::vector<const MachinePoint*>& points) {
  Json& bearings = document["bearings"] = Json::object();
  const auto of = [&](const MachineValue& value) { return of_machine(points, value); };
  for (std::size_t j = 0; j < names.size(); ++j)
    bearings[names[j]] = {{"max", of([j](const MachinePoint& m) { return m.bearings[j]; })},
                          {"error", of([](const MachinePoint& m) { return m.bearing_error; })}};
  document["frame"] = {{"max", of([](const MachinePoint& m) { return m.shaking_force; })},
                       {"force_error", of([](const MachinePoint& m) { return m.shaking_force_error; })},
                       {"moment_error", of([](const MachinePoint& m) { return m.shaking_moment_error; })},
                       {"moment",
                        {{"min", of([](const MachinePoint& m) { return m.shaking_moment.min; })},
                         {"max", of([](const MachinePoint& m) { return m.shaking_moment.max; })}}}};
  document["torque"]["mean"] = of([](const MachinePoint& m) { return m.drive.mean; });
  document["torque"]["rms"] = of([](const MachinePoint& m) { return m.drive.rms; });
  document["torque"]["error"] = of([](const MachinePoint& m) { return m.torque_error; });
  document["power"] = {{"min", of([](const MachinePoint& m) { return m.drive.smallest_power; })},
                       {"max", of([](const MachinePoint& m) { return m.drive.largest_power; })},
                       {"mean", of([](const MachinePoint& m) { return m.drive.mean_power; })},
                       {"rms", of([](const MachinePoint& m) { return m.drive.rms_power; })},
                       {"error", of([](const MachinePoint& m) { return m.power_error; })}};
  document["flywheel"] = {
      {"energy_fluctuation", of([](const MachinePoint& m) { return m.drive.energy_fluctuation; })},
      {"energy_fluctuation_error", of([](const MachinePoint& m) { return m.energy_error; })},
      {"speed_fluctuation", of([](const MachinePoint& m) { return or_none(m.speed_fluctuation); })},
      {"speed_fluctuation_error", of([](const MachinePoint& m) { return or_none(m.speed_fluctuation_error); })}};
}

std::string stress_rows(const SweepScene& scene, const SweepResult& result, std::size_t rod) {
  const OutputUnits units = output_units(scene.scene());
  const auto worst = [&](bool smallest, const StressValue& value) {
    return worst_of(result, smallest, [&](const SweepPoint& point) {
      const StressPoint* stress = stress_at(point, rod);
      return stress && (smallest || trusted(scene, result, point)) ? value(*stress) : no_number;
    });
  };
  std::string text;
  if (const Worst most = worst(false, [](const StressPoint& p) { return p.max_abs; }); most.at) {
    const StressPoint& there = *stress_at(*most.at, rod);
    text += fmt::format("  largest stress {} {:.4g} MPa {}, x = {:.4g} {}, crank angle {:.2f} deg\n",
                        whose_largest(scene, result), most.value * units.megapascal, place_text(scene, most), there.x,
                        units.length, there.crank_angle * degrees_per_radian);
  }
  const auto safety = [&](const char* what, const StressValue& value) {
    const Worst least = worst(true, value);
    if (least.at && std::isfinite(least.value))
      text += fmt::format("  smallest safety against {} {:.4g} {}{}\n", what, least.value, place_text(scene, least),
                          least.value < 1 ? ": NOT ENOUGH" : "");
  };
  safety("yielding", [](const StressPoint& p) { return or_none(p.yield_safety); });
  safety("fatigue", [](const StressPoint& p) { return or_none(p.fatigue_safety); });
  return text;
}

std::string machine_rows(const SweepScene& scene, const SweepResult& result) {
  const OutputUnits units = output_units(scene.scene());
  const double watt = units.moment / scene.scene().units.time_in_s;
  std::string text;
  const auto row = [&](const std::string& what, double factor, const char* unit, const MachineValue& value) {
    const Worst most = worst_of(result, false, [&](const SweepPoint& point) {
      return point.machine && trusted(scene, result, point) ? value(*point.machine) : no_number;
    });
    if (most.at)
      text += fmt::format("  {:<24}  {:>12.6g} {:<4} {}\n", what, factor * most.value, unit, place_text(scene, most));
  };
  const std::vector<std::string> names = bearing_names(result);
  for (std::size_t j = 0; j < names.size(); ++j)
    row("resultant at " + names[j], units.force, "N", [j](const MachinePoint& m) { return m.bearings[j]; });
  row("shaking force", units.force, "N", [](const MachinePoint& m) { return m.shaking_force; });
  row("shaking moment", units.moment, "N m",
      [](const MachinePoint& m) { return std::max(m.shaking_moment.max, -m.shaking_moment.min); });
  row("rms torque", units.moment, "N m", [](const MachinePoint& m) { return m.drive.rms; });
  row("power", watt, "W", [](const MachinePoint& m) { return m.drive.largest_power; });
  row("energy of the flywheel", units.moment, "J", [](const MachinePoint& m) { return m.drive.energy_fluctuation; });
  return text.empty() ? text : "\nLargest " + whose_largest(scene, result) + "\n" + text;
}

std::vector<std::string> stress_columns(const SweepResult& result, std::size_t rod) {
  std::vector<std::string> columns;
  for (const StressQuantity* quantity : quantities_of(result.points, rod))
    if (*quantity->column != '\0') columns.emplace_back(quantity->column);
  return columns;
}

void fill_stress(const RodPoint& point, double megapascal, const std::vector<std::string>& columns,
                 Eigen::Ref<Eigen::RowVectorXd> values) {
  if (!point.stress) return;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto quantity = std::ranges::find(stress_quantities(), columns[c], &StressQuantity::column);
    values(static_cast<Eigen::Index>(c)) =
        (quantity->kind == StressKind::stress ? megapascal : 1) * quantity->value(*point.stress);
  }
}

CsvFile sweep_machine_csv(const SweepScene& scene, const SweepResult& result) {
  const std::vector<MachineColumn> columns = machine_columns(scene, bearing_names(result));
  const std::vector<const SweepPoint*> points = all_points(result);
  CsvFile file;
  file.name = "sweep_machine.csv";
  file.comment = {fmt::format("{}: bearings, frame and drive along {}", scene_name(scene.scene()), scene.axis().path),
                  "resultants and shaking force: largest over the turn; moment about the crank's pivot; energy that a "
                  "flywheel takes up and gives back in a turn, and what it makes of the speed"};
  file.columns = {axis_label(scene)};
  for (const MachineColumn& column : columns) file.columns.push_back(column.name);
  file.rows.setConstant(static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(file.columns.size()),
                        no_number);
  for (std::size_t k = 0; k < points.size(); ++k) {
    auto row = file.rows.row(static_cast<Eigen::Index>(k));
    row(0) = points[k]->x;
    if (!points[k]->machine) continue;
    for (std::size_t c = 0; c < columns.size(); ++c)
      row(static_cast<Eigen::Index>(c) + 1) = columns[c].value(*points[k]->machine);
  }
  return file;
}

CsvFile branches_machine_csv(const SweepScene& scene, const NonlinearSweep& sweep) {
  const std::vector<MachineColumn> columns = machine_columns(scene, sweep.joints);
  CsvFile file;
  file.name = "branches_machine.csv";
  file.comment = {fmt::format("{}: bearings, frame and drive of the motions without linearisation along {}",
                              scene_name(scene.scene()), scene.axis().path),
                  std::string("at the values asked for, branch by branch; ") + verdict_numbers};
  file.columns = {axis_label(scene), "branch", "verdict"};
  for (const MachineColumn& column : columns) file.columns.push_back(column.name);
  std::vector<std::vector<double>> rows;
  for (std::size_t b = 0; b < sweep.branches.size(); ++b)
    for (const NonlinearPoint& point : sweep.branches[b].points) {
      if (!point.machine) continue;
      const double verdict = point.stability ? verdict_number(point.stability->verdict) : no_number;
      rows.push_back({point.x, static_cast<double>(b + 1), verdict});
      for (const MachineColumn& column : columns) rows.back().push_back(column.value(*point.machine));
    }
  file.rows.resize(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(file.columns.size()));
  for (std::size_t k = 0; k < rows.size(); ++k)
    file.rows.row(static_cast<Eigen::Index>(k)) =
        Eigen::Map<const Eigen::RowVectorXd>(rows[k].data(), static_cast<Eigen::Index>(rows[k].size()));
  return file;
}

}  // namespace hb::tools
