// What a machine's designer reads along a sweep: stress and safety of each rod, bearings, frame, drive.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "hb/analysis/sweep_analysis.hpp"
#include "tools/output/csv_output.hpp"

namespace hb::tools {

// Adds `stress` of one rod, arrays over the points; nothing where no section is given.
void add_stress(nlohmann::ordered_json& rod, std::size_t r, const std::vector<SweepPoint>& points, const Units& units);
// Adds bearings, frame, power, flywheel to the document, mean and rms to its torque.
void add_machine(nlohmann::ordered_json& document, const SweepResult& result);
// The same of points with joints of these names; null where a point has none.
void add_machine(nlohmann::ordered_json& document, const std::vector<std::string>& names,
                 const std::vector<const MachinePoint*>& points);
// A row for each motion at a value asked for; no row where joint forces were not.
[[nodiscard]] CsvFile branches_machine_csv(const SweepScene& scene, const NonlinearSweep& sweep);

// Lines of the table: the worst of the points and where.
[[nodiscard]] std::string stress_rows(const SweepScene& scene, const SweepResult& result, std::size_t rod);
[[nodiscard]] std::string machine_rows(const SweepScene& scene, const SweepResult& result);

// Columns of sweep_rod_csv, its last; empty where no section is given.
[[nodiscard]] std::vector<std::string> stress_columns(const SweepResult& result, std::size_t rod);
void fill_stress(const RodPoint& point, double megapascal, const std::vector<std::string>& columns,
                 Eigen::Ref<Eigen::RowVectorXd> values);
// Of each point and refined point the largest resultants at bearings and frame, torque, power, fluctuation.
[[nodiscard]] CsvFile sweep_machine_csv(const SweepScene& scene, const SweepResult& result);

}  // namespace hb::tools
