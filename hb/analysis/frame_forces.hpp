// What the mechanism does to its frame: shaking force and shaking moment. Motor and applied slider forces act against
// the frame too, so that the sum is gravity, inertia and external damping of the moving parts alone.
#pragma once

#include <vector>

#include "lib/linkage/joint_forces.hpp"

namespace hb {

// On the frame, over the crank angle. Components: force x, force y (global axes), moment about the crank's pivot.
struct FrameForces {
  FourierSeries rigid, elastic;
};

// At one speed (rad per unit time); an empty `responses` gives elastic = rigid.
[[nodiscard]] FrameForces frame_forces(const Linkage& linkage, double speed,
                                       const std::vector<LinkResponse>& responses);

}  // namespace hb
