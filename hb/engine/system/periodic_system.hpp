// A linear system whose mass, damping and stiffness all vary over a period,
//     M(sigma) x'' + B(sigma) x' + C(sigma) x = 0,     ' = d/dt, sigma = omega t,
// known by samples: variations of a nonlinear motion, or any system of such a kind.
#pragma once

#include <Eigen/Core>

namespace hb {

struct PeriodicSystem {
  double speed = 0;  // omega, rad per unit time: the period is 2 pi/omega
  // n*n x N, column-major: entry i + n k of column j is the element (i, k) at sigma_j = 2 pi j/N. M regular everywhere.
  Eigen::MatrixXd mass, damping, stiffness;

  Eigen::Index num_samples() const { return mass.cols(); }
  Eigen::Index num_modes() const;
};

// x'' + beta(sigma) x' + alpha(sigma) x = 0, ' = d/dsigma: alpha = M^-1 C/omega^2, beta = M^-1 B/omega.
struct NormalForm {
  Eigen::MatrixXd alpha, beta;  // n*n x N
  Eigen::Index num_modes() const;
  // sqrt |mean alpha_ii|, at least 1: what the modes' displacements are weighted with beside their velocities.
  [[nodiscard]] Eigen::VectorXd weights() const;
};

// Throws std::invalid_argument for shapes that do not fit, a speed that is not positive, or a singular mass.
[[nodiscard]] NormalForm normal_form(const PeriodicSystem& system);

// Largest deviations over the period.
struct CoefficientErrors {
  double alpha = 0;  // max |error of alpha_ik|/w_k, w the weights
  double beta = 0;
};

// Of two systems at the same angles.
[[nodiscard]] CoefficientErrors difference(const NormalForm& a, const NormalForm& b);

}  // namespace hb
