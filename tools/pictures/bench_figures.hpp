// Error against run time as pictures of bench.csv.
#pragma once

#include <vector>

#include "hb/analysis/bench.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

// One of each rod that has rows.
[[nodiscard]] std::vector<Figure> bench_figures(const Bench& bench);

}  // namespace hb::tools
