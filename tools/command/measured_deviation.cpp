#include "tools/command/measured_deviation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/constants.hpp"
#include "tools/command/steady_files.hpp"
#include "tools/output/json.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/pictures/sweep_figures.hpp"

namespace hb::tools {
namespace {

// The computed value at a place beside a measured one; NaN: there is none.
using Computed = std::function<double(double at, double measured)>;

MeasuredDeviation deviation_of(MeasuredQuantity quantity, const Eigen::VectorXd& at, const Eigen::VectorXd& measured,
                               const Eigen::VectorXd& computed) {
  MeasuredDeviation found{std::move(quantity.name), std::move(quantity.unit)};
  double sum = 0, square = 0;
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    const double off = measured(k) - computed(k);
    if (!std::isfinite(off)) {
      ++found.left_out;
      continue;
    }
    ++found.values;
    sum += off;
    square += off * off;
    if (found.values == 1 || std::abs(off) > std::abs(found.largest)) {
      found.largest = off;
      found.at = at(k);
    }
    found.size = std::max(found.size, std::abs(measured(k)));
  }
  found.mean = found.values > 0 ? sum / found.values : nan;
  found.rms = found.values > 0 ? std::sqrt(square / found.values) : nan;
  if (found.values == 0) found.largest = found.at = found.size = nan;
  return found;
}

MeasuredComparison compared(const std::string& file, const MeasuredQuantity& axis,
                            const std::vector<MeasuredQuantity>& known, MeasuredOverlay overlay,
                            const std::function<Computed(const std::string& quantity)>& computed_of) {
  MeasuredComparison result{file, axis, {}, std::move(overlay)};
  const CsvFile csv = result.overlay.csv();
  const Eigen::VectorXd at = csv.rows.col(0);
  for (std::size_t k = 1; k < csv.columns.size(); ++k) {
    const Eigen::VectorXd measured = csv.rows.col(static_cast<Eigen::Index>(k));
    const Computed value = computed_of(csv.columns[k]);
    Eigen::VectorXd computed(at.size());
    for (Eigen::Index j = 0; j < at.size(); ++j) computed(j) = value(at(j), measured(j));
    result.deviations.push_back(
        deviation_of(*std::ranges::find(known, csv.columns[k], &MeasuredQuantity::name), at, measured, computed));
    result.overlay.add_column(csv.columns[k] + ", computed", computed);
  }
  return result;
}

// q_i, a component of a joint force, or the torque; as steady's measured_quantities names them.
FourierSeries measured_series(const SceneModel& model, const SpeedResult& result, const std::string& quantity) {
  const OutputUnits units = output_units(model.scene);
  const auto one = [](const FourierSeries& series, Eigen::Index c, double factor) {
    return FourierSeries(Eigen::MatrixXcd(factor * series.c.row(c)));
  };
  for (const RodResult& rod : result.rods)
    for (Eigen::Index i = 1; rod.steady && i <= rod.num_modes; ++i)
      if (quantity == fmt::format("q_{} {}", i, rod.name)) return one(rod.steady->q, i - 1, 1);
  if (quantity == "torque") return one(result.forces->torque, 0, units.moment);
  for (const JointForce& joint : result.forces->joints)
    if (quantity.starts_with(joint.name + " ")) return one(joint.elastic, quantity.back() == 'y' ? 1 : 0, units.force);
  return {};
}

// Columns, from 1, of the table of a rod or of joint forces that hold the quantity: the nearest of them counts.
struct TableColumns {
  CsvFile table;
  std::vector<Eigen::Index> columns;
};

TableColumns columns_of_quantity(const Sweep& sweep, const std::string& quantity) {
  TableColumns found;
  for (std::size_t r = 0; r < sweep.rods.size(); ++r) {
    const SweepRod& rod = sweep.rods[r];
    if (!rod.reported || !quantity.ends_with(" " + rod.name)) continue;
    const std::string what = quantity.substr(0, quantity.size() - rod.name.size() - 1);
    const SweepColumns columns = sweep_columns(*sweep.scene, sweep, r);
    found.table = sweep_rod_csv(*sweep.scene, sweep, r);
    if (what == "deflection") found.columns = {columns.deflection};
    if (what == "bending moment") found.columns = {columns.bending_moment};
    if (what == "growth rate") found.columns = {columns.growth};
    if (what.starts_with("q_")) found.columns = {columns.first_peak + std::stoi(what.substr(2)) - 1};
    for (int mode = 0; what == "frequency" && mode < rod.num_modes; ++mode)
      found.columns.push_back(columns.first_frequency + 2 * mode);
    const auto stress = std::ranges::find(found.table.columns, "stress [MPa]");
    if (what == "stress" && stress != found.table.columns.end())
      found.columns = {stress - found.table.columns.begin() + 1};
    if (!found.columns.empty()) return found;
  }
  found.table = sweep_forces_csv(*sweep.scene, sweep);
  for (const char* end : {" smallest [", " largest ["})
    for (std::size_t c = 0; c < found.table.columns.size(); ++c)
      if (found.table.columns[c].starts_with(quantity + end)) found.columns.push_back(static_cast<Eigen::Index>(c) + 1);
  return found;
}

}  // namespace

