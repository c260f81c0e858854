// The CSV files of a sweep and of a map, and what is drawn of them.
#pragma once

#include <vector>

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "hb/analysis/sweep_analysis.hpp"
#include "tools/output/map_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/pictures/map_plot.hpp"
#include "tools/pictures/measured.hpp"
#include "tools/report/report_page.hpp"

namespace hb::tools {

[[nodiscard]] std::vector<Figure> sweep_files(const SweepScene& scene, const SweepResult& result, OutputFolder& folder,
                                              const MeasuredOverlay& measured = {});
// What `linear` has beside it without linearisation.
[[nodiscard]] std::vector<Figure> branch_files(const SweepScene& scene, const SweepResult& linear,
                                               const NonlinearSweep& sweep, OutputFolder& folder,
                                               const MeasuredOverlay& measured = {});
[[nodiscard]] std::vector<Figure> map_files(const MapDocument& document, MapColour colour, OutputFolder& folder);

// Pictures of a report for readers without script; `branches` and `map` may be null.
[[nodiscard]] std::vector<PageText::Picture> report_pictures(const SweepScene& scene, const SweepResult& result,
                                                             const NonlinearSweep* branches, const MapDocument* map);

}  // namespace hb::tools
