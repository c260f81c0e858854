// The balance of joint_forces.hpp for inner loops: no allocation per crank angle. Used inside the library.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "lib/linkage/joint_forces.hpp"

namespace hb {

// Bodies and dyads are counted by int, their containers by std::size_t.
[[nodiscard]] inline std::size_t at(int index) { return static_cast<std::size_t>(index); }

// As the functions of the same name, into memory that is kept from one crank angle to the next; slider_forces holds
// the applied force of each dyad's slider (0 for a rocker).
void rigid_loads(const Linkage& linkage, const std::vector<BodyMotion>& motion,
                 const Eigen::Ref<const Eigen::VectorXd>& slider_forces, std::array<std::vector<BodyLoad>, 3>& loads);

// Uses up `loads`: what later dyads pass on is taken off the bodies they hang on.
void balance(const Linkage& linkage, const std::vector<BodyMotion>& motion, std::vector<BodyLoad>& loads,
             MechanismForces& forces);

// int w dx, int x w dx over an elastic link, then their first and their second derivatives over the crank angle.
using DeflectionIntegrals = Eigen::Matrix<double, 6, 1>;

// What bending feels of the motion of a rod's frame; ' = d/dtau.
struct RodMotion {
  double phi1 = 0, phi2 = 0;  // phi', phi''
  double sine = 0;  // of phi
  double along1 = 0, along2 = 0;  // z', z'' along the rod
};
[[nodiscard]] RodMotion rod_motion(const BodyMotion& motion);

// As elastic_load: force along and across the rod, moment.
[[nodiscard]] Eigen::Vector3d deflection_load(const Body& link, double gravity, const RodMotion& motion, double speed,
                                              const Eigen::Ref<const DeflectionIntegrals>& integrals);

// Of one elastic link, a column per tau_j = 2 pi j / num_samples: 6 x num_samples, DeflectionIntegrals of each; needs
// num_samples > 2 num_harmonics.
[[nodiscard]] Eigen::MatrixXd deflection_samples(const Linkage& linkage, const LinkResponse& response,
                                                 Eigen::Index num_samples);

// Applied slider forces, dyads x num_samples, at tau_j = 2 pi j / num_samples; needs num_samples > 2
// slider_force_harmonics.
[[nodiscard]] Eigen::MatrixXd slider_force_samples(const Linkage& linkage, Eigen::Index num_samples);
[[nodiscard]] Eigen::Index slider_force_harmonics(const Linkage& linkage);

}  // namespace hb
