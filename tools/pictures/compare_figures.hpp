// The pictures of `hb compare`: both sides over one another.
#pragma once

#include <vector>

#include "tools/output/compare_along.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

// q_1 of both over the turn.
[[nodiscard]] Figure compare_response_figure(const ComparedSide& a, const ComparedSide& b, const CsvFile& csv);
// A panel for each curve along what both sweeps go along.
[[nodiscard]] Figure compare_along_figure(const ComparedSide& a, const ComparedSide& b, const AlongCurves& curves);

}  // namespace hb::tools
