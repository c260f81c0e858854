// Deflection and bending moment of an elastic link at one place and crank angle as functions of the whole response:
// affine in q, the quasi-static tail of rod.hpp included.
#pragma once

#include "lib/rod/rod.hpp"

namespace hb {

enum class RodQuantity { deflection, bending_moment };

// The value for every q with up to the given number of harmonics: offset + mean over the turn of sum_i g_i q_i.
struct RodFunctional {
  double offset = 0;  // of the tail under what the rigid motion asks
  FourierSeries g;
};

// At x from joint 0.
[[nodiscard]] RodFunctional rod_functional(const Body& link, const RodCoefficients& rod, double speed,
                                           Eigen::Index num_modes, Eigen::Index num_harmonics, RodQuantity quantity,
                                           double x, double crank_angle);

}  // namespace hb
