#include "tools/output/sweep_theory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "lib/scene/scene_keys.hpp"
#include "tools/output/json.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

// Of the mechanism; NaN where there is none.
double mechanism_growth(const SweepPoint& point) {
  double rate = std::numeric_limits<double>::quiet_NaN();
  for (const RodPoint& rod : point.rods)
    if (rod.stability) rate = std::fmax(rate, rod.stability->stability.growth_rate);
  return rate;
}

double mean_torque(const SweepPoint& point) {
  return point.machine ? point.machine->drive.mean : std::numeric_limits<double>::quiet_NaN();
}

struct TheoryQuantity {
  const char* key;  // path in the document
  const char* words;
  std::optional<double> SweepPoint::*value;
  // Of those that are told as they are; the others are relative to the largest.
  const char* itself = nullptr;
  double (*value_itself)(const SweepPoint&) = nullptr;
  std::string unit;
  double factor = 1;  // from the scene's units to `unit`
};

// Those that were asked for.
std::vector<TheoryQuantity> theory_quantities(const SweepScene& scene, const SweepResult& result) {
  std::vector<TheoryQuantity> list;
  if (!has_theory(scene, result)) return list;
  const OutputUnits units = output_units(scene.scene());
  if (result.computed.reactions) {
    list.push_back({"/joints_theory_error", "joint forces", &SweepPoint::force_theory_error});
    list.push_back({"/torque_theory_error", "torque", &SweepPoint::torque_theory_error});
    list.push_back({"/torque/mean_theory_error", "mean torque", &SweepPoint::mean_torque_theory_error, "mean",
                    mean_torque, "N m", units.moment});
  }
  if (result.computed.stability)
    list.push_back({"/growth_theory_error", "growth rate", &SweepPoint::growth_theory_error, "rate", mechanism_growth,
                    units.rate});
  return list;
}

}  // namespace

void add_theory(Json& document, const SweepScene& scene, const SweepResult& result) {
  const std::vector<TheoryQuantity> quantities = theory_quantities(scene, result);
  for (const TheoryQuantity& quantity : quantities) {
    Json& array = document[Json::json_pointer(quantity.key)] = Json::array();
    for (const SweepPoint& point : result.points) array.push_back(number(point.*quantity.value));
  }
  if (quantities.empty() || !result.computed.reactions) return;
  Json& powers = document["power"]["mean_theory_error"] = Json::array();
  for (const SweepPoint& point : result.points) {
    const std::optional<double>& torque = point.mean_torque_theory_error;
    powers.push_back(torque ? number(point.speed * *torque) : Json(nullptr));
  }
}

std::string theory_rows(const SweepScene& scene, const SweepResult& result) {
  std::string text;
  for (const TheoryQuantity& quantity : theory_quantities(scene, result)) {
    const SweepPoint* worst = nullptr;
    std::size_t without = 0, above_itself = 0;
    for (const SweepPoint& point : result.points) {
      if (point.rods.empty()) continue;
      const std::optional<double>& value = point.*quantity.value;
      without += !value;
      if (!value) continue;
      above_itself += quantity.itself && *value >= std::abs(quantity.value_itself(point));
      if (!worst || *value > *(worst->*quantity.value)) worst = &point;
    }
    if (!worst) continue;
    const std::string unit = axis_unit(scene);
    text += fmt::format("  {:<14} {:.1e} {}  at {}{:.6g}{}{}{}\n", quantity.words,
                        quantity.factor * *(worst->*quantity.value), quantity.itself ? quantity.unit : "of the largest",
                        is_speed(scene) ? "" : scene.axis().path + " = ", worst->x, unit.empty() ? "" : " " + unit,
                        without == 0 ? "" : fmt::format("; no value at {} of {} points", without, result.points.size()),
                        above_itself == 0 ? ""
                                          : fmt::format("; not less than the {} itself at {}", quantity.itself,
                                                        counted(above_itself, "point")));
  }
  return text.empty() ? text : "\nTheory errors of the whole mechanism, largest of all points\n" + text;
}

CsvFile sweep_theory_csv(const SweepScene& scene, const SweepResult& result) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<TheoryQuantity> quantities = theory_quantities(scene, result);
  const std::vector<const SweepPoint*> points = all_points(result);
  CsvFile file;
  file.name = "sweep_theory.csv";
  file.comment = {
      fmt::format("{}: theory errors along {}", scene_name(scene.scene()), scene.axis().path),
      "what the first nonlinear correction changes, of the largest of each; of mean torque and growth rate as it is; "
      "no number: beyond the linear theory; of the growth rate also with shear"};
  file.columns = {axis_label(scene)};
  for (const SweepRod& rod : result.rods) {
    file.columns.push_back(rod.name + " q");
    if (result.computed.shape) file.columns.push_back(rod.name + " deflection");
  }
  for (const TheoryQuantity& quantity : quantities)
    file.columns.push_back(quantity.words + (quantity.itself ? bracketed(quantity.unit) : std::string()));
  file.rows.setConstant(static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(file.columns.size()), none);
  for (std::size_t k = 0; k < points.size(); ++k) {
    auto row = file.rows.row(static_cast<Eigen::Index>(k));
    row(0) = points[k]->x;
    Eigen::Index column = 1;
    for (const RodPoint& rod : points[k]->rods) {
      row(column++) = rod.theory_error.value_or(none);
      if (result.computed.shape) row(column++) = rod.deflection_theory_error.value_or(none);
    }
    if (points[k]->rods.empty()) continue;
    for (const TheoryQuantity& quantity : quantities)
      row(column++) = quantity.factor * (points[k]->*quantity.value).value_or(none);
  }
  return file;
}

}  // namespace hb::tools
