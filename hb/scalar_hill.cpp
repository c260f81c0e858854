#include "hb/scalar_hill.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

using Eigen::ArrayXd;
using Eigen::Index;

constexpr double eps = 2.220446049250313e-16;

ArrayXd sampled(const FourierSeries& series, Index N) {
  return fourier::synthesise(series, N).row(0).transpose().array();
}

// Harmonics up to the last one above rounding; what is cut away is added to `error`.
FourierSeries above_rounding(const FourierSeries& series, double& error) {
  const Index H = fourier::significant_harmonics(series, 2 * eps);
  error += 2 * series.c.rightCols(series.num_harmonics() - H).cwiseAbs().sum();
  return fourier::resized(series, H);
}

// Samples of L' and L'' of the trigonometric interpolant of L.
struct Derivatives {
  ArrayXd first, second;
  double tail;  // of the last quarter of the harmonics of L'': what sampling has lost
};

Derivatives differentiated(const ArrayXd& L) {
  const FourierSeries series = fourier::analyse(L.matrix().transpose());
  const FourierSeries first = fourier::derivative(series), second = fourier::derivative(series, 2);
  const Index H = series.num_harmonics(), count = std::max<Index>(1, H / 4);
  return {sampled(first, L.size()), sampled(second, L.size()), 2 * second.c.rightCols(count).cwiseAbs().sum()};
}

}  // namespace

std::optional<ExponentPair> phase_exponents(const FourierSeries& given_alpha, const FourierSeries& given_beta,
                                            double alpha_error, double beta_error, double tolerance) {
  const FourierSeries alpha = above_rounding(given_alpha, alpha_error), beta = above_rounding(given_beta, beta_error);
  const Index start = fourier::fast_length(4 * std::max({alpha.num_harmonics(), beta.num_harmonics(), Index(8)}) + 4);
  for (Index N = start; N <= 4 * start; N *= 2) {
    const ArrayXd a = sampled(alpha, N), b = sampled(beta, N), b1 = sampled(fourier::derivative(beta), N);
    const ArrayXd Q = a - b.square() / 4 - b1 / 2;
    // sigma = +1: oscillating, psi real; sigma = -1: overdamped, psi = -i chi with chi real.
    const double sigma = Q.minCoeff() > 0 ? 1 : -1;
    if (!((sigma * Q).minCoeff() > 0)) return std::nullopt;

    ArrayXd psi2 = sigma * Q, correction(N);
    double left = HUGE_VAL, tail = 0;
    for (int iteration = 0; iteration < 40; ++iteration) {
      // With L = ln psi: -psi''/(2 psi) + 3/4 (psi'/psi)^2 = -L''/2 + L'^2/4.
      const Derivatives L = differentiated(0.5 * psi2.log());
      correction = -0.5 * L.second + 0.25 * L.first.square();
      const ArrayXd next = sigma * (Q + correction);
      if (!next.allFinite() || !(next.minCoeff() > 0)) return std::nullopt;
      const double change = (next - psi2).abs().maxCoeff();
      if (!(change < 0.7 * left)) break;  // rounding reached, or an asymptotic expansion at its best
      left = change;
      tail = L.tail;
      psi2 = next;
    }
    const ArrayXd psi = psi2.sqrt();
    const double floor = 2 * psi.minCoeff();
    // dQ: what the iteration left, what sampling lost, rounding of psi^2 itself.
    const double dQ = 2 * left + tail;
    const double largest_b = b.abs().maxCoeff();
    ExponentPair pair;
    if (sigma > 0) {
      const double error =
          (dQ + alpha_error + beta_error * (largest_b + psi.maxCoeff()) + 8 * eps * a.abs().maxCoeff()) / floor +
          beta_error + 4 * eps * (psi.maxCoeff() + largest_b);
      pair.s = {std::complex<double>(-b.mean() / 2, psi.mean()), std::complex<double>(-b.mean() / 2, -psi.mean())};
      pair.error = {error, error};
    } else {
      // r = -beta/2 +- chi - chi'/(2 chi); of the two the one that nearly cancels is
      // chi - |beta|/2 = (chi^2 - beta^2/4)/(chi + |beta|/2) with chi^2 - beta^2/4 = -alpha + beta'/2 - correction.
      const ArrayXd near = (-a + b1 / 2 - correction) / (psi + b.abs() / 2);
      const double sign = b.mean() >= 0 ? 1 : -1;
      const double slow = sign > 0 ? near.mean() : -near.mean(), fast = -b.mean() - slow;
      if (b.minCoeff() * sign < 0) {  // |beta| is not smooth: no cancellation to avoid either
        const double up = -b.mean() / 2 + psi.mean(), down = -b.mean() / 2 - psi.mean();
        pair.s = {up, down};
        const double error = (dQ + alpha_error + beta_error * (largest_b + psi.maxCoeff())) / floor + beta_error +
                             8 * eps * (psi.maxCoeff() + largest_b);
        pair.error = {error, error};
      } else {
        // Residual of the slow root's own Riccati equation r' + r^2 + beta r + alpha: relative to alpha, not to beta^2.
        const double reach = std::abs(slow) + near.abs().maxCoeff();
        const double relative = (dQ + 8 * eps * psi2.maxCoeff()) / psi2.minCoeff();
        const double slow_error = relative * (near.abs().maxCoeff() + tail / floor) +
                                  (alpha_error + beta_error * reach) / floor + 8 * eps * reach;
        const double fast_error = (dQ + alpha_error + beta_error * (largest_b + psi.maxCoeff())) / floor + beta_error +
                                  8 * eps * (psi.maxCoeff() + largest_b);
        pair.s = {slow, fast};
        pair.error = {slow_error, fast_error};
        if (slow < fast) {
          std::swap(pair.s[0], pair.s[1]);
          std::swap(pair.error[0], pair.error[1]);
        }
      }
    }
    if (std::isfinite(pair.error[0]) && pair.error[0] <= tolerance && std::isfinite(pair.error[1])) return pair;
    if (!(tail > left)) return std::nullopt;  // a finer grid helps only against lost harmonics
  }
  return std::nullopt;
}

}  // namespace hb
