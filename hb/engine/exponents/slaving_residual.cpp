// What the rounding left in the invariance equations does to alpha; hb/engine/README.md (E7).
#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/slaving_iteration.hpp"

namespace hb::slaving {

using Eigen::Index;
using Eigen::VectorXd;
using cplx = std::complex<double>;

namespace {

// Nothing is taken to be carried by less than this part (a choice).
constexpr double least_carried = 0.01;

// exp(sum_m z_m y^m) = sum_d c_d y^d by c_d = sum_m m z_m c_(d-m)/d; from each d on the largest, at most 1.
VectorXd carried_by(const VectorXd& phase, Index H) {
  constexpr double most = 1e100;
  VectorXd c = VectorXd::Zero(H + 1);
  c(0) = 1;
  for (Index d = 1; d < c.size(); ++d) {
    double sum = 0;
    for (Index m = 1; m <= std::min(d, phase.size()); ++m) sum += double(m) * phase(m - 1) * c(d - m);
    c(d) = std::min(sum / double(d), most);
  }
  for (Index d = c.size() - 1; d-- > 0;) c(d) = std::max(c(d), c(d + 1));
  return c.cwiseMin(1.0).cwiseMax(least_carried);
}

// For each harmonic k the largest size_l carried from k to l.
VectorXd reached(const VectorXd& size, const VectorXd& carried) {
  const Index H = size.size() - 1;
  Index far = 0;
  while (far < H && carried(far) > least_carried) ++far;
  VectorXd result = size.cwiseMax(least_carried * size.maxCoeff());
  for (Index k = 0; k <= H; ++k)
    for (Index l = std::max<Index>(0, k - far); l <= std::min(H, k + far); ++l)
      result(k) = std::max(result(k), size(l) * carried(std::abs(k - l)));
  return result;
}

}  // namespace

double Iteration::carried_change() {
  const auto spectrum = forward_.spectrum();
  const Index nm = n_ * m_;
  const FourierSeries alpha = fourier::analyse(alpha_.transpose());
  double sum = 0, squares = 0;
  VectorXd r1(H_ + 1), r2(H_ + 1), size1(H_ + 1), size2(H_ + 1);
  for (Index j = 0; j < n_; ++j) {
    const FourierSeries stiffness = fourier::analyse(K(F_[j], F_[j]).matrix().transpose());
    const double fast = std::max(std::sqrt(std::abs(stiffness.c(0, 0))), 1e-3);
    for (Index l = 0; l < m_; ++l) {
      const Index q = j + n_ * l;
      VectorXd phase = stiffness.c.row(0).tail(H_).cwiseAbs().transpose() / fast;
      for (Index s = 0; s < m_; ++s)
        phase += alpha.c.row(s + m_ * l).segment(1, H_).cwiseAbs().transpose() / weight_[std::size_t(l)];
      for (Index k = 1; k <= H_; ++k) phase(k - 1) /= double(k);
      for (Index k = 0; k <= H_; ++k) {
        const cplx ik(0, double(k));
        r1(k) = modulus(spectrum(k, 2 * nm + q) + ik * spectrum(k, q));
        r2(k) = modulus(spectrum(k, 3 * nm + q) + ik * spectrum(k, nm + q));
        const Eigen::Matrix2cd& M = inverse_[slot(j, l, k)];
        const double rate = diagonal_damping_ ? 1 : double(k) + weight_[std::size_t(l)];
        size1(k) = rate * (modulus(M(0, 0)) + weight_[std::size_t(l)] * modulus(M(1, 0)));
        size2(k) = rate * (modulus(M(0, 1)) + weight_[std::size_t(l)] * modulus(M(1, 1)));
      }
      const VectorXd carried = carried_by(phase, H_);
      const auto add = [&](const VectorXd& r, const VectorXd& size, double effect) {
        const VectorXd part = reached(size, carried) * (effect / size.maxCoeff());
        for (Index k = 0; k <= H_; ++k) {
          const double change = part(k) * r(k);
          sum += (k > 0 ? 2 : 1) * change;
          squares += (k > 0 ? 2 : 1) * change * change;
        }
      };
      add(r1, size1, effect_(0, q));
      add(r2, size2, effect_(1, q));
    }
  }
  // Rounding of harmonics is independent for the most part, what is not yet solved is not.
  return std::min(2 * sum, 4 * std::sqrt(squares) + 0.25 * sum);
}

}  // namespace hb::slaving
