#include "tools/output/map_loads_output.hpp"

#include <fmt/core.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "hb/analysis/theory_error.hpp"
#include "lib/constants.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

using LoadValue = std::function<double(const RodLoads&)>;

double or_nan(const std::optional<double>& value) { return value.value_or(nan); }

struct LoadQuantity {
  const char* key;  // of the JSON; of `stress` where it is one
  const char* column;  // of the CSV, behind the rod's name
  enum class Kind { length, stress, factor, angle } kind;
  LoadValue value;
};

LoadValue of_stress(double StressPoint::*member) {
  return [member](const RodLoads& loads) { return loads.stress ? (*loads.stress).*member : nan; };
}

LoadValue of_safety(std::optional<double> StressPoint::*member) {
  return [member](const RodLoads& loads) { return loads.stress ? or_nan((*loads.stress).*member) : nan; };
}

const std::vector<LoadQuantity>& load_quantities() {
  using Kind = LoadQuantity::Kind;
  static const std::vector<LoadQuantity> list = {
      {"deflection", "deflection", Kind::length, [](const RodLoads& loads) { return or_nan(loads.deflection); }},
      {"theory_error", "theory error", Kind::factor, [](const RodLoads& loads) { return or_nan(loads.theory_error); }},
      {"axial", "axial stress", Kind::stress, of_stress(&StressPoint::axial)},
      {"bending", "bending stress", Kind::stress, of_stress(&StressPoint::bending)},
      {"max_abs", "stress", Kind::stress, of_stress(&StressPoint::max_abs)},
      {"x", "stress at x", Kind::length, of_stress(&StressPoint::x)},
      {"crank_angle", "stress at crank angle", Kind::angle, of_stress(&StressPoint::crank_angle)},
      {"mean", "mean stress", Kind::stress, of_stress(&StressPoint::mean)},
      {"amplitude", "stress amplitude", Kind::stress, of_stress(&StressPoint::amplitude)},
      {"error", "stress error", Kind::stress, of_stress(&StressPoint::error)},
      {"yield_safety", "yield safety", Kind::factor, of_safety(&StressPoint::yield_safety)},
      {"fatigue_safety", "fatigue safety", Kind::factor, of_safety(&StressPoint::fatigue_safety)}};
  return list;
}

constexpr std::size_t first_of_stress = 2;

const RodLoads* loads_at(const MapResult& result, std::size_t place, std::size_t r) {
  return r < result.loads[place].size() ? &result.loads[place][r] : nullptr;
}

bool somewhere(const MapResult& result, std::size_t r, const LoadQuantity& quantity) {
  for (std::size_t p = 0; p < result.loads.size(); ++p)
    if (const RodLoads* loads = loads_at(result, p, r); loads && !std::isnan(quantity.value(*loads))) return true;
  return false;
}

Json grid(const MapResult& result, std::size_t r, const LoadQuantity& quantity, double factor) {
  const std::size_t nx = result.x().size();
  Json rows = Json::array();
  for (std::size_t p = 0; p < result.loads.size(); ++p) {
    if (p % nx == 0) rows.push_back(Json::array());
    const RodLoads* loads = loads_at(result, p, r);
    rows.back().push_back(loads ? number(factor * quantity.value(*loads)) : Json(nullptr));
  }
  return rows;
}

struct WorstPlace {
  double value = nan;
  std::size_t place = 0;
};

WorstPlace worst_place(const MapResult& result, std::size_t r, bool smallest, const LoadValue& value) {
  WorstPlace worst;
  for (std::size_t p = 0; p < result.loads.size(); ++p) {
    const RodLoads* loads = loads_at(result, p, r);
    if (!loads || !(smallest || trusted_loads(result, p, r))) continue;
    const double here = value(*loads);
    if (std::isnan(here) || (smallest ? here >= worst.value : here <= worst.value)) continue;
    worst = {here, p};
  }
  return worst;
}

}  // namespace

bool trusted_loads(const MapResult& result, std::size_t place, std::size_t r) {
  const RodLoads* loads = loads_at(result, place, r);
  return loads && result.worst()[place].verdict != Verdict::unstable &&
         loads->theory_error.value_or(HUGE_VAL) <= theory_error_limit;
}

void add_loads(Json& rod, const MapResult& result, std::size_t r, const Units& units) {
  const std::vector<LoadQuantity>& all = load_quantities();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool safety = all[k].value && std::string(all[k].key).ends_with("safety");
    if (safety && !somewhere(result, r, all[k])) continue;
    (k < first_of_stress ? rod : rod["stress"])[all[k].key] =
        grid(result, r, all[k], all[k].kind == LoadQuantity::Kind::angle ? scene_angle(1, units) : 1);
  }
}

