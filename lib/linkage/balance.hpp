// The balance of joint_forces.hpp for inner loops: no allocation per crank angle. Used inside the library.
#pragma once

#include <Eigen/Core>
#include <array>
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

// What an elastic link's load depends on of its motion; ' = d/dtau. Here and below at one crank angle or, with several
// numbers in a Value, at these side by side.
template <class Value>
struct RodMotion {
  Value phi1, phi2;  // phi', phi''
  Value e_y;  // sin phi
  Value v_x, a_x;  // of joint 0 along the rod, z' and z''
};
[[nodiscard]] RodMotion<double> rod_motion(const BodyMotion& motion);

// int w dx, int x w dx over an elastic link, then their first and their second derivatives over the crank angle.
template <class Value>
using DeflectionIntegrals = std::array<Value, 6>;

// In the rod's frame; the moment is about joint 0.
template <class Value>
struct RodLoad {
  Value along, across, moment;
};

// What the deflection adds to the load of an elastic link, at speed Omega:
//     along  = mu (-2 phi_t w_t - phi_tt w) - c_x phi_t w,      across = mu (w_tt - phi_t^2 w) + c_y w_t,
//     moment = x across - p_x w,      p_x = mu (g sin phi + a0x - phi_t^2 x) + c_x v0x,
// each integrated along the rod: p_x is the rigid axial density; the rotary inertia of w integrates to
// rho J [w_tt]_0^l = 0.
template <class Value>
[[nodiscard]] RodLoad<Value> deflection_load(const Body& rod, double gravity, double speed,
                                             const RodMotion<Value>& motion, const DeflectionIntegrals<Value>& at) {
  const double mu = rod.mass / rod.length, square = speed * speed;
  const double c_x = rod.elastic->damping_x * speed, c_y = rod.elastic->damping_y * speed;
  const auto& [phi1, phi2, e_y, v_x, a_x] = motion;
  const auto& [w, xw, w1, xw1, w2, xw2] = at;
  return {-mu * square * (2 * phi1 * w1 + phi2 * w) - c_x * phi1 * w, mu * square * (w2 - phi1 * phi1 * w) + c_y * w1,
          mu * square * xw2 + c_y * xw1 - (mu * (gravity * e_y + square * a_x) + c_x * v_x) * w};
}

// The integrals of one elastic link, 6 x num_samples at tau_j = 2 pi j / num_samples; needs
// num_samples > 2 num_harmonics.
[[nodiscard]] Eigen::MatrixXd deflection_samples(const Linkage& linkage, const LinkResponse& response,
                                                 Eigen::Index num_samples);

// Applied slider forces, dyads x num_samples, at tau_j = 2 pi j / num_samples; needs
// num_samples > 2 slider_force_harmonics.
[[nodiscard]] Eigen::MatrixXd slider_force_samples(const Linkage& linkage, Eigen::Index num_samples);
[[nodiscard]] Eigen::Index slider_force_harmonics(const Linkage& linkage);

}  // namespace hb
