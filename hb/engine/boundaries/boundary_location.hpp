// Where the verdict changes, with what was computed on the way.
#pragma once

#include <array>
#include <optional>

#include "hb/engine/boundaries/boundary.hpp"

namespace hb {

struct BoundaryLocation {
  StabilityBoundary boundary;
  // Nearest places computed at which the growth rate is certain, or the verdict that disturbances stay bounded.
  std::optional<StabilitySample> below, above;
};

// As locate_boundary. `expected`: two places, ascending, between which the boundary should be.
[[nodiscard]] BoundaryLocation locate(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                                      const SweepOptions& options, std::optional<std::array<double, 2>> expected);

}  // namespace hb
