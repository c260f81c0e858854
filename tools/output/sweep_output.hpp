// A sweep as JSON, tables and text. JSON keeps the scene's units; tables those of output_units.hpp.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "hb/analysis/sweep_analysis.hpp"
#include "tools/output/csv_output.hpp"

namespace hb::tools {

[[nodiscard]] nlohmann::ordered_json sweep_json(const SweepScene& scene, const SweepResult& result, bool stats);
[[nodiscard]] std::string sweep_table(const SweepScene& scene, const SweepResult& result);

// "crank speed [rpm]", "omega [rad/s]" or the path.
[[nodiscard]] std::string axis_label(const SweepScene& scene);

// Points and refined points of one rod: x, peaks, growth rate, verdict (1 unstable, 0 undecided, -1 stable), errors;
// then per mode its frequency and growth rate.
[[nodiscard]] CsvFile sweep_rod_csv(const SweepScene& scene, const SweepResult& result, std::size_t rod);
// Smallest and largest joint forces and torque over the turn, elastic beside rigid.
[[nodiscard]] CsvFile sweep_forces_csv(const SweepScene& scene, const SweepResult& result);
// One row per critical point, one per unstable band; the first column is the number of the rod (from 1).
[[nodiscard]] CsvFile critical_csv(const SweepScene& scene, const SweepResult& result);
[[nodiscard]] CsvFile bands_csv(const SweepScene& scene, const SweepResult& result);
[[nodiscard]] CsvFile not_excluded_csv(const SweepScene& scene, const SweepResult& result);

// Columns of sweep_rod_csv, from 1 as in gnuplot; 0: not there.
struct SweepColumns {
  int first_peak = 0;  // of q_1; the others follow
  int deflection = 0, bending_moment = 0;
  int beyond = 0;  // 1: beyond the linear theory; the theory error stands before it
  int growth = 0;
  int first_frequency = 0;  // of mode 1; its growth rate stands beside, the other modes follow
};
[[nodiscard]] SweepColumns sweep_columns(const SweepScene& scene, const SweepResult& result, std::size_t rod);

}  // namespace hb::tools
