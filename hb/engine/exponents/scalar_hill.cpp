#include "hb/engine/exponents/scalar_hill.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <initializer_list>

#include "lib/constants.hpp"

namespace hb {

namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using cplx = std::complex<double>;

// One function and how often it is differentiated.
struct Derivative {
  const FourierSeries& series;
  int order;
};

// At N nodes, a column each.
Eigen::ArrayXXd sampled(std::initializer_list<Derivative> functions, Index N) {
  fourier::RealTransform& transform = fourier::thread_transform(N, Index(functions.size()));
  auto spectrum = transform.spectrum();
  Index column = 0;
  for (const Derivative& f : functions) {
    auto to = spectrum.col(column++);
    const Index H = f.series.num_harmonics();
    to.tail(to.size() - H - 1).setZero();
    for (Index k = 0; k <= H; ++k) {
      const double n = double(k), x = f.series.c(0, k).real(), y = f.series.c(0, k).imag();
      to(k) = f.order == 0 ? cplx(x, y) : f.order == 1 ? cplx(-n * y, n * x) : cplx(-n * n * x, -n * n * y);
    }
  }
  transform.backward();
  return transform.samples().array();
}

// Harmonics up to the last one above rounding; what is cut away is added to `error`.
FourierSeries above_rounding(const FourierSeries& series, double& error) {
  const Index H = fourier::significant_harmonics(series, 2 * eps);
  error += 2 * series.c.rightCols(series.num_harmonics() - H).cwiseAbs().sum();
  return fourier::resized(series, H);
}

// -psi''/(2 psi) + 3/4 (psi'/psi)^2 = -L''/2 + L'^2/4 with L = ln psi, from L' and L''.
ArrayXd schwarzian(const ArrayXd& L1, const ArrayXd& L2) { return -0.5 * L2 + 0.25 * L1.square(); }

// Mean over the turn, and how much half the nodes change it.
struct Mean {
  double value, change;
  explicit Mean(const ArrayXd& samples) : value(samples.mean()), change(0) {
    double even = 0;
    for (Index i = 0; i < samples.size(); i += 2) even += samples(i);
    change = std::abs(even / double(samples.size() / 2) - value);
  }
};

// What |d| <= dQ does to the frequency mean(psi) - mean d/(2 psi) of psi^2 = Q - psi''/(2 psi) + 3/4 (psi'/psi)^2 + d.
// With e = int |d|/(2 psi) over the turn the half trace of its map is within cosh e - 1 of cos 2 pi frequency; infinite
// where the multipliers may be real. `rest`: what else the frequency is not known to.
double second_order(double dQ, double smallest_psi, double frequency, double rest) {
  const double half = std::sinh(0.5 * pi * dQ / smallest_psi), off = 2 * half * half;
  const double sine = std::max(0.0, std::abs(std::sin(two_pi * frequency)) - two_pi * rest);
  return off < 0.5 * sine * sine ? off / (pi * sine) : HUGE_VAL;
}

// psi = e^L at M nodes of the turn, and what follows from it.
struct PhaseFunction {
  // left: how much the last correction differed; given: alpha, beta, beta' at these nodes.
  PhaseFunction(double sigma, double left, const FourierSeries& L, const Eigen::ArrayXXd& given)
      : PhaseFunction(sigma, left, given, sampled({{L, 0}, {L, 1}, {L, 2}}, given.rows())) {}

  [[nodiscard]] ExponentPair exponents(double alpha_error, double beta_error) const {
    return sigma > 0 ? oscillating(alpha_error, beta_error) : overdamped(alpha_error, beta_error);
  }

  double sigma, left;
  ArrayXd a, b, b1, psi, psi2, correction, d;
  double defect;
  Mean frequency;

 private:
  // L: with L', L''.
  PhaseFunction(double sigma, double left, const Eigen::ArrayXXd& given, const Eigen::ArrayXXd& L)
      : sigma(sigma),
        left(left),
        a(given.col(0)),
        b(given.col(1)),
        b1(given.col(2)),
        psi(L.col(0).exp()),
        psi2(psi.square()),
        correction(schwarzian(L.col(1), L.col(2))),
        d(psi2 - sigma * (a - b.square() / 4 - b1 / 2 + correction)),
        defect(d.abs().maxCoeff()),
        frequency(psi) {}

  [[nodiscard]] ExponentPair oscillating(double alpha_error, double beta_error) const;
  [[nodiscard]] ExponentPair overdamped(double alpha_error, double beta_error) const;

