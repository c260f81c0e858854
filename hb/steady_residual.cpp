#include "hb/steady_residual.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace hb::steady {

namespace {

using Index = Eigen::Index;
using Real = long double;
struct Complex {
  Real re = 0, im = 0;
};

// S0 + Omega S1 + Omega^2 S2 in extended precision, component-major: entry(component, k) at component + n k.
std::vector<Complex> combined(const std::array<FourierSeries, 3>& powers, Index n, Index H, double speed) {
  std::vector<Complex> sum(static_cast<std::size_t>(n * (H + 1)));
  Real factor = 1;
  for (const FourierSeries& part : powers) {
    for (Index k = 0; k < part.c.cols(); ++k)
      for (Index i = 0; i < n; ++i) {
        Complex& entry = sum[static_cast<std::size_t>(i + n * k)];
        entry.re += factor * part.c(i, k).real();
        entry.im += factor * part.c(i, k).imag();
      }
    factor *= speed;
  }
  return sum;
}

Index longest(const std::array<FourierSeries, 3>& powers) {
  Index H = 0;
  for (const FourierSeries& part : powers) H = std::max(H, part.num_harmonics());
  return H;
}

}  // namespace

AccurateResidual accurate_residual(const HillSystem& system, double speed, const FourierSeries& q, double scale) {
  const Index I = system.num_modes(), H = q.num_harmonics();
  const Index P = longest(system.stiffness), F = longest(system.load);
  const Index rows = std::max(H + P, F);
  const std::vector<Complex> C = combined(system.stiffness, I * I, P, speed);
  const std::vector<Complex> h = combined(system.load, I, F, speed);
  const Real Omega = speed, eps = std::numeric_limits<Real>::epsilon();

  // Largest |c_ij| at harmonic m and largest |q_j| at k: products too small to matter are skipped.
  std::vector<double> q_size(static_cast<std::size_t>(H + 1));
  for (Index k = 0; k <= H; ++k) q_size[static_cast<std::size_t>(k)] = q.c.col(k).cwiseAbs().maxCoeff();

  AccurateResidual result{Eigen::MatrixXcd(rows + 1, I), Eigen::MatrixXd(rows + 1, I)};
  std::vector<Complex> sum(static_cast<std::size_t>(I));
  std::vector<Real> size(static_cast<std::size_t>(I));
  for (Index k = 0; k <= rows; ++k) {
    for (Index i = 0; i < I; ++i) {
      sum[static_cast<std::size_t>(i)] = k <= F ? h[static_cast<std::size_t>(i + I * k)] : Complex{};
      const Complex& start = sum[static_cast<std::size_t>(i)];
      size[static_cast<std::size_t>(i)] = std::abs(start.re) + std::abs(start.im);
    }
    if (k <= H) {
      const Real n = static_cast<Real>(k) * Omega;
      for (Index j = 0; j < I; ++j) {
        const Real re = q.c(j, k).real(), im = q.c(j, k).imag();
        for (Index i = 0; i < I; ++i) {
          // -(n i)^2 M q - n i B q
          const Real m = n * n * system.mass(i, j), b = n * system.damping(i, j);
          Complex& s = sum[static_cast<std::size_t>(i)];
          s.re += m * re + b * im;
          s.im += m * im - b * re;
          size[static_cast<std::size_t>(i)] += (std::abs(m) + std::abs(b)) * (std::abs(re) + std::abs(im));
        }
      }
    }
    for (Index l = std::max(-H, k - P); l <= std::min(H, k + P); ++l) {
      const Index m = k - l;
      if (q_size[static_cast<std::size_t>(std::abs(l))] == 0) continue;
      const Real side_c = m < 0 ? -1 : 1, side_q = l < 0 ? -1 : 1;
      const Complex* matrix = &C[static_cast<std::size_t>(I * I * std::abs(m))];
      for (Index j = 0; j < I; ++j) {
        const Real re = q.c(j, std::abs(l)).real(), im = side_q * q.c(j, std::abs(l)).imag();
        for (Index i = 0; i < I; ++i) {
          const Complex& c = matrix[i + I * j];
          const Real c_im = side_c * c.im;
          Complex& s = sum[static_cast<std::size_t>(i)];
          s.re -= c.re * re - c_im * im;
          s.im -= c.re * im + c_im * re;
          size[static_cast<std::size_t>(i)] += (std::abs(c.re) + std::abs(c.im)) * (std::abs(re) + std::abs(im));
        }
      }
    }
    for (Index i = 0; i < I; ++i) {
      const Complex& s = sum[static_cast<std::size_t>(i)];
      const Real inverse = 1 / static_cast<Real>(scale);
      result.r(k, i) = {static_cast<double>(s.re * inverse), static_cast<double>(s.im * inverse)};
      result.rounding(k, i) = static_cast<double>(8 * eps * size[static_cast<std::size_t>(i)] * inverse);
    }
  }
  return result;
}

}  // namespace hb::steady
