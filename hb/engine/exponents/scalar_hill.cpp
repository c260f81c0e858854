#include "hb/engine/exponents/scalar_hill.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <initializer_list>
#include <span>

#include "lib/constants.hpp"
#include "lib/workspace.hpp"

namespace hb {

namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using cplx = std::complex<double>;

// Harmonics 0..H of one function.
using Harmonics = std::span<const cplx>;

// One function and how often it is differentiated.
struct Derivative {
  Harmonics c;
  int order;
};

// At N nodes, a column each; they last until next so many functions are sampled there.
Eigen::Map<const Eigen::ArrayXXd> sampled(std::initializer_list<Derivative> functions, Index N) {
  fourier::RealTransform& transform = fourier::thread_transform(N, Index(functions.size()));
  auto spectrum = transform.spectrum();
  Index column = 0;
  for (const Derivative& f : functions) {
    auto to = spectrum.col(column++);
    const Index count = Index(f.c.size());
    to.tail(to.size() - count).setZero();
    for (Index k = 0; k < count; ++k) {
      const double n = double(k), x = f.c[std::size_t(k)].real(), y = f.c[std::size_t(k)].imag();
      to(k) = f.order == 0 ? cplx(x, y) : f.order == 1 ? cplx(-n * y, n * x) : cplx(-n * n * x, -n * n * y);
    }
  }
  transform.backward();
  return {transform.samples().data(), N, Index(functions.size())};
}

// Harmonics up to the last one above rounding; what is cut away is added to `error`.
Harmonics above_rounding(const FourierSeries& series, double& error) {
  assert(series.num_components() == 1);
  const Index H = fourier::significant_harmonics(series, 2 * eps);
  error += 2 * series.c.rightCols(series.num_harmonics() - H).cwiseAbs().sum();
  return {series.c.data(), std::size_t(H + 1)};
}

// Mean over the turn, and how much half the nodes change it.
struct Mean {
  double value, change;
  template <class Samples>
  explicit Mean(const Samples& samples) : value(samples.mean()), change(0) {
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

// psi = e^L: L from N nodes of the turn, judged at twice as many.
class PhaseFunction {
 public:
  PhaseFunction(Harmonics alpha, Harmonics beta, Index num_nodes);

  // Finds L; false if Q changes sign, or nothing finite is left.
  [[nodiscard]] bool iterate(double tolerance);

  [[nodiscard]] ExponentPair exponents(double alpha_error, double beta_error);

  // A finer grid helps only against lost harmonics.
  [[nodiscard]] bool lost_harmonics() const { return defect > 2 * left; }

 private:
  using Column = Eigen::Map<ArrayXd>;

  [[nodiscard]] ExponentPair oscillating(double alpha_error, double beta_error);
  [[nodiscard]] ExponentPair overdamped(double alpha_error, double beta_error);

  // What an error of Q and those of the coefficients do to psi.
  [[nodiscard]] double dQ() const { return 2 * std::max(defect, left); }
  [[nodiscard]] double floor() const { return 2 * smallest_psi; }

  Index N;
  Eigen::Map<Eigen::MatrixXd> room;
  Column a, b, b1, finer, psi, finer_correction, d;  // at 2N nodes; finer: Q
  Column Q, correction, next;  // at N nodes; next: sigma (Q + correction)
  Eigen::VectorXcd L;
  double sigma;  // +1: oscillating, psi real; -1: overdamped, psi = -i chi with chi real
  double left = HUGE_VAL;  // how much the last correction differed
  double defect = HUGE_VAL, smallest_psi = 0, largest_psi = 0;
};

Eigen::Map<Eigen::MatrixXd> room_at(Index num_nodes) {
  thread_local Workspace kept;
  return kept.matrix(num_nodes, 17);
}

PhaseFunction::PhaseFunction(Harmonics alpha, Harmonics beta, Index num_nodes)
    : N(num_nodes),
      room(room_at(N)),
      a(&room(0, 0), 2 * N),
      b(&room(0, 2), 2 * N),
      b1(&room(0, 4), 2 * N),
      finer(&room(0, 6), 2 * N),
      psi(&room(0, 8), 2 * N),
      finer_correction(&room(0, 10), 2 * N),
      d(&room(0, 12), 2 * N),
      Q(&room(0, 14), N),
      correction(&room(0, 15), N),
      next(&room(0, 16), N) {
  const auto given = sampled({{alpha, 0}, {beta, 0}, {beta, 1}}, 2 * N);
  a = given.col(0);
  b = given.col(1);
  b1 = given.col(2);
  finer = a - b.square() / 4 - b1 / 2;
  Q = finer(Eigen::seqN(0, N, 2));
  sigma = Q.minCoeff() > 0 ? 1 : -1;
}

// From -psi''/(2 psi) + 3/4 (psi'/psi)^2 = -L''/2 + L'^2/4.
bool PhaseFunction::iterate(double tolerance) {
  next = sigma * Q;
  if (!(next.minCoeff() > 0)) return false;
  // Part of the error allowed that the next correction may be.
  constexpr double unseen = 0.01;
  const double allowed = unseen * tolerance;
  fourier::RealTransform& transform = fourier::thread_transform(N);
  const auto harmonics = transform.spectrum().col(0).head((N - 1) / 2 + 1);
  correction.setZero();
  // psi^2 = sigma (Q + correction) leaves the defect `left` at the nodes: how much the next correction differs.
  for (int iteration = 0; iteration < 40; ++iteration) {
    transform.samples().array().col(0) = 0.5 * next.log();
    transform.forward();
    const Harmonics log_psi(harmonics.data(), std::size_t(harmonics.size()));
    const auto slopes = sampled({{log_psi, 1}, {log_psi, 2}}, N);
    next = -0.5 * slopes.col(1) + 0.25 * slopes.col(0).square();
    const double change = (next - correction).abs().maxCoeff();
    if (!(change < 0.7 * left)) break;  // rounding reached, or an asymptotic expansion at its best
    left = change;
    L = harmonics;
    correction = next;
    next = sigma * (Q + correction);
    if (!next.allFinite() || !(next.minCoeff() > 0)) break;
    const double smallest = std::sqrt(next.minCoeff());
    if (left <= allowed * smallest || (sigma > 0 && second_order(2 * left, smallest, next.sqrt().mean(), 0) <= allowed))
      break;
  }
  return std::isfinite(left);
}

// From here on psi = exp(L), L a trigonometric polynomial, is what it is; its defect at twice the nodes says how good
// it is, sampling included.
ExponentPair PhaseFunction::exponents(double alpha_error, double beta_error) {
  const Harmonics log_psi(L.data(), std::size_t(L.size()));
  const auto at_nodes = sampled({{log_psi, 0}, {log_psi, 1}, {log_psi, 2}}, 2 * N);
  psi = at_nodes.col(0).exp();
  finer_correction = -0.5 * at_nodes.col(2) + 0.25 * at_nodes.col(1).square();
  d = psi.square();
  d -= sigma * (finer + finer_correction);
  defect = d.abs().maxCoeff();
  smallest_psi = psi.minCoeff();
  largest_psi = psi.maxCoeff();
  return sigma > 0 ? oscillating(alpha_error, beta_error) : overdamped(alpha_error, beta_error);
}

ExponentPair PhaseFunction::oscillating(double alpha_error, double beta_error) {
  const double largest_b = b.abs().maxCoeff();
  const double known = (alpha_error + beta_error * (largest_b + largest_psi) + 8 * eps * a.abs().maxCoeff()) / floor() +
                       beta_error + 4 * eps * (largest_psi + largest_b);
  d = psi - d / (2 * psi);
  const Mean corrected(d);
  const double second = second_order(dQ(), smallest_psi, corrected.value, known + corrected.change),
               first = dQ() / floor();
  const Mean mean = second < first ? corrected : Mean(psi);
  const double error = std::min(second, first) + (known + mean.change), decay = -b.mean() / 2;
  return {{cplx(decay, mean.value), cplx(decay, -mean.value)}, {error, error}};
}

ExponentPair PhaseFunction::overdamped(double alpha_error, double beta_error) {
  const double largest_b = b.abs().maxCoeff(), mean_b = b.mean();
  const Mean frequency(psi);
  const double fast_error = (dQ() + alpha_error + beta_error * (largest_b + largest_psi)) / floor() + beta_error +
                            8 * eps * (largest_psi + largest_b) + frequency.change;
  const double sign = mean_b >= 0 ? 1 : -1;
  if (b.minCoeff() * sign < 0)  // |beta| is not smooth: no cancellation to avoid either
    return {{-mean_b / 2 + frequency.value, -mean_b / 2 - frequency.value}, {fast_error, fast_error}};
  // r = -beta/2 +- chi - chi'/(2 chi); of the two the one that nearly cancels is
  // chi - |beta|/2 = (chi^2 - beta^2/4)/(chi + |beta|/2) with chi^2 - beta^2/4 = -alpha + beta'/2 - correction.
  auto& near = d;
  near = (-a + b1 / 2 - finer_correction) / (psi + b.abs() / 2);
  const Mean mean(near);
  const double slow = sign > 0 ? mean.value : -mean.value, fast = -mean_b - slow;
  // Residual of the slow root's own Riccati equation r' + r^2 + beta r + alpha: relative to alpha, not to beta^2.
  const double largest_near = near.abs().maxCoeff(), reach = std::abs(slow) + largest_near;
  const double largest_psi2 = largest_psi * largest_psi;
  const double relative = 8 * eps * largest_psi2 / (smallest_psi * smallest_psi);
  // Rounding of psi^2 hides in `defect`, but harms `near` in proportion only.
  const double slow_dQ = 2 * std::max(defect - 8 * eps * largest_psi2, left);
  const double slow_error = relative * largest_near + slow_dQ / floor() + mean.change +
                            (alpha_error + beta_error * reach) / floor() +
                            8 * eps * (reach + (a.abs().maxCoeff() + finer_correction.abs().maxCoeff()) / floor());
  if (slow < fast) return {{fast, slow}, {fast_error, slow_error}};
  return {{slow, fast}, {slow_error, fast_error}};
}

}  // namespace

std::optional<ExponentPair> phase_exponents(const FourierSeries& given_alpha, const FourierSeries& given_beta,
                                            double alpha_error, double beta_error, double tolerance) {
  const Harmonics alpha = above_rounding(given_alpha, alpha_error), beta = above_rounding(given_beta, beta_error);
  const Index H = std::max({Index(alpha.size()) - 1, Index(beta.size()) - 1, Index(8)});
  const Index start = fourier::fast_length(2 * H + 4);
  for (Index N = start; N <= 8 * start; N *= 2) {
    PhaseFunction phase(alpha, beta, N);
    if (!phase.iterate(tolerance)) return std::nullopt;
    const ExponentPair pair = phase.exponents(alpha_error, beta_error);
    if (std::isfinite(pair.error[0]) && pair.error[0] <= tolerance && std::isfinite(pair.error[1])) return pair;
    if (!phase.lost_harmonics()) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace hb
