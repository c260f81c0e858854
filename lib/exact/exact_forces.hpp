// Joint forces and driving torque of the exact model over the turn, listed as in joint_forces.hpp.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "lib/exact/exact_model.hpp"

namespace hb {

// Rows: the components of all joints in the order of JointForces::joints (x, y in the frame of the bent coupler's
// chord, n of a guide), then the torque; a column per crank angle.
struct ForceSamples {
  Eigen::MatrixXd values;
  // What the mechanism does to its frame, joints, motor and applied slider forces together: force x, y (global axes),
  // moment about the crank's pivot.
  Eigen::Matrix3Xd frame;
  Eigen::MatrixXd sliders;  // distance of each slider from its guide's point along its direction, in the dyads' order
  std::optional<ExactBreakdown> breakdown;
};

[[nodiscard]] ForceSamples exact_forces(const ExactModel& model, double speed, const CrankAngles& angles,
                                        const RitzSamples& motion);

// The elastic part of linear forces, rows as above.
[[nodiscard]] Eigen::MatrixXd force_samples(const JointForces& forces, Eigen::Index num_samples);

}  // namespace hb
