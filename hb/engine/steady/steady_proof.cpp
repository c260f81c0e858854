#include "hb/engine/steady/steady_proof.hpp"

#include <cmath>

#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb::steady {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::complex<double> coefficient(const WeightedSystem& s, Index i, Index j, Index m) {
  if (std::abs(m) > s.P) return 0;
  return m >= 0 ? s.K(i + s.I * j, m) : std::conj(s.K(i + s.I * j, -m));
}

// Largest of g(k) over integers k > N where g has a single peak at `peak`.
template <class Function>
double largest_beyond(Index N, double peak, const Function& g) {
  double largest = g(static_cast<double>(N + 1));
  for (const double k : {std::floor(peak), std::ceil(peak)})
    if (k > static_cast<double>(N)) largest = std::max(largest, g(k));
  return largest;
}

}  // namespace

Index proof_size(const WeightedSystem& system, Index num_harmonics) { return system.I * (2 * num_harmonics + 1); }

Proof prove_error(const WeightedSystem& s, const MatrixXd& T, Index N, const Spectrum& r, const MatrixXd& rounding) {
  const Index I = s.I, P = s.P, n = proof_size(s, N);
  const auto at = [&](Index i, Index k) { return (k + N) * I + i; };
  const VectorXd tau = T.cwiseAbs().colwise().maxCoeff().transpose();
  VectorXd weights(n);
  for (Index k = -N; k <= N; ++k) weights.segment(at(0, k), I) = tau;

  // Window of A, and what columns N < |l| <= N + P have in it.
  MatrixXcd A = MatrixXcd::Zero(n, n), outer = MatrixXcd::Zero(n, 2 * P * I);
  for (Index l = -N - P; l <= N + P; ++l)
    for (Index j = 0; j < I; ++j)
      for (Index k = std::max(-N, l - P); k <= std::min(N, l + P); ++k)
        for (Index i = 0; i < I; ++i) {
          const std::complex<double> value = coefficient(s, i, j, k - l);
          if (std::abs(l) <= N)
            A(at(i, k), at(j, l)) = value;
          else
            outer(at(i, k), (l < 0 ? l + N + P : l - N - 1 + P) * I + j) = value;
        }
  for (Index k = -N; k <= N; ++k)
    for (Index i = 0; i < I; ++i) {
      const double harmonic = static_cast<double>(k);
      A(at(i, k), at(i, k)) -= harmonic * harmonic;
      for (Index j = 0; j < I; ++j) A(at(i, k), at(j, k)) += std::complex<double>(0, harmonic * s.G(i, j));
    }
  const MatrixXcd B = dense::inverse(A);
  Proof proof{HUGE_VAL, HUGE_VAL};
  if (!B.allFinite()) return proof;
  // Sums of n complex products are off by 2 (n + 4) eps of the sum of their moduli at most.
  const double sum_rounding = 2 * (static_cast<double>(n) + 4) * eps;
  const MatrixXd size_B = B.cwiseAbs();
  const Eigen::RowVectorXd weighted_B = weights.transpose() * size_B;  // norms of the columns of B

  // 1/|D| and k/|D| over all k > N.
  VectorXd inverse_D(I), slope_D(I);
  for (Index i = 0; i < I; ++i) {
    const double w2 = s.mean(i), b = s.G(i, i);
    const auto D = [&](double k) { return std::hypot(w2 - k * k, k * b) * (1 - 8 * eps); };
    inverse_D(i) = largest_beyond(N, std::sqrt(std::max(0.0, w2 - b * b / 2)), [&](double k) { return 1 / D(k); });
    slope_D(i) = largest_beyond(N, std::sqrt(std::max(0.0, w2)), [&](double k) { return k / D(k); });
  }
  if (!inverse_D.allFinite()) return proof;

  // |1 - B A| column by column. Rows beyond the window: those of K through D^-1.
  MatrixXd norm_K(I, I);  // sum over all harmonics of |K_ij|, without the mean of the diagonal
  for (Index j = 0; j < I; ++j)
    for (Index i = 0; i < I; ++i) {
      norm_K(i, j) = i == j ? 0 : std::abs(s.K(i + I * j, 0));
      for (Index m = 1; m <= P; ++m) norm_K(i, j) += 2 * std::abs(s.K(i + I * j, m));
    }
  const auto beyond = [&](Index j, Index l) {  // of column |l| <= N
    double sum = 0;
    for (Index i = 0; i < I; ++i)
      for (Index m = N + 1; m <= N + P; ++m)
        sum += tau(i) * inverse_D(i) * (std::abs(coefficient(s, i, j, m - l)) + std::abs(coefficient(s, i, j, -m - l)));
    return sum;
  };
  // The entries of A themselves: K as scaled, -k^2 and k G as rounded.
  VectorXd largest_B(I);
  for (Index i = 0; i < I; ++i) {
    largest_B(i) = tau(i) * inverse_D(i);
    for (Index k = -N; k <= N; ++k) largest_B(i) = std::max(largest_B(i), weighted_B(at(i, k)));
  }
  const double entry_rounding = 8 * eps * static_cast<double>(I);
  const Eigen::RowVectorXd data = largest_B.transpose() * s.K_rounding;

  double contraction = 0;
  {
    MatrixXcd defect = -B * A;
    defect.diagonal().array() += 1;
    const Eigen::RowVectorXd inside =
        weights.transpose() * defect.cwiseAbs() + sum_rounding * weighted_B * A.cwiseAbs();
    for (Index l = -N; l <= N; ++l)
      for (Index j = 0; j < I; ++j) {
        const double harmonic = std::abs(static_cast<double>(l));
        double entries = weighted_B(at(j, l)) * harmonic * harmonic;
        for (Index i = 0; i < I; ++i) entries += weighted_B(at(i, l)) * harmonic * std::abs(s.G(i, j));
        const double column = inside(at(j, l)) + beyond(j, l) + data(j) + entry_rounding * entries;
        contraction = std::max(contraction, column / tau(j));
      }
  }
  {
    Eigen::RowVectorXd inside = Eigen::RowVectorXd::Zero(2 * P * I);
    if (P > 0) inside = weights.transpose() * (B * outer).cwiseAbs() + sum_rounding * weighted_B * outer.cwiseAbs();
    for (Index j = 0; j < I; ++j) {
      double outside = data(j);
      for (Index i = 0; i < I; ++i) {
        outside += tau(i) * inverse_D(i) * norm_K(i, j);
        if (i != j) outside += tau(i) * slope_D(i) * std::abs(s.G(i, j));
      }
      // k^2 = w^2 - Re D: k^2/|D| <= 1 + w^2/|D|.
      outside +=
          entry_rounding * tau(j) * (1 + std::abs(s.mean(j)) * inverse_D(j) + slope_D(j) * s.G.col(j).cwiseAbs().sum());
      double largest = 0;
      for (Index c = j; c < 2 * P * I; c += I) largest = std::max(largest, inside(c));
      contraction = std::max(contraction, (largest + outside) / tau(j));
    }
  }
  proof.contraction = contraction;
  if (!(contraction < 1)) return proof;

  // B r, component by component, sums over all harmonics.
  const Index R = r.rows() - 1;
  Eigen::VectorXcd window = Eigen::VectorXcd::Zero(n);
  VectorXd unknown = VectorXd::Zero(n), sizes = VectorXd::Zero(I);
  for (Index k = 0; k <= R; ++k)
    for (Index i = 0; i < I; ++i) {
      if (k <= N) {
        window(at(i, k)) = r(k, i);
        window(at(i, -k)) = std::conj(r(k, i));
        unknown(at(i, k)) = unknown(at(i, -k)) = rounding(k, i) + sum_rounding * std::abs(r(k, i));
      } else {
        const double harmonic = static_cast<double>(k);
        const double D = std::hypot(s.mean(i) - harmonic * harmonic, harmonic * s.G(i, i));
        sizes(i) += 2 * (std::abs(r(k, i)) + rounding(k, i)) / D * (1 + 8 * eps);
      }
    }
  const VectorXd inner = (B * window).cwiseAbs() + size_B * unknown;
  for (Index k = -N; k <= N; ++k) sizes += inner.segment(at(0, k), I);
  proof.error = ((T.cwiseAbs() * sizes).maxCoeff() + contraction / (1 - contraction) * tau.dot(sizes)) * (1 + 1e-10);
  return proof;
}

}  // namespace hb::steady