  // What an error of Q and those of the coefficients do to psi.
  [[nodiscard]] double dQ() const { return 2 * std::max(defect, left); }
  [[nodiscard]] double floor() const { return 2 * psi.minCoeff(); }
};

ExponentPair PhaseFunction::oscillating(double alpha_error, double beta_error) const {
  const double largest_b = b.abs().maxCoeff();
  const Mean corrected(psi - d / (2 * psi));
  const auto rest = [&](const Mean& mean) {
    return (alpha_error + beta_error * (largest_b + psi.maxCoeff()) + 8 * eps * a.abs().maxCoeff()) / floor() +
           beta_error + 4 * eps * (psi.maxCoeff() + largest_b) + mean.change;
  };
  const double second = second_order(dQ(), psi.minCoeff(), corrected.value, rest(corrected)), first = dQ() / floor();
  const Mean& mean = second < first ? corrected : frequency;
  ExponentPair pair;
  const double error = std::min(second, first) + rest(mean);
  pair.s = {cplx(-b.mean() / 2, mean.value), cplx(-b.mean() / 2, -mean.value)};
  pair.error = {error, error};
  return pair;
}

ExponentPair PhaseFunction::overdamped(double alpha_error, double beta_error) const {
  const double largest_b = b.abs().maxCoeff();
  ExponentPair pair;
  // r = -beta/2 +- chi - chi'/(2 chi); of the two the one that nearly cancels is
  // chi - |beta|/2 = (chi^2 - beta^2/4)/(chi + |beta|/2) with chi^2 - beta^2/4 = -alpha + beta'/2 - correction.
  const ArrayXd near = (-a + b1 / 2 - correction) / (psi + b.abs() / 2);
  const double sign = b.mean() >= 0 ? 1 : -1;
  const Mean mean(near);
  const double slow = sign > 0 ? mean.value : -mean.value, fast = -b.mean() - slow;
  if (b.minCoeff() * sign < 0) {  // |beta| is not smooth: no cancellation to avoid either
    const double up = -b.mean() / 2 + frequency.value, down = -b.mean() / 2 - frequency.value;
    pair.s = {up, down};
    const double error = (dQ() + alpha_error + beta_error * (largest_b + psi.maxCoeff())) / floor() + beta_error +
                         8 * eps * (psi.maxCoeff() + largest_b) + frequency.change;
    pair.error = {error, error};
  } else {
    // Residual of the slow root's own Riccati equation r' + r^2 + beta r + alpha: relative to alpha, not to beta^2.
    const double reach = std::abs(slow) + near.abs().maxCoeff();
    const double relative = 8 * eps * psi2.maxCoeff() / psi2.minCoeff();
    // Rounding of psi^2 hides in `defect`, but harms `near` in proportion only.
    const double slow_dQ = 2 * std::max(defect - 8 * eps * psi2.maxCoeff(), left);
    const double slow_error = relative * near.abs().maxCoeff() + slow_dQ / floor() + mean.change +
                              (alpha_error + beta_error * reach) / floor() +
                              8 * eps * (reach + (a.abs().maxCoeff() + correction.abs().maxCoeff()) / floor());
    const double fast_error = (dQ() + alpha_error + beta_error * (largest_b + psi.maxCoeff())) / floor() + beta_error +
                              8 * eps * (psi.maxCoeff() + largest_b) + frequency.change;
    pair.s = {slow, fast};
    pair.error = {slow_error, fast_error};
    if (slow < fast) {
      std::swap(pair.s[0], pair.s[1]);
      std::swap(pair.error[0], pair.error[1]);
    }
  }
  return pair;
}

}  // namespace

std::optional<ExponentPair> phase_exponents(const FourierSeries& given_alpha, const FourierSeries& given_beta,
                                            double alpha_error, double beta_error, double tolerance) {
  const FourierSeries alpha = above_rounding(given_alpha, alpha_error), beta = above_rounding(given_beta, beta_error);
  const Index start = fourier::fast_length(2 * std::max({alpha.num_harmonics(), beta.num_harmonics(), Index(8)}) + 4);
  for (Index N = start; N <= 8 * start; N *= 2) {
    const Eigen::ArrayXXd given = sampled({{alpha, 0}, {beta, 0}, {beta, 1}}, 2 * N);
    const ArrayXd finer = given.col(0) - given.col(1).square() / 4 - given.col(2) / 2;
    const ArrayXd Q = finer(Eigen::seqN(0, N, 2));
    // sigma = +1: oscillating, psi real; sigma = -1: overdamped, psi = -i chi with chi real.
    const double sigma = Q.minCoeff() > 0 ? 1 : -1;
    if (!((sigma * Q).minCoeff() > 0)) return std::nullopt;

    // Part of the error allowed that the next correction may be.
    constexpr double unseen = 0.01;
    // psi2 = sigma (Q + correction) leaves the defect `left` at the nodes: how much the next correction differs.
    FourierSeries L;
    ArrayXd correction = ArrayXd::Zero(N), next = sigma * Q;
    double left = HUGE_VAL;
    for (int iteration = 0; iteration < 40; ++iteration) {
      const ArrayXd logarithm = 0.5 * next.log();
      const FourierSeries log_psi = fourier::analyse(logarithm.matrix().transpose());
      const Eigen::ArrayXXd slopes = sampled({{log_psi, 1}, {log_psi, 2}}, N);
      const ArrayXd term = schwarzian(slopes.col(0), slopes.col(1));
      const double change = (term - correction).abs().maxCoeff();
      if (!(change < 0.7 * left)) break;  // rounding reached, or an asymptotic expansion at its best
      left = change;
      L = log_psi;
      correction = term;
      next = sigma * (Q + term);
      if (!next.allFinite() || !(next.minCoeff() > 0)) break;
      const ArrayXd psi = next.sqrt();
      const double allowed = unseen * tolerance, smallest = psi.minCoeff();
      if (left <= allowed * smallest || (sigma > 0 && second_order(2 * left, smallest, psi.mean(), 0) <= allowed))
        break;
    }
    if (!std::isfinite(left)) return std::nullopt;
    // From here on psi = exp(L), L a trigonometric polynomial, is what it is; its defect at twice the nodes says how
    // good it is, sampling included.
    const PhaseFunction phase(sigma, left, L, given);
    const ExponentPair pair = phase.exponents(alpha_error, beta_error);
    if (std::isfinite(pair.error[0]) && pair.error[0] <= tolerance && std::isfinite(pair.error[1])) return pair;
    if (!(phase.defect > 2 * left)) return std::nullopt;  // a finer grid helps only against lost harmonics
  }
  return std::nullopt;
}

}  // namespace hb
