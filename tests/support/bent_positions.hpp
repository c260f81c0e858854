// An independent model of a mechanism with bent rods, for tests only. It knows where every point is and nothing else:
// velocities are differences in time of places, forces are differences of an action.
#pragma once

#include <vector>

#include "lib/linkage/joint_forces.hpp"
#include "lib/linkage/linkage.hpp"

namespace hb::bent_positions {

// Mean power over the turn (work per turn / period) that the equations of motion of this motion q of all rods, which
// need not solve them, leave over for a variation: minus the derivative of Hamilton's action and of what dampers and
// slider forces do, in the direction `variation` (coordinates of one rod).
[[nodiscard]] double residual_work(const Linkage& linkage, double speed, const std::vector<LinkResponse>& motion,
                                   const LinkResponse& variation);

// Mean over the turn of the power that dampers, internal and external, take from the motion.
[[nodiscard]] double lost_power(const Linkage& linkage, double speed, const std::vector<LinkResponse>& motion);

// Mean over the turn of the power that the slider forces give.
[[nodiscard]] double slider_power(const Linkage& linkage, double speed, const std::vector<LinkResponse>& motion);

}  // namespace hb::bent_positions
