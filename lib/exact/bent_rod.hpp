// One elastic link bent without stretching, at one crank angle in each lane. With w the distance from the chord, x the
// arc length from joint 0,
//     w = sum q_i sin(i pi x/l),  w' = sin psi,  u' = cos psi - 1,  kappa = w''/cos psi,  chord c = l + u(l).
// Used inside the library.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "lib/exact/bent_mechanism.hpp"
#include "lib/exact/rod_quadrature.hpp"

namespace hb::exact {

// Derivatives of the rod's own residual, load and chord. By state s = 0, 1, 2: q_j, q_j_t, q_j_tt.
struct RodDerivatives {
  struct Mode {
    std::array<Lanes, 3> F_x, F_y, moment;  // of the load by [s], at fixed base
    // By q_j alone. The others follow: dc_t/dq_t = dc/dq, dc_tt/dq_t = 2 dc_t/dq, dc_tt/dq_tt = dc/dq.
    Chord<Lanes> chord;
    std::array<Lanes, 6> by_base;  // of r_j, in the order of BaseMotion
    Lanes by_axial_force;  // of r_j by X
  };
  std::vector<Mode> modes;
  std::vector<std::array<Lanes, 3>> residual;  // of r_i by [s] at i + I j, at fixed base and X
};

// Scratch is kept from one block of angles to the next.
class BentRod {
 public:
  using Samples = Eigen::Ref<const Eigen::MatrixXd>;  // I x N

  // Both stay where they are.
  BentRod(const RodQuadrature& rule, const RodConstants& rod);

  // By q and its first two derivatives in time, at the angles from `first`; beyond the last one that one again.
  void bend(const Samples& q, const Samples& q1, const Samples& q2, Eigen::Index first);

  const Chord<Lanes>& chord() const { return chord_; }
  const ShapeIntegrals& shape() const { return shape_; }
  // Largest |w'| over the points and both ends; the model holds below 1.
  const Lanes& steepest() const { return steepest_; }

  // What the mechanism answers, the motion of the chord's frame and the axial force on the rod at joint 1: all that
  // follows is at these.
  void surround(const BaseMotion<Lanes>& base, const Lanes& axial_force);

  // r_i = int [ (f_x + i f_y) . (du/dq_i + i sin(i pi x/l)) + rho J (phi + psi)_tt dpsi/dq_i
  //             + EJ (kappa + alpha_c kappa_t) dkappa/dq_i ] dx - X du(l)/dq_i
  // times 2/(l EJ), so that at w = 0 it is linear with the M, B, C, h of rod.hpp.
  const std::vector<Lanes>& residual();

  void differentiate();
  const RodDerivatives& derivatives() const { return derivatives_; }  // of the last differentiate()

  // Tension N = F_x cos psi + F_y sin psi with F = (X, Y) - int_x^l f dx, Y across the chord at joint 1; at the points
  // and, last two, at both ends.
  std::vector<Lanes> tension(const Lanes& Y) const;

 private:
  // u, or another number, with its first two derivatives in time.
  struct Along {
    Lanes u, u1, u2;
  };
  struct Point {
    Lanes w, w1, w2;  // w and its time derivatives
    Lanes a, a1, a2, b, b1;  // w', w'_t, w'_tt; w'', w''_t
    Lanes k;  // 1/cos psi
    Lanes g1, g2;  // du'/da, d^2u'/da^2: -a k, -k^3
    Lanes h1, h2;  // du'_t/da, du'_tt/da: g2 a_t, g2 a_tt + g3 a_t^2 with g3 = -3 a k^5
    Lanes psi2;  // psi_tt
  };
  // Load per length, and what it and X make of the slopes. Since du/dq_i = integral (g1 s_i'), int f_x du/dq_i dx -
  // X du(l)/dq_i is the sum over the points of g1 s_i' times
  //     axial = integral' (W f_x) - X W            (minus the weighted axial force that the load leaves at x)
  // and the moment EJ (kappa + alpha_c kappa_t) =: m works on dkappa/dq_i = k s_i'' + K_a s_i'.
  struct Load {
    Lanes f_x, f_y, axial, m;  // f without weights, m with them
    Lanes rotary;  // W rho J (phi + psi)_tt
    Lanes K_a;  // dkappa/da = a w'' k^3
  };
  // What q_j does at a point: to u (du/dq, du_t/dq, du_tt/dq), to the weighted load by [s], to kappa and m.
  struct Variation {
    Along du;
    std::array<Lanes, 3> f_x, f_y;
    Lanes kappa, m;
  };
  // Further derivatives by a at a point.
  struct Further {
    Lanes K_ab, K_aa;  // d^2 kappa/da db = dk/da = a k^3, d^2 kappa/da^2 = b d^3 psi/da^3
    Lanes psi2_a, psi2_a1;  // d psi_tt/da, d psi_tt/da_t
  };
  // The motion of the chord's frame as the load knows it.
  struct Rates {
    Lanes turn_x, turn_y, coriolis, centrifugal;  // mu phi_tt + c_x phi_t, with c_y; 2 mu phi_t, mu phi_t^2
  };

  void integrate_shape();
  void integrate(const std::vector<Along>& derivative, Eigen::Index columns, std::vector<Along>& result) const;
  void vary(Eigen::Index k);
  void add_residual(Eigen::Index k);
  void add_surroundings(Eigen::Index k);
  void add_load(Eigen::Index k);

  const RodQuadrature& rule_;
  const RodConstants& rod_;
  std::vector<Along> q_;  // q_i with its derivatives in time
  std::vector<Point> points_;
  std::vector<Along> slopes_, u_;  // u' and u at the points
  Chord<Lanes> chord_;
  ShapeIntegrals shape_;
  Lanes at_0_, at_l_, steepest_;  // w' at both ends
  BaseMotion<Lanes> base_;
  Lanes axial_force_;
  Rates rates_;
  std::vector<Load> loads_;
  std::vector<Lanes> residual_;
  std::vector<Along> dslope_, du_;  // by q_j, of point k at j + I k
  std::vector<Variation> variation_;  // at the point in hand
  Further further_;
  RodDerivatives derivatives_;
};

}  // namespace hb::exact