MeasuredComparison compare_measured(const std::string& file, const SceneModel& model, const SpeedResult& result,
                                    const std::string& theory, int turns) {
  const MeasuredQuantity axis{"crank angle", "deg"};
  const std::vector<MeasuredQuantity> known = measured_quantities(model, result);
  MeasuredComparison found =
      compared(file, axis, known, read_measured(file, axis, known), [&](const std::string& quantity) -> Computed {
        return [series = measured_series(model, result, quantity), turns](double at, double) {
          return series.c.size() > 0 ? fourier::evaluate(series, at / degrees_per_radian / turns)(0) : nan;
        };
      });
  for (MeasuredDeviation& one : found.deviations) one.theory = theory;
  return found;
}

namespace {

// The request at the measured places within its range, and at its ends.
SweepRequest at_measured(const SweepRequest& request, const MeasuredOverlay& overlay) {
  SweepRequest at_places = request;
  at_places.search = false;
  std::vector<double>& places = at_places.x.values;
  const double low = places.front(), high = places.back();
  places = {low, high};
  for (const double place : Eigen::VectorXd(overlay.csv().rows.col(0)))
    if (place > low && place < high) places.push_back(place);
  std::ranges::sort(places);
  places.erase(std::ranges::unique(places).begin(), places.end());
  return at_places;
}

Computed linear_values(const Sweep& found, const std::string& quantity) {
  return [here = columns_of_quantity(found, quantity)](double at, double measured) {
    double nearest = nan;
    for (Eigen::Index k = 0; k < here.table.rows.rows(); ++k)
      for (const Eigen::Index column : here.columns) {
        const double value = here.table.rows(k, column - 1);
        if (here.table.rows(k, 0) == at && std::isfinite(value) &&
            !(std::abs(nearest - measured) <= std::abs(value - measured)))
          nearest = value;
      }
    return nearest;
  };
}

using OfMotion = std::function<double(const NonlinearPoint&)>;

// Deflection, bending moment, stress or q_i of a rod, in the units of the pictures; empty: nothing of a motion.
OfMotion of_motion(const NonlinearSweep& branches, const OutputUnits& units, const std::string& quantity) {
  for (std::size_t r = 0; r < branches.rods.size(); ++r) {
    if (!quantity.ends_with(" " + branches.rods[r])) continue;
    const std::string what = quantity.substr(0, quantity.size() - branches.rods[r].size() - 1);
    const auto loaded = [r](auto value) -> OfMotion {
      return [=](const NonlinearPoint& p) { return p.loads.empty() ? nan : value(p.loads[r]); };
    };
    if (what == "deflection") return loaded([](const BentLoads& l) { return l.deflection; });
    if (what == "bending moment")
      return loaded([f = units.moment](const BentLoads& l) { return f * l.bending_moment; });
    if (what == "stress")
      return loaded([f = units.megapascal](const BentLoads& l) { return l.cycle ? f * l.cycle->max_abs : nan; });
    if (what.starts_with("q_")) {
      const auto i = static_cast<std::size_t>(std::stoi(what.substr(2)) - 1);
      return [r, i](const NonlinearPoint& p) { return p.max_abs[r][i]; };
    }
  }
  return {};
}

Computed motion_values(const NonlinearSweep& branches, const OfMotion& of) {
  return [&branches, of](double at, double measured) {
    double nearest = nan;
    for (const NonlinearBranch& branch : branches.branches)
      for (const NonlinearPoint& point : branch.points) {
        if (!point.asked || std::abs(point.x - at) > 1e-12 * std::abs(at)) continue;
        if (point.stability && point.stability->verdict == Verdict::unstable) continue;
        const double value = of(point);
        if (std::isfinite(value) && !(std::abs(nearest - measured) <= std::abs(value - measured))) nearest = value;
      }
    return nearest;
  };
}

}  // namespace

