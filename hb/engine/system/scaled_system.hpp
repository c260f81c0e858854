// The system at one speed in the coordinates that the solvers work in: mass-normalised, time measured in crank angle,
//     x'' + G x' + K(tau) x = f(tau),      ' = d/dtau,   q = T x.
#pragma once

#include <Eigen/Core>

#include "hb/engine/system/modulation.hpp"
#include "lib/hill_system.hpp"

namespace hb {

struct ScaledSystem {
  double speed = 0;  // Omega, rad per unit time
  Eigen::MatrixXd T;  // q = T x
  Eigen::MatrixXd T_inverse;  // x = T_inverse q
  Eigen::MatrixXd G;  // T^-1 M^-1 B T / Omega
  FourierSeries K;  // T^-1 M^-1 C T / Omega^2: I*I components column-major; harmonics below rounding cut
  Modulation modulation;  // of K; empty of one mode and of parts of a system. Who changes K empties it
  Eigen::MatrixXd K_rounding;  // bound on the rounding error of K, entry by entry: sum over all harmonics of |error|
  Eigen::VectorXd f_rounding;  // the same of f
  Eigen::MatrixXd G_error;  // bound on what G is given wrong by, beside rounding
  FourierSeries f;  // T^-1 M^-1 h / (Omega^2 load_scale): I components, largest |coefficient| about 1
  double load_scale = 0;  // 0: no load; then f is empty
  bool diagonal_damping = true;
  // Per mode: in its rows and columns M and C are symmetric at all angles and B = -B^T, exactly, as given.
  Eigen::Array<bool, Eigen::Dynamic, 1> conservative;

  Eigen::Index num_modes() const { return G.rows(); }
  // Mean of K, an I x I matrix, and its diagonal w_i^2; diagonal b_i of G.
  Eigen::MatrixXd mean_stiffness() const;
  Eigen::VectorXd mean_diagonal() const;
  // (omega_i/Omega)^2 of the undamped system averaged over the turn, ascending: the eigenvalues of the mean stiffness,
  // of complex ones the real part.
  Eigen::VectorXd squared_frequencies() const;
  Eigen::VectorXd damping_diagonal() const { return G.diagonal(); }
};

// Bounds on what B and C are given wrong by, entry by entry, of C the sum over all harmonics. Empty: nothing.
struct GivenErrors {
  Eigen::MatrixXd damping, stiffness;  // I x I, those of C at the speed
};

// Symmetric M (positive definite): T = M^-1/2 (diagonal when M is), turned to the eigenvectors of the mean stiffness
// if that leaves far less coupling in stiffness and damping. Otherwise T = 1 with M^-1 multiplied from the left.
// Throws std::invalid_argument if the speed is not positive and finite.
[[nodiscard]] ScaledSystem scale_system(const HillSystem& system, double speed, const GivenErrors& given = {});
// The same without the load, bounds and `conservative`.
[[nodiscard]] ScaledSystem scale_unloaded(const HillSystem& system, double speed);
// ScaledSystem::squared_frequencies of it, from the mean stiffness alone.
[[nodiscard]] Eigen::VectorXd squared_frequencies(const HillSystem& system, double speed);

}  // namespace hb
