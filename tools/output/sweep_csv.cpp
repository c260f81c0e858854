#include <fmt/core.h>

#include "lib/constants.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/sweep_machine.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

std::string subject(const SweepScene& scene, const SweepResult& result, std::size_t rod) {
  return scene.first().linkage() ? result.rods[rod].name : "system";
}

std::string about(const SweepScene& scene, const std::string& what) {
  return fmt::format("{}: {}", scene_name(scene.scene()), what);
}

// The columns after x and "asked for", as sweep_rod_csv names them, up to those of stress.
void fill_rod_point(Eigen::MatrixXd::RowXpr row, const SweepScene& scene, const SweepResult& result,
                    const RodPoint& here, Eigen::Index num_modes, const std::vector<ModeState>& modes) {
  const OutputUnits units = output_units(scene.scene());
  const FrequencyUnit frequency = frequency_unit(scene.scene());
  const Only& only = result.computed;
  Eigen::Index column = 2;
  if (only.steady) {
    for (std::size_t i = 0; i < here.max_abs.size(); ++i) row(column + static_cast<Eigen::Index>(i)) = here.max_abs[i];
    column += num_modes;
    row(column++) = here.error_bound;
  }
  if (only.shape) {
    row(column++) = here.deflection.value_or(nan);
    row(column++) = here.bending_moment.value_or(nan) * units.moment;
    row(column++) = here.deflection_error.value_or(nan);
    row(column++) = here.bending_moment_error.value_or(nan) * units.moment;
  }
  if (has_theory(scene, result)) {
    row(column++) = here.theory_error.value_or(nan);
    row(column++) = beyond_theory(here.theory_error) || beyond_limits(here) ? 1 : 0;
  }
  if (only.stability) {
    const Stability& stability = here.stability->stability;
    row(column++) = std::isfinite(stability.growth_rate) ? stability.growth_rate : nan;
    row(column++) = stability.growth_error;
    row(column++) = verdict_number(stability.verdict);
    for (const ModeState& mode : modes) {
      row(column++) = mode.frequency * frequency.factor;
      row(column++) = mode.growth;
    }
  }
}

// Which points a table has, as it was asked.
std::string points_words(const SweepResult& result) {
  const bool peaks = result.computed.steady && result.searched_peaks,
             boundaries = result.computed.stability && result.searched_bands;
  return std::string("points asked for") + (peaks || boundaries ? " and, between them, " : "") +
         (peaks ? "resonance peaks with their flanks" : "") + (peaks && boundaries ? " and " : "") +
         (boundaries ? "stability boundaries" : "");
}

}  // namespace

SweepColumns sweep_columns(const SweepScene& scene, const SweepResult& result, std::size_t rod) {
  SweepColumns columns;
  int next = 3;
  if (result.computed.steady) {
    columns.first_peak = next;
    next += result.rods[rod].num_modes + 1;
  }
  if (result.computed.shape) {
    columns.deflection = next++;
    columns.bending_moment = next++;
    next += 2;  // their errors
  }
  if (has_theory(scene, result)) {
    columns.beyond = next + 1;
    next += 2;
  }
  if (result.computed.stability) {
    columns.growth = next;
    columns.first_frequency = next + 3;
  }
  return columns;
}

