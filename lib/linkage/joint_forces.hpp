// Joint forces, ground reactions and driving torque by d'Alembert's principle, rigid and with the terms linear in the
// elastic links' deflection; paper (2.3)-(2.18). One small linear system per dyad and crank angle covers RRR and RRP,
// rigid and elastic couplers, offset centres of mass and dyads hung on any point.
#pragma once

#include <array>
#include <complex>
#include <string>
#include <vector>

#include "lib/linkage/kinematics.hpp"
#include "lib/linkage/linkage.hpp"

namespace hb {

// What a body's gravity, inertia and damping ask of its joints: the sum of the forces on it, and their moment about
// its joint 0, must equal (force, moment). Global frame.
struct BodyLoad {
  std::complex<double> force = 0;
  double moment = 0;
};

// Forces at one crank angle, global frame, complex x + i y.
struct DyadForces {
  std::complex<double> joint0;  // as passed on by the coupler to the link before it
  std::complex<double> joint1;  // acting on the coupler at joint 1
  std::complex<double> ground;  // rocker: acting on it at its pivot; slider: the guide's normal force (vector) on it
};

struct MechanismForces {
  std::vector<DyadForces> dyads;
  std::complex<double> crank_pivot;  // acting on the crank
  double torque = 0;  // driving torque on the crank
};

// Joint forces that balance given body loads (one per body, numbered as in linkage.hpp; a slider's own entry has its
// force along the guide balanced, applied force already subtracted).
[[nodiscard]] MechanismForces balance(const Linkage& linkage, const std::vector<BodyMotion>& motion,
                                      const std::vector<BodyLoad>& loads);

// Loads of the rigid-body motion in powers of Omega: [0] gravity and applied slider forces, [1] external damping,
// [2] inertia. Sum with 1, Omega, Omega^2.
[[nodiscard]] std::array<std::vector<BodyLoad>, 3> rigid_loads(const Linkage& linkage,
                                                               const std::vector<BodyMotion>& motion,
                                                               double crank_angle);

// What the deflection of one elastic link (body number `link`) adds to its load, at speed Omega: terms linear in
// q, q', q'' (' = d/dtau; Ritz coordinates of w = sum q_i sin(i pi x/l)).
//   integrals of -2 phi_t w_t - phi_tt w along x, w_tt - phi_t^2 w across, damping -c_x phi_t w and c_y w_t,
//   and of the rigid axial load density on w, third integral of (2.14).
[[nodiscard]] BodyLoad elastic_load(const Linkage& linkage, const std::vector<BodyMotion>& motion, int link,
                                    double speed, const Eigen::Ref<const Eigen::VectorXd>& q,
                                    const Eigen::Ref<const Eigen::VectorXd>& q1,
                                    const Eigen::Ref<const Eigen::VectorXd>& q2);

// Deflection of one elastic link as the solver found it.
struct LinkResponse {
  int link = 0;  // body number
  FourierSeries q;  // I components over the crank angle
};

// One joint over the turn. Key as in the JSON contract: "AB.0", "O2BC.pivot", "crank.pivot", "piston.guide".
// Components: x, y in the frame of the coupler of the joint's dyad (elastic rocker "R.0", "R.1": in the rocker's own
// frame; crank: the first dyad's coupler); a slider's guide has the single component n, along the guide's direction
// turned by +90 degrees.
struct JointForce {
  std::string name;
  FourierSeries rigid, elastic;  // 2 components (x, y), or 1 (n)
};

// What the mechanism does to its frame: shaking force x, y (global axes) and shaking moment about the crank's pivot.
// Motor and applied slider forces act against the frame too, so that the sum is gravity, inertia and external damping
// of the moving parts alone.
struct FrameForces {
  FourierSeries rigid, elastic;  // 3 components
};

struct JointForces {
  std::vector<JointForce> joints;
  FourierSeries torque_rigid, torque;  // 1 component
  FrameForces frame;
  // Estimated errors of any force component and of the torque, elastic or rigid, from sampling the turn and from
  // rounding: coefficients left out, twice, as what lies beyond the last one was folded onto those kept.
  double force_error = 0, torque_error = 0;
};

// Over the whole turn at one speed (rad per unit time); sampling doubles until the Fourier coefficients have decayed
// below `tolerance` relative to the largest (or 2^14 samples, or twice what the responses need). An empty `responses`
// gives elastic = rigid.
[[nodiscard]] JointForces joint_forces(const Linkage& linkage, double speed, const std::vector<LinkResponse>& responses,
                                       double tolerance = 1e-13);

// As above, of the linkage whose table it is, made once where many speeds are asked for (lib/linkage/influence.hpp).
class InfluenceTable;
[[nodiscard]] JointForces joint_forces(const InfluenceTable& table, double speed,
                                       const std::vector<LinkResponse>& responses, double tolerance = 1e-13);

// What the deflections alone add, in the same way: `elastic` and `torque` less the rigid ones, which are empty. Linear
// in the responses. Without errors and `frame`.
[[nodiscard]] JointForces deflection_forces(const InfluenceTable& table, double speed,
                                            const std::vector<LinkResponse>& responses, double tolerance = 1e-13);

}  // namespace hb
