// Branches of the motion without linearisation over the linear response.
#pragma once

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/pictures/measured.hpp"

namespace hb::tools {

// max |q_1| of one rod: solid where stable, dashed where not, folds as dots, bifurcations as circles; grey the linear
// answer.
[[nodiscard]] Figure branch_figure(const SweepScene& scene, const SweepResult& linear, const NonlinearSweep& sweep,
                                   std::size_t rod, const CsvFile& linear_csv, const CsvFile& branches,
                                   const MeasuredOverlay& measured);

}  // namespace hb::tools
