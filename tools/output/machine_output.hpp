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
#include "hb/analysis/machine_loads.hpp"
#include "hb/analysis/slider_motion.hpp"
#include "hb/analysis/stress_cycle.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/output_units.hpp"

namespace hb::tools {

// Parts of the table and the document that all theories have.
[[nodiscard]] std::string machine_rows(const MachineLoads& loads, const std::vector<SliderMotion>& sliders,
                                       double speed, const Scene& scene);
// Adds bearings, frame, power, drive and sliders to the document; mean, rms and error to its torque.
void add_machine(nlohmann::ordered_json& document, const MachineLoads& loads, const std::vector<SliderMotion>& sliders,
                 double speed, const Units& units);
// Axial and bending stress together: the largest, the widest cycle and the safeties.
[[nodiscard]] std::string stress_rows(const StressCycle& cycle, const Body& link, const OutputUnits& units);
void add_stress_cycle(nlohmann::ordered_json& stress, const StressCycle& cycle, const Body& link, const Units& units);
// Where the stress is above the yield strength.
[[nodiscard]] std::optional<std::string> yield_warning(const std::string& name, const StressCycle& cycle,
                                                       const Body& link, const OutputUnits& units);
// Of an answer of the linear theory:

// Rows for the table, where joint forces were computed.
[[nodiscard]] std::string machine_rows(const SceneModel& model, const SpeedResult& result);
// "static deflection  ..." of one rod; empty where its shape was not computed.
[[nodiscard]] std::string static_row(const SceneModel& model, const SpeedResult& result, std::size_t rod);

// Empty without a section.
[[nodiscard]] std::string stress_rows(const SceneModel& model, const SpeedResult& result, std::size_t rod);
// Rods whose stress is above their yield strength.
[[nodiscard]] std::vector<std::string> strength_warnings(const SceneModel& model, const SpeedResult& result);
void add_stress_cycle(nlohmann::ordered_json& stress, const SceneModel& model, const SpeedResult& result,
                      std::size_t rod);

void add_machine(nlohmann::ordered_json& document, const SceneModel& model, const SpeedResult& result);
// The value of static_deflection of one rod: null where it would buckle.
[[nodiscard]] nlohmann::ordered_json static_json(const SceneModel& model, const SpeedResult& result, std::size_t rod);

// What the files below show, of one answer: by rod where it has a section, and where joint forces were computed.
struct MachineFiles {
  std::vector<std::optional<StressEnvelope>> envelopes;
  std::optional<FrameForces> frame;
  std::vector<SliderMotion> sliders;
};
[[nodiscard]] MachineFiles machine_files(const SceneModel& model, const SpeedResult& result);

// x, smallest and largest stress over the turn of the right and the left fibre.
[[nodiscard]] CsvFile stress_csv(const Scene& scene, double speed, const std::string& rod,
                                 const StressEnvelope& envelope);
// Crank angle, force x, y and moment on the frame, elastic and rigid.
[[nodiscard]] CsvFile frame_csv(const Scene& scene, double speed, const FrameForces& frame);
// Crank angle, position, velocity and acceleration; one file for each slider.
[[nodiscard]] std::vector<CsvFile> slider_csvs(const Scene& scene, double speed,
                                               const std::vector<SliderMotion>& sliders);

}  // namespace hb::tools
