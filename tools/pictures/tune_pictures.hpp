// Pictures of both designs of `hb tune`, and the tables they are drawn from: response and growth over the speed,
// Campbell diagrams, and the stability map over the speed and over the way from one design to the other.
#pragma once

#include <vector>

#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

// Equally spaced values, both ends exact.
[[nodiscard]] std::vector<double> evenly(double from, double to, int count);

// Response and growth curves of both designs.
void write_curves(const TuneTask& task, const TuneResult& result, const Scene& scene, OutputFolder& folder);
// Writes the other tables. Empty at a single speed.
[[nodiscard]] std::vector<Figure> tune_figures(const TuneTask& task, const TuneResult& result, const Scene& scene,
                                               int num_threads, OutputFolder& folder);

}  // namespace hb::tools
