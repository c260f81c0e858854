// CSV files and pictures of hb check: both curves of every rod and their difference at one speed, the differences over
// a range.
#pragma once

#include <vector>

#include "hb/analysis/cross_check.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

// Writes the tables into the folder without committing it; the pictures that there are of them.
[[nodiscard]] std::vector<Figure> write_check_tables(const SceneModel& model, const std::vector<SpeedCheck>& checks,
                                                     OutputFolder& folder);

}  // namespace hb::tools
