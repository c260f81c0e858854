// Values of a stability map of one mode from the surface of its discriminant.
#pragma once

#include <cstddef>
#include <vector>

#include "hb/engine/boundaries/discriminant_surface.hpp"
#include "hb/engine/boundaries/stability_map.hpp"

namespace hb {

// At the places (x_i, y_j), x fastest. Those whose verdict or growth rate the surface does not settle are missing, and
// their numbers are put into `open`. `tolerance`: of StabilityOptions, for what is called converged. `for_each`: who
// does some rows of the grid.
[[nodiscard]] std::vector<MapPoint> surface_grid(const DiscriminantSurface& surface, const std::vector<double>& x,
                                                 const std::vector<double>& y, double tolerance,
                                                 const ForEach& for_each, std::vector<std::size_t>& open);

// At one place; missing where it is not settled.
[[nodiscard]] MapPoint surface_point(const DiscriminantSurface& surface, double x, double y, double tolerance);

}  // namespace hb