CsvFile sweep_rod_csv(const SweepScene& scene, const SweepResult& result, std::size_t r) {
  const OutputUnits units = output_units(scene.scene());
  const Only& only = result.computed;
  const SweepRod& rod = result.rods[r];
  const int I = rod.num_modes;
  const FrequencyUnit frequency = frequency_unit(scene.scene());
  const std::vector<const SweepPoint*> points = all_points(result);
  CsvFile file;
  file.name = file_name("sweep_" + rod.name) + ".csv";
  file.comment = {about(scene, rod.name + " along " + scene.axis().path), points_words(result)};
  file.columns = {axis_label(scene), "asked for"};
  if (only.steady) {
    for (int i = 1; i <= I; ++i) file.columns.push_back(fmt::format("max |q_{}|{}", i, bracketed(units.response)));
    file.columns.push_back("error bound");
  }
  if (only.shape) {
    file.columns.push_back("deflection [" + units.length + "]");
    file.columns.push_back("bending moment [N m]");
    file.columns.push_back("deflection error [" + units.length + "]");
    file.columns.push_back("bending moment error [N m]");
  }
  if (has_theory(scene, result)) {
    file.columns.push_back("theory error");
    file.columns.push_back("beyond the linear theory");
    file.comment.push_back(
        fmt::format("theory error: first nonlinear correction of q, relative; beyond: above {} or none, "
                    "or beyond small deflections",
                    theory_error_limit));
  }
  if (only.stability) {
    file.columns.insert(file.columns.end(),
                        {"growth rate" + bracketed(units.rate), "growth error" + bracketed(units.rate), "verdict"});
    file.comment.push_back(std::string(verdict_numbers) + "; per mode frequency (unfolded) and growth rate");
    if (only.verdict) file.comment.push_back(bounds_among_growth);
    for (int i = 1; i <= I; ++i) {
      file.columns.push_back(fmt::format("frequency of mode {} [{}]", i, frequency.name));
      file.columns.push_back(fmt::format("growth of mode {}{}", i, bracketed(units.rate)));
    }
  }
  const std::vector<std::string> stress = stress_columns(result, r);
  file.columns.insert(file.columns.end(), stress.begin(), stress.end());
  file.rows.setConstant(static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(file.columns.size()), nan);
  std::vector<std::vector<ModeState>> modes;
  if (only.stability) modes = tracks(result, r, points);
  const auto in_grid = [&](const SweepPoint* p) {
    return p >= result.points.data() && p < result.points.data() + result.points.size();
  };
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SweepPoint& point = *points[k];
    auto row = file.rows.row(static_cast<Eigen::Index>(k));
    row(0) = point.x;
    row(1) = in_grid(points[k]) ? 1 : 0;
    if (!point.problem.empty()) continue;
    const RodPoint& here = point.rods[r];
    fill_rod_point(row, scene, result, here, I, only.stability ? modes[k] : std::vector<ModeState>());
    Eigen::RowVectorXd stresses = row.tail(static_cast<Eigen::Index>(stress.size()));
    fill_stress(here, units.megapascal, stress, stresses);
    row.tail(stresses.size()) = stresses;
  }
  return file;
}

CsvFile sweep_forces_csv(const SweepScene& scene, const SweepResult& result) {
  const OutputUnits units = output_units(scene.scene());
  const std::vector<const SweepPoint*> points = all_points(result);
  CsvFile file;
  file.name = "sweep_joint_forces.csv";
  file.comment = {about(scene, "joint forces along " + scene.axis().path + ", smallest and largest over the turn"),
                  "x along, y across the coupler of the joint's dyad; LINK.1 acts on the link, LINK.0 is passed on to "
                  "the link before it, pivots and guides act on their link"};
  file.columns = {axis_label(scene)};
  std::vector<std::string> names = result.joint_components;
  names.push_back("torque");
  for (const std::string& name : names) {
    const char* unit = name == "torque" ? "N m" : "N";
    for (const char* what : {"smallest", "largest", "rigid smallest", "rigid largest"})
      file.columns.push_back(fmt::format("{} {} [{}]", name, what, unit));
  }
  file.rows.setConstant(static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(file.columns.size()), nan);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SweepPoint& point = *points[k];
    auto row = file.rows.row(static_cast<Eigen::Index>(k));
    row(0) = point.x;
    if (!point.torque) continue;
    Eigen::Index column = 1;
    const auto put = [&](const TurnRange& elastic, const TurnRange& rigid, double factor) {
      for (const double value : {elastic.min, elastic.max, rigid.min, rigid.max}) row(column++) = factor * value;
    };
    for (std::size_t c = 0; c < point.joints.size(); ++c) put(point.joints[c], point.joints_rigid[c], units.force);
    put(*point.torque, *point.torque_rigid, units.moment);
  }
  return file;
}

