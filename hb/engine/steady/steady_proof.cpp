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

// B and the norm of 1 - B A, column by column: hb/engine/README.md (S8).
class Contraction {
 public:
  Contraction(const WeightedSystem& system, const MatrixXd& T, Index N)
      : s(system),
        N(N),
        I(system.I),
        P(system.P),
        n(proof_size(system, N)),
        sum_rounding(2 * (static_cast<double>(n) + 4) * eps),
        tau(T.cwiseAbs().colwise().maxCoeff().transpose()),
        weights(n),
        A(MatrixXcd::Zero(n, n)),
        outer(MatrixXcd::Zero(n, 2 * P * I)) {
    for (Index k = -N; k <= N; ++k) weights.segment(at(0, k), I) = tau;
    fill_window();
    B = dense::inverse(A);
    finite = B.allFinite();
    if (!finite) return;
    size_B = B.cwiseAbs();
    weighted_B = weights.transpose() * size_B;
    bound_tail();
  }

  bool finite;

  // Norm of 1 - B A.
  [[nodiscard]] double bound() const {
    VectorXd largest_B(I);
    for (Index i = 0; i < I; ++i) {
      largest_B(i) = tau(i) * inverse_D(i);
      for (Index k = -N; k <= N; ++k) largest_B(i) = std::max(largest_B(i), weighted_B(at(i, k)));
    }
    const Eigen::RowVectorXd data = largest_B.transpose() * s.K_rounding;
    return std::max(window_columns(data), tail_columns(data));
  }

  // Bounds on the components of B r, sums over all harmonics.
  [[nodiscard]] VectorXd sizes_of(const Spectrum& r, const MatrixXd& rounding) const {
    Eigen::VectorXcd window = Eigen::VectorXcd::Zero(n);
    VectorXd unknown = VectorXd::Zero(n), sizes = VectorXd::Zero(I);
    for (Index k = 0; k < r.rows(); ++k)
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
    return sizes;
  }

  [[nodiscard]] const VectorXd& norm_weights() const { return tau; }

 private:
  [[nodiscard]] Index at(Index i, Index k) const { return (k + N) * I + i; }

  // Window of A, and what columns N < |l| <= N + P have in it.
  void fill_window() {
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
  }

  // 1/|D| and k/|D| over all k > N.
  void bound_tail() {
    inverse_D.resize(I), slope_D.resize(I);
    for (Index i = 0; i < I; ++i) {
      const double w2 = s.mean(i), b = s.G(i, i);
      const auto D = [&](double k) { return std::hypot(w2 - k * k, k * b) * (1 - 8 * eps); };
      inverse_D(i) = largest_beyond(N, std::sqrt(std::max(0.0, w2 - b * b / 2)), [&](double k) { return 1 / D(k); });
      slope_D(i) = largest_beyond(N, std::sqrt(std::max(0.0, w2)), [&](double k) { return k / D(k); });
    }
    finite = inverse_D.allFinite();
  }

  // Rows beyond the window of column |l| <= N: those of K through D^-1.
  [[nodiscard]] double beyond(Index j, Index l) const {
    double sum = 0;
    for (Index i = 0; i < I; ++i)
      for (Index m = N + 1; m <= N + P; ++m)
        sum += tau(i) * inverse_D(i) * (std::abs(coefficient(s, i, j, m - l)) + std::abs(coefficient(s, i, j, -m - l)));
    return sum;
  }

  // Of |1 - B A| the columns |l| <= N. data: what the rounding of K itself makes.
  [[nodiscard]] double window_columns(const Eigen::RowVectorXd& data) const {
    MatrixXcd defect = -B * A;
    defect.diagonal().array() += 1;
    const Eigen::RowVectorXd inside =
        weights.transpose() * defect.cwiseAbs() + sum_rounding * weighted_B * A.cwiseAbs();
    double largest = 0;
    for (Index l = -N; l <= N; ++l)
      for (Index j = 0; j < I; ++j) {
        const double harmonic = std::abs(static_cast<double>(l));
        double entries = weighted_B(at(j, l)) * harmonic * harmonic;
        for (Index i = 0; i < I; ++i) entries += weighted_B(at(i, l)) * harmonic * std::abs(s.G(i, j));
        const double column = inside(at(j, l)) + beyond(j, l) + data(j) + entry_rounding() * entries;
        largest = std::max(largest, column / tau(j));
      }
    return largest;
  }

  // All others.
  [[nodiscard]] double tail_columns(const Eigen::RowVectorXd& data) const {
    MatrixXd norm_K(I, I);  // sum over all harmonics of |K_ij|, without the mean of the diagonal
    for (Index j = 0; j < I; ++j)
      for (Index i = 0; i < I; ++i) {
        norm_K(i, j) = i == j ? 0 : std::abs(s.K(i + I * j, 0));
        for (Index m = 1; m <= P; ++m) norm_K(i, j) += 2 * std::abs(s.K(i + I * j, m));
      }
    Eigen::RowVectorXd inside = Eigen::RowVectorXd::Zero(2 * P * I);
    if (P > 0) inside = weights.transpose() * (B * outer).cwiseAbs() + sum_rounding * weighted_B * outer.cwiseAbs();
    double contraction = 0;
    for (Index j = 0; j < I; ++j) {
      double outside = data(j);
      for (Index i = 0; i < I; ++i) {
        outside += tau(i) * inverse_D(i) * norm_K(i, j);
        if (i != j) outside += tau(i) * slope_D(i) * std::abs(s.G(i, j));
      }
      // k^2 = w^2 - Re D: k^2/|D| <= 1 + w^2/|D|.
      outside += entry_rounding() * tau(j) *
                 (1 + std::abs(s.mean(j)) * inverse_D(j) + slope_D(j) * s.G.col(j).cwiseAbs().sum());
      double largest = 0;
      for (Index c = j; c < 2 * P * I; c += I) largest = std::max(largest, inside(c));
      contraction = std::max(contraction, (largest + outside) / tau(j));
    }
    return contraction;
  }

  // The entries of A themselves: K as scaled, -k^2 and k G as rounded.
  [[nodiscard]] double entry_rounding() const { return 8 * eps * static_cast<double>(I); }

  const WeightedSystem& s;
  Index N, I, P, n;
  double sum_rounding;  // sums of n complex products are off by so much of the sum of their moduli at most
  VectorXd tau, weights;
  MatrixXcd A, outer, B;
  MatrixXd size_B;
  Eigen::RowVectorXd weighted_B;  // norms of the columns of B
  VectorXd inverse_D, slope_D;
};

}  // namespace

Index proof_size(const WeightedSystem& system, Index num_harmonics) { return system.I * (2 * num_harmonics + 1); }

Proof prove_error(const WeightedSystem& s, const MatrixXd& T, Index N, const Spectrum& r, const MatrixXd& rounding) {
  Proof proof{HUGE_VAL, HUGE_VAL};
  const Contraction contraction(s, T, N);
  if (!contraction.finite) return proof;
  const double c = proof.contraction = contraction.bound();
  if (!(c < 1)) return proof;
  const VectorXd sizes = contraction.sizes_of(r, rounding);
  const double left_over = c / (1 - c) * contraction.norm_weights().dot(sizes);
  proof.error = ((T.cwiseAbs() * sizes).maxCoeff() + left_over) * (1 + 1e-10);
  return proof;
}

}  // namespace hb::steady
