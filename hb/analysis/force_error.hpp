// How accurate joint forces and driving torque are: by comparison with the forces of better responses.
#pragma once

#include <vector>

#include "lib/linkage/joint_forces.hpp"

namespace hb {

// Estimated errors of joint forces (any component at any joint) and of the driving torque, relative to the largest of
// each over the turn.
struct ForceErrors {
  double force = 0, torque = 0;  // for the modes kept: sampling of the turn, harmonics of the response, rounding
  double force_cut = 0, torque_cut = 0;  // from cutting the Ritz series
};

// Largest value over the turn of any component of any joint force, and of the torque.
struct LargestForces {
  double force = 0, torque = 0;
};
[[nodiscard]] LargestForces largest_of(const JointForces& forces);

// `largest` of `forces`, which belong to `responses`, whose relative error is `response_error`; `more_harmonics` and
// `more_modes` are better ones of the same rods; without the former the error of q is taken to stand in
// harmonics beyond it, without the latter their part is left out.
[[nodiscard]] ForceErrors force_errors(const InfluenceTable& influence, double speed, const JointForces& forces,
                                       const LargestForces& largest, double response_error,
                                       const std::vector<LinkResponse>& responses,
                                       const std::vector<LinkResponse>& more_harmonics,
                                       const std::vector<LinkResponse>& more_modes);

}  // namespace hb