MeasuredComparison compare_measured(const std::string& file, const SceneFamily& family, const SweepRequest& request,
                                    const SweepScene& scene, const std::optional<NonlinearSweepOptions>& asked,
                                    Work& work) {
  const MeasuredQuantity axis = measured_axis(scene);
  const std::vector<MeasuredQuantity> known = measured_quantities(scene);
  MeasuredOverlay overlay = read_measured(file, axis, known);
  const Sweep found = sweep(family, at_measured(request, overlay), work);
  std::optional<NonlinearSweep> branches;
  if (asked) branches = nonlinear_sweep(*found.scene, *asked);
  const auto motion_of = [&, units = output_units(scene.scene())](const std::string& quantity) {
    return branches ? of_motion(*branches, units, quantity) : OfMotion();
  };
  MeasuredComparison result =
      compared(file, axis, known, std::move(overlay), [&](const std::string& quantity) -> Computed {
        const OfMotion of = motion_of(quantity);
        return of ? motion_values(*branches, of) : linear_values(found, quantity);
      });
  for (MeasuredDeviation& one : result.deviations)
    if (motion_of(one.quantity)) one.theory = "nonlinear";
  return result;
}

Json measured_json(const MeasuredComparison& comparison) {
  Json list = Json::array();
  for (const MeasuredDeviation& one : comparison.deviations)
    list.push_back({{"quantity", one.quantity},
                    {"unit", one.unit},
                    {"theory", one.theory},
                    {"values", one.values},
                    {"left_out", one.left_out},
                    {"mean", number(one.mean)},
                    {"rms", number(one.rms)},
                    {"largest", number(one.largest)},
                    {"at", number(one.at)},
                    {"largest_measured", number(one.size)}});
  return {{"file", comparison.file},
          {"along", comparison.axis.name},
          {"along_unit", comparison.axis.unit},
          {"deviations", std::move(list)}};
}

std::string measured_table(const MeasuredComparison& comparison) {
  const MeasuredQuantity& axis = comparison.axis;
  std::string text = fmt::format("\nMeasured less computed, {}\n  {:<28}  {:>6}  {:>11}  {:>11}  {:>11}  {:>14}  {}\n",
                                 comparison.file, "", "values", "mean", "rms", "largest", "at" + bracketed(axis.unit),
                                 "rms/largest measured");
  int left_out = 0;
  std::string linear;
  const bool some_nonlinear = std::ranges::any_of(
      comparison.deviations, [](const MeasuredDeviation& one) { return one.theory == "nonlinear"; });
  for (const MeasuredDeviation& one : comparison.deviations) {
    if (some_nonlinear && one.theory == "linear") linear += (linear.empty() ? "" : ", ") + one.quantity;
    left_out = std::max(left_out, one.left_out);
    const std::string name = one.quantity + bracketed(one.unit);
    if (one.values == 0)
      text += fmt::format("  {:<28}  {:>6}  no value where anything is computed\n", name, 0);
    else
      text += fmt::format("  {:<28}  {:>6}  {:>11.4g}  {:>11.4g}  {:>11.4g}  {:>14.6g}  {:.3g} %\n", name, one.values,
                          one.mean, one.rms, one.largest, one.at, one.size > 0 ? 100 * one.rms / one.size : 0);
  }
  if (left_out > 0)
    text += fmt::format("  left out: {} outside the range or where nothing is computed\n",
                        left_out == 1 ? "1 value" : fmt::format("up to {} values of a column", left_out));
  if (!linear.empty()) text += "  by the linear theory: " + linear + "; all else of the motion without linearisation\n";
  return text;
}

}  // namespace hb::tools
