// The CSV files of one speed, and what is drawn of them.
#pragma once

#include <vector>

#include "hb/analysis/linkage_analysis.hpp"
#include "tools/output/machine_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/pictures/measured.hpp"

namespace hb::tools {

[[nodiscard]] std::vector<Figure> steady_files(const SceneModel& model, const SpeedResult& result,
                                               const MachineFiles& machine, OutputFolder& folder,
                                               const MeasuredOverlay& measured = {});
// What may be measured over a turn.
[[nodiscard]] std::vector<MeasuredQuantity> measured_quantities(const SceneModel& model, const SpeedResult& result);

}  // namespace hb::tools
