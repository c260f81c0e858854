// How far a rod is bent when the machine stands still.
#pragma once

#include <optional>

#include "lib/rod/rod.hpp"

namespace hb {

struct StaticDeflection {
  RodPeak peak;  // largest |w| over the rod and all crank angles
  double error = 0;  // of it, from the modes left out: an estimate
};

// The mechanism at rest under gravity and applied forces, the crank held; num_modes Ritz terms and the tail of the
// others. Empty where the rod would buckle at some angle.
[[nodiscard]] std::optional<StaticDeflection> static_deflection(const Body& link, const RodCoefficients& rod,
                                                                Eigen::Index num_modes);

}  // namespace hb
