// One elastic link bent without stretching, at N crank angles together: arrays of Q points by N angles. With w the
// distance from the chord, x the arc length from joint 0,
//     w = sum q_i sin(i pi x/l),  w' = sin psi,  u' = cos psi - 1,  kappa = w''/cos psi,  chord c = l + u(l).
// Used inside the library.
#pragma once

#include <Eigen/Core>
#include <array>

#include "lib/exact/bent_mechanism.hpp"
#include "lib/exact/rod_quadrature.hpp"

namespace hb::exact {

using Angles = Eigen::Array<double, 1, Eigen::Dynamic>;  // one number per crank angle
using Field = Eigen::ArrayXXd;  // Q x N

// Motion of the chord's frame and axial force at every angle, as the mechanism answers them.
struct RodSurroundings {
  Eigen::Array<double, 6, Eigen::Dynamic> base;  // v_x, v_y, a_x, a_y, phi_t, phi_tt; rows as BaseMotion
  Angles axial_force;
};

// Derivatives of the rod's own residual, load and chord. Per angle (column) and state s = 0, 1, 2 for q, q_t, q_tt.
struct RodDerivatives {
  std::array<Eigen::MatrixXd, 3> residual;  // I*I x N, column-major: at fixed surroundings
  std::array<Eigen::MatrixXd, 6> by_base;  // I x N: of the residual by the rows of `base`
  Eigen::MatrixXd by_axial_force;  // I x N: of the residual by X
  std::array<std::array<Eigen::MatrixXd, 3>, 3> load;  // [F_x, F_y, moment][s], I x N, at fixed base
  // I x N: dc/dq, dc_t/dq, dc_tt/dq. The others follow: dc_t/dq_t = dc/dq, dc_tt/dq_t = 2 dc_t/dq, dc_tt/dq_tt = dc/dq.
  std::array<Eigen::MatrixXd, 3> chord;
};

class BentRod {
 public:
  using Samples = Eigen::Ref<const Eigen::MatrixXd>;  // I x N

  // q and its first two derivatives in time.
  BentRod(const RodQuadrature& rule, const RodConstants& rod, const Samples& q, const Samples& q1, const Samples& q2);

  Eigen::Index num_angles() const { return w_.cols(); }
  Chord<double> chord(Eigen::Index angle) const { return {c_(angle), c1_(angle), c2_(angle)}; }
  ShapeIntegrals shape(Eigen::Index angle) const;
  // Largest |w'| over the points and both ends; the model holds below 1.
  const Angles& steepest() const { return steepest_; }

  // r_i = int [ (f_x + i f_y) . (du/dq_i + i sin(i pi x/l)) + rho J (phi + psi)_tt dpsi/dq_i
  //             + EJ (kappa + alpha_c kappa_t) dkappa/dq_i ] dx - X du(l)/dq_i
  // times 2/(l EJ), so that at w = 0 it is linear with the M, B, C, h of rod.hpp. I x N.
  Eigen::MatrixXd residual(const RodSurroundings& at) const;

  RodDerivatives derivatives(const RodSurroundings& at) const;

  // Tension N = F_x cos psi + F_y sin psi with F = (X, Y) - int_x^l f dx, Y across the chord at joint 1; at the points
  // and, last two rows, at both ends.
  Field tension(const RodSurroundings& at, const Angles& Y) const;

 private:
  struct Loads;
  Loads loads(const RodSurroundings& at) const;
  void differentiate_residual(const RodSurroundings& at, const Loads& f, RodDerivatives& out) const;
  void differentiate_by_surroundings(const RodSurroundings& at, RodDerivatives& out) const;
  void differentiate_load(const RodSurroundings& at, const Loads& f, RodDerivatives& out) const;

  const RodQuadrature& rule_;
  const RodConstants& rod_;
  Field w_, w1_, w2_;  // w and its time derivatives
  Field a_, a1_, a2_, b_, b1_;  // w', w'_t, w'_tt; w'', w''_t
  Field k_;  // 1/cos psi
  Field g1_, g2_;  // du'/da, d^2u'/da^2: -a k, -k^3
  Field h1_, h2_;  // du'_t/da, du'_tt/da: g2 a_t, g2 a_tt + g3 a_t^2 with g3 = -3 a k^5
  Field psi2_;  // psi_tt
  Field p_, u1_, u2_;  // x + u, u_t, u_tt
  Angles c_, c1_, c2_, at_0_, at_l_, steepest_;  // w' at both ends
  Eigen::ArrayXXd integrals_;  // 15 x N, rows as ShapeIntegrals
};

}  // namespace hb::exact
