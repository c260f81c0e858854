// How well a dyad passes force on.
#pragma once

#include "lib/linkage/linkage.hpp"

namespace hb {

// Angle between coupler and rocker, or between coupler and the normal of the guide, folded to [0, pi/2]; smallest over
// the turn.
struct TransmissionAngle {
  double smallest = 0;  // rad
  double crank_angle = 0;  // rad
};
// Precondition: the linkage turns through (find_obstruction).
[[nodiscard]] TransmissionAngle transmission_angle(const Linkage& linkage, int dyad);

}  // namespace hb
