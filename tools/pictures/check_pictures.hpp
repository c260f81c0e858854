// CSV files and pictures of hb check: both curves of every rod and their difference at one speed, the differences over
// a range.
#pragma once

#include <vector>

#include "hb/analysis/cross_check.hpp"
#include "tools/output/output_folder.hpp"

namespace hb::tools {

// Writes into the folder without committing it; pictures only if `draw`.
void write_check_pictures(const SceneModel& model, const std::vector<SpeedCheck>& checks, OutputFolder& folder,
                          bool draw);

}  // namespace hb::tools
