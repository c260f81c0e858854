#include "hb/engine/exponents/constant_coefficients.hpp"

#include <cmath>

#include "hb/engine/exponents/inexact_eigenvalues.hpp"
#include "lib/constants.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

TurnExponents constant_exponents(const ScaledSystem& system) {
  const Index I = system.num_modes();
  const MatrixXd K = system.mean_stiffness();
  TurnExponents result;
  const auto add = [&](cplx s, double error) {
    result.s.push_back(s);
    result.error.push_back(error);
  };
  const bool diagonal = system.diagonal_damping && (K - MatrixXd(K.diagonal().asDiagonal())).isZero(0);
  if (diagonal) {
    for (Index i = 0; i < I; ++i) {
      const double b = system.G(i, i), w2 = K(i, i), Q = w2 - b * b / 4;
      const double wrong_b = system.G_error(i, i), wrong_w2 = system.K_rounding(i, i);
      const double given = wrong_w2 + std::abs(b) / 2 * wrong_b,
                   rounding = 4 * eps * (std::abs(w2) + b * b / 2) + given;
      const double root = std::sqrt(std::abs(Q));
      const double root_error = Q == 0 && given == 0 ? 0 : std::min(rounding / (2 * root), std::sqrt(rounding));
      if (Q > 0) {
        const double bar = 2 * eps * std::abs(b) + wrong_b / 2 + root_error;
        add({-b / 2, root}, bar);
        add({-b / 2, -root}, bar);
      } else {
        // The root that nearly cancels from the product of both.
        const double far = b >= 0 ? -b / 2 - root : -b / 2 + root;
        const double near = far == 0 ? 0 : w2 / far;
        const double relative = far == 0 ? 0 : ((root_error + wrong_b / 2) / std::abs(far) + 4 * eps);
        const double pair = rounding >= -Q ? root_error : 0;
        add(near, relative * std::abs(near) + (far == 0 ? 0 : wrong_w2 / std::abs(far)) + pair);
        add(far, relative * std::abs(far) + pair);
      }
    }
    return result;
  }
  // First-order form in (W x, x'), W = diag(w), whose norm is that of the largest frequency, not of its square.
  VectorXd W(I);
  for (Index i = 0; i < I; ++i) W(i) = std::max(std::sqrt(std::abs(K(i, i))), 1e-3);
  MatrixXd A = MatrixXd::Zero(2 * I, 2 * I);
  A.topRightCorner(I, I) = W.asDiagonal();
  A.bottomLeftCorner(I, I) = -K * W.cwiseInverse().asDiagonal();
  A.bottomRightCorner(I, I) = -system.G;
  // Backward error of the eigenvalues, and of the coefficients themselves.
  const double change = 8 * eps * double(2 * I) * A.norm() +
                        (system.K_rounding * W.cwiseInverse().asDiagonal()).norm() + system.G_error.norm();
  const InexactEigenvalues s = inexact_eigenvalues(A, change);
  for (Index i = 0; i < 2 * I; ++i) add(s.value(i), s.radius(i));
  return result;
}

}  // namespace hb
