// Branches of the motion without linearisation beside a linear sweep: JSON, table, CSV.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "tools/output/csv_output.hpp"

namespace hb::tools {

// Adds "branches", "folds", "bifurcations" and "jumps" to the document of the linear sweep.
void add_branches(nlohmann::ordered_json& json, const SweepScene& scene, const NonlinearSweep& sweep);
// The verdict of the motion followed from the first value, and where it does not come.
[[nodiscard]] std::string branches_words(const NonlinearSweep& sweep);
// The first line: the verdict of the motion followed from the first value, "TITLE, motion without linearisation: ...".
[[nodiscard]] std::string branches_verdict(const SweepScene& scene, const NonlinearSweep& sweep);
[[nodiscard]] std::string branches_table(const SweepScene& scene, const NonlinearSweep& sweep);
// One row per point: branch, turns, x, whether asked for, max |q_i|, error bound, growth rate and error, verdict.
[[nodiscard]] CsvFile branches_csv(const SweepScene& scene, const NonlinearSweep& sweep, std::size_t rod);
// Columns of branches_csv, from 1 as in gnuplot.
inline constexpr int branch_column = 1, branch_x_column = 3, branch_first_peak_column = 5;
[[nodiscard]] int branch_verdict_column(const NonlinearSweep& sweep, std::size_t rod);
// One row per fold, bifurcation and jump.
[[nodiscard]] CsvFile bifurcations_csv(const SweepScene& scene, const NonlinearSweep& sweep);

}  // namespace hb::tools
