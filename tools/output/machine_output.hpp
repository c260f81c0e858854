// What a machine's designer reads beside joint forces: resultants at the bearings, what the frame feels, the drive, the
// sliders' motion, the deflection at rest, the stress over a turn.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/bearing_load.hpp"
#include "hb/analysis/drive.hpp"
#include "hb/analysis/linkage_analysis.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/output_units.hpp"

namespace hb::tools {

// Parts of the table and the document that all theories have.
[[nodiscard]] std::string bearing_rows(const std::vector<BearingLoad>& loads, const OutputUnits& units);
// `torque_error`: relative, below which a mean is 0.
[[nodiscard]] std::string drive_rows(const Drive& drive, const std::optional<double>& fluctuation, double torque_error,
                                     double speed, const Scene& scene);
[[nodiscard]] nlohmann::ordered_json bearings_json(const std::vector<BearingLoad>& loads, const Units& units);
// Adds power and flywheel to the document, mean and rms to its torque.
void add_drive(nlohmann::ordered_json& document, const Drive& drive, const Drive& rigid, double inertia,
               const std::optional<double>& fluctuation);

// Rows for the table, where joint forces were computed.
[[nodiscard]] std::string machine_rows(const SceneModel& model, const SpeedResult& result);
// "static deflection  ..." of one rod; empty where its shape was not computed.
[[nodiscard]] std::string static_row(const SceneModel& model, const SpeedResult& result, std::size_t rod);

// Axial and bending stress together: the largest, and the widest cycle; empty without a section.
[[nodiscard]] std::string stress_rows(const SceneModel& model, const SpeedResult& result, std::size_t rod);
// Rods whose stress is above their yield strength.
[[nodiscard]] std::vector<std::string> strength_warnings(const SceneModel& model, const SpeedResult& result);
void add_stress_cycle(nlohmann::ordered_json& stress, const SceneModel& model, const SpeedResult& result,
                      std::size_t rod);

// Adds bearings, frame, power, drive and sliders to the document, mean and rms to its torque.
void add_machine(nlohmann::ordered_json& document, const SceneModel& model, const SpeedResult& result);
// The value of static_deflection of one rod: null where it would buckle.
[[nodiscard]] nlohmann::ordered_json static_json(const SceneModel& model, const SpeedResult& result, std::size_t rod);

// x, smallest and largest stress over the turn of the right and the left fibre; empty without a section.
[[nodiscard]] std::optional<CsvFile> stress_csv(const SceneModel& model, const SpeedResult& result, std::size_t rod);
// Crank angle, force x, y and moment on the frame, elastic and rigid.
[[nodiscard]] CsvFile frame_csv(const SceneModel& model, const SpeedResult& result);
// Crank angle, position, velocity and acceleration; one file for each slider.
[[nodiscard]] std::vector<CsvFile> slider_csvs(const SceneModel& model, const SpeedResult& result);

}  // namespace hb::tools
