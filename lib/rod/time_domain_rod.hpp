// Elastic links straight from the kinematics at any one crank angle: joint forces by one global Newton-Euler system,
// Ritz matrices as integrals over the rod's shape functions weighted by its axial force. Second route to what rod and
// joint_forces compute from Fourier series, dyads and closed forms, so that an error in either shows.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lib/linkage/linkage.hpp"
#include "lib/time_domain.hpp"

namespace hb {

// M, B, C, h of one elastic link (body number `link`) with I = num_modes terms w = sum q_i sin(i pi x/l), divided by
// EJ. With shear 2 I unknowns, q_1..q_I and p_1..p_I of the section's rotation sum p_i (i pi/l) cos(i pi x/l).
[[nodiscard]] TimeDomainSystem time_domain_rod(const Linkage& linkage, int link, Eigen::Index num_modes, double speed);

// Ritz coordinates of one elastic link at one crank angle; ' = d/dtau.
struct LinkDeflection {
  int link = 0;  // body number
  Eigen::VectorXd q, q1, q2;
};

// What joint_forces_at lists, in its order: joint ("AB.0", "O2BC.pivot", "piston.guide", "torque") and component
// ("x", "y", "n", "").
struct ForceLabel {
  std::string joint, component;
};
[[nodiscard]] std::vector<ForceLabel> force_labels(const Linkage& linkage);

// Joint forces and driving torque at one crank angle with the terms linear in the deflections (none: rigid), signs and
// frames as in joint_forces.hpp.
[[nodiscard]] Eigen::VectorXd joint_forces_at(const Linkage& linkage, double speed, double crank_angle,
                                              const std::vector<LinkDeflection>& deflections);

}  // namespace hb