CsvFile critical_csv(const SweepScene& scene, const SweepResult& result) {
  const OutputUnits units = output_units(scene.scene());
  const FrequencyUnit frequency = frequency_unit(scene.scene());
  CsvFile file;
  file.name = "critical.csv";
  std::string rods;
  for (std::size_t r = 0; r < result.rods.size(); ++r)
    rods += fmt::format("{}{} {}", r == 0 ? "" : ", ", r + 1, subject(scene, result, r));
  file.comment = {about(scene, "local maxima of the largest |q_i| along " + scene.axis().path),
                  "rods: " + rods + "; mode and order n = omega/Omega: 0 if not known"};
  file.columns = {"rod",
                  axis_label(scene),
                  "error",
                  "i",
                  "max |q_i|" + bracketed(units.response),
                  "mode",
                  "order",
                  "frequency [" + frequency.name + "]",
                  "damping" + bracketed(units.rate),
                  "prominence"};
  file.rows.resize(static_cast<Eigen::Index>(result.critical.size()), 10);
  for (std::size_t k = 0; k < result.critical.size(); ++k) {
    const CriticalPoint& p = result.critical[k];
    file.rows.row(static_cast<Eigen::Index>(k)) << static_cast<double>(p.rod + 1), p.peak.x, p.peak.error,
        p.component + 1, p.peak.value, p.mode + 1, p.order, p.frequency * frequency.factor, p.damping, p.prominence;
  }
  return file;
}

CsvFile bands_csv(const SweepScene& scene, const SweepResult& result) {
  const OutputUnits units = output_units(scene.scene());
  CsvFile file;
  file.name = "unstable_bands.csv";
  std::string rods;
  for (std::size_t r = 0; r < result.rods.size(); ++r)
    rods += fmt::format("{}{} {}", r == 0 ? "" : ", ", r + 1, subject(scene, result, r));
  file.comment = {about(scene, "unstable bands along " + scene.axis().path),
                  "rods: " + rods +
                      "; kinds of the multiplier at the ends: 1, -1, 0 a complex pair; open: the sweep ends "
                      "inside the band"};
  file.columns = {"rod",        axis_label(scene) + " from",
                  "to",         "open below",
                  "open above", "kind from",
                  "kind to",    "fastest growth" + bracketed(units.rate),
                  "at"};
  std::size_t count = 0;
  for (const SweepRod& rod : result.rods) count += rod.bands.size();
  file.rows.resize(static_cast<Eigen::Index>(count), 9);
  const auto kind = [](BoundaryKind k) {
    return k == BoundaryKind::plus_one ? 1 : k == BoundaryKind::minus_one ? -1 : 0;
  };
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    for (const UnstableBand& band : result.rods[r].bands) {
      file.rows.row(row++) << static_cast<double>(r + 1), band.from, band.to, band.open_from, band.open_to,
          kind(band.kind_from), kind(band.kind_to), band.fastest, band.fastest_x;
    }
  }
  return file;
}

CsvFile not_excluded_csv(const SweepScene& scene, const SweepResult& result) {
  CsvFile file;
  file.name = "not_excluded.csv";
  std::string rods;
  std::size_t count = 0;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    rods += fmt::format("{}{} {}", r == 0 ? "" : ", ", r + 1, subject(scene, result, r));
    count += result.rods[r].not_excluded.size();
  }
  file.comment = {
      about(scene, "where further unstable bands or stable gaps are not excluded along " + scene.axis().path),
      "rods: " + rods};
  file.columns = {"rod", axis_label(scene) + " from", "to"};
  file.rows.resize(static_cast<Eigen::Index>(count), 3);
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < result.rods.size(); ++r)
    for (const auto& [from, to] : result.rods[r].not_excluded)
      file.rows.row(row++) << static_cast<double>(r + 1), from, to;
  return file;
}

}  // namespace hb::tools
