#include "hb/eigenvalue_radius.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace hb {

double eigenvalue_radius(const Eigen::MatrixXd& M, std::complex<double> mu, double change) {
  const Eigen::Index n = M.rows();
  if (n == 1) return change;
  double r = std::max(change, 1e-300);
  for (int attempt = 0; attempt < 200; ++attempt, r *= 2) {
    bool separated = true;
    for (int q = 0; q < 8 && separated; ++q) {
      const std::complex<double> z = mu + r * std::polar(1.0, std::numbers::pi / 4 * (q + 0.5));
      const Eigen::MatrixXcd shifted = z * Eigen::MatrixXcd::Identity(n, n) - M.cast<std::complex<double>>();
      // 1/sigma_min <= |shifted^-1| (Frobenius).
      separated = 2 * change * shifted.inverse().norm() < 1;
    }
    if (separated) return r;
  }
  return HUGE_VAL;
}

}  // namespace hb
