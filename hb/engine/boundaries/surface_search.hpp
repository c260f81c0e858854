// Where the verdict changes along lines of a map of one mode, from the surface of its discriminant: which places there
// are is told by bounds on polynomials, where they are by the system itself. hb/engine/README.md, "One mode".
#pragma once

#include <optional>
#include <vector>

#include "hb/engine/boundaries/boundary.hpp"
#include "hb/engine/boundaries/discriminant_surface.hpp"

namespace hb {

// y = fixed for x from `low` to `high`, or x and y the other way round.
struct MapLine {
  bool along_x = true;
  double fixed = 0, low = 0, high = 0;
};

// A zero of the interpolated distance h = +-Delta - L.
struct SurfaceZero {
  double place = 0;
  double slope = 0;  // of h
  double error = 0;  // of h
  bool positive = true;  // the sign of Delta
};

// All zeros on the line, ascending; empty where the surface's error leaves open how many there are, (D6).
[[nodiscard]] std::optional<std::vector<SurfaceZero>> surface_zeros(const DiscriminantSurface& surface,
                                                                    const MapLine& line);

// The boundary at a zero, between places where the system itself shows either sign of h; empty where it does not,
// (D7).
[[nodiscard]] std::optional<StabilityBoundary> boundary_at(const DiscriminantSurface& surface, const SystemAt& along,
                                                           const MapLine& line, const SurfaceZero& zero,
                                                           double tolerance);

// Whether the verdict may change inside the box by more than the least growth that maps look for off their lines, (D8).
[[nodiscard]] bool verdict_may_change(const DiscriminantSurface& surface, const ParameterBox& box);

}  // namespace hb