CsvFile map_loads_csv(const MapDocument& document) {
  const MapResult& r = document.result;
  const OutputUnits units = output_units(document.scene);
  const std::size_t nx = r.x().size();
  CsvFile file;
  file.name = "map_stress.csv";
  file.comment = {fmt::format("{}: largest deflection and stress over rod and turn over {} and {}",
                              scene_name(document.scene), r.x_axis.path, r.y_axis.path),
                  "stress: axial and bending together; mean and amplitude of the widest cycle; nan: no answer"};
  file.columns = {r.x_axis.path, r.y_axis.path};
  std::vector<std::function<double(std::size_t)>> values;
  for (std::size_t rod = 0; rod < r.rods.size(); ++rod)
    for (const LoadQuantity& quantity : load_quantities()) {
      if (!somewhere(r, rod, quantity)) continue;
      using Kind = LoadQuantity::Kind;
      const Kind kind = quantity.kind;
      const std::string unit = kind == Kind::stress   ? " [MPa]"
                               : kind == Kind::length ? " [" + units.length + "]"
                               : kind == Kind::angle  ? " [deg]"
                                                      : "";
      const double to_shown = kind == Kind::stress ? units.megapascal : kind == Kind::angle ? degrees_per_radian : 1;
      file.columns.push_back(r.rods[rod] + " " + quantity.column + unit);
      values.push_back([&, rod, factor = to_shown](std::size_t p) {
        const RodLoads* loads = loads_at(r, p, rod);
        return loads ? factor * quantity.value(*loads) : nan;
      });
    }
  file.rows.resize(static_cast<Eigen::Index>(r.loads.size()), static_cast<Eigen::Index>(file.columns.size()));
  for (std::size_t p = 0; p < r.loads.size(); ++p) {
    const auto row = static_cast<Eigen::Index>(p);
    file.rows(row, 0) = r.x()[p % nx];
    file.rows(row, 1) = r.y()[p / nx];
    for (std::size_t c = 0; c < values.size(); ++c) file.rows(row, static_cast<Eigen::Index>(c) + 2) = values[c](p);
  }
  return file;
}

LoadColumns load_columns(const MapResult& result, std::size_t r) {
  LoadColumns columns;
  int next = 3;
  for (std::size_t rod = 0; rod <= r; ++rod)
    for (const LoadQuantity& quantity : load_quantities()) {
      if (!somewhere(result, rod, quantity)) continue;
      const int column = next++;
      if (rod < r) continue;
      const std::string key = quantity.key;
      if (key == "deflection") columns.deflection = column;
      if (key == "theory_error") columns.theory_error = column;
      if (key == "max_abs") columns.stress = column;
      if (key == "yield_safety") columns.yield_safety = column;
      if (key == "fatigue_safety") columns.fatigue_safety = column;
    }
  return columns;
}

std::string loads_rows(const MapDocument& document) {
  const MapResult& r = document.result;
  if (r.loads.empty()) return "";
  const OutputUnits units = output_units(document.scene);
  std::string text = "\n  largest where stable and within the linear theory, smallest of all points\n";
  const std::size_t nx = r.x().size();
  for (std::size_t rod = 0; rod < r.rods.size(); ++rod) {
    const auto row = [&](const char* what, bool smallest, double factor, const std::string& unit,
                         const LoadValue& value) {
      const WorstPlace worst = worst_place(r, rod, smallest, value);
      if (std::isnan(worst.value)) return;
      text += fmt::format("    {:<8} {:<34} {:>11.4g}{:<4} at {}{}\n", r.rods[rod], what, factor * worst.value,
                          unit.empty() ? "" : " " + unit,
                          place_words(document, r.x()[worst.place % nx], r.y()[worst.place / nx]),
                          smallest && worst.value < 1 ? ": NOT ENOUGH" : "");
    };
    row("largest deflection", false, 1, units.length, [](const RodLoads& loads) { return or_nan(loads.deflection); });
    row("largest stress", false, units.megapascal, "MPa", of_stress(&StressPoint::max_abs));
    row("smallest safety against yielding", true, 1, "", of_safety(&StressPoint::yield_safety));
    row("smallest safety against fatigue", true, 1, "", of_safety(&StressPoint::fatigue_safety));
  }
  return text;
}

}  // namespace hb::tools
