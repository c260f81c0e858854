// How answers move with what is not known well, as shaded bands.
#pragma once

#include "tools/output/sweep_bands.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {

// A panel for each quantity, along a sweep or (`turn`) over the crank angle.
[[nodiscard]] Figure band_figure(const Scene& scene, const BandCurves& curves, bool turn);

}  // namespace hb::tools
