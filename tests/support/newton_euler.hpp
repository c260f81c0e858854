// An independent model of the same mechanism, for tests only. It knows positions and nothing else: velocities and
// accelerations are high-order differences of positions, forces come from one Newton-Euler system of all bodies at
// once, and every integral along a rod is a quadrature. Long double throughout; good to about 1e-12 relative for
// functions of up to 300 harmonics.
#pragma once

#include <complex>
#include <map>
#include <string>
#include <vector>

#include "lib/linkage/joint_forces.hpp"
#include "lib/linkage/kinematics.hpp"
#include "lib/linkage/linkage.hpp"

namespace hb::newton_euler {

// Smallest |sin| over the dyads of the angle between coupler and rocker (coupler and guide's normal); NaN where the
// linkage does not close.
[[nodiscard]] double closing_margin(const Linkage& linkage, double crank_angle);

// Place of a point of a body, given in the body's frame.
[[nodiscard]] std::complex<double> place(const Linkage& linkage, double crank_angle, int body,
                                         std::complex<double> point);

// All bodies, numbered as in linkage.hpp.
[[nodiscard]] std::vector<BodyMotion> motion(const Linkage& linkage, double crank_angle);

// Joint forces and torque at `speed` (rad per unit time): rigid, with the terms linear in the given deflections added.
[[nodiscard]] MechanismForces forces(const Linkage& linkage, double crank_angle, double speed,
                                     const std::vector<LinkResponse>& responses = {});

// The JSON contract's components of all joints: x, y in the coupler's frame (elastic rockers: their own), n of guides.
[[nodiscard]] std::map<std::string, std::vector<double>> joint_components(const Linkage& linkage, double crank_angle,
                                                                          const MechanismForces& forces);

// Power that friction in the surroundings takes from the rigid motion, less what the slider forces give.
[[nodiscard]] double lost_power(const Linkage& linkage, double crank_angle, double speed);

// M q'' + B q' + C q = h of one elastic link at one crank angle (' = d/dt), divided by EJ: weak form of (3.3).
struct Ritz {
  Eigen::MatrixXd mass, damping, stiffness;  // I x I
  Eigen::VectorXd load;  // I
};
[[nodiscard]] Ritz ritz(const Linkage& linkage, int link, double crank_angle, double speed, Eigen::Index num_modes);

// Periodic solution by Fourier collocation on 2H+1 crank angles, dense LU.
[[nodiscard]] FourierSeries steady_state(const Linkage& linkage, int link, double speed, Eigen::Index num_modes,
                                         Eigen::Index num_harmonics);

}  // namespace hb::newton_euler
