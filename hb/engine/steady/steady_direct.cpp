#include "hb/engine/steady/steady_direct.hpp"

#include <cmath>
#include <complex>

#include "lib/stop_wish.hpp"

namespace hb::steady {

namespace {

using Index = Eigen::Index;

constexpr Index smallest_block = 16;

struct Partition {
  Index core, per_block, num_blocks;  // harmonics 0..core in the core
};

Partition partition(Index I, Index P, Index H) {
  const Index p = std::max<Index>({P, 1, (smallest_block + I - 1) / I});
  const Index blocks = H > P ? (H - P) / p : 0;
  return {H - blocks * p, p, blocks};
}

}  // namespace

DirectCost DirectInverse::cost(const WeightedSystem& system, Index num_harmonics) {
  const Partition part = partition(system.I, factor_harmonics(system), num_harmonics);
  DirectCost cost;
  cost.core = system.I * (2 * part.core + 1);
  cost.block = system.I * part.per_block;
  cost.num_blocks = part.num_blocks;
  const double n = static_cast<double>(cost.core), b = static_cast<double>(cost.block);
  const double g = static_cast<double>(cost.num_blocks);
  cost.flops = 2.0 / 3.0 * n * n * n + g * (8.0 / 3.0 + 16.0) * b * b * b;
  cost.bytes = 8 * n * n + g * 48 * b * b;
  return cost;
}

// Rows of harmonics row.., columns of harmonics column..: A_kl = D(k) delta_kl + K_{k-l}; inside a block the unknowns
// of one harmonic stand together.
Eigen::MatrixXcd DirectInverse::block(Index row, Index column, Index rows, Index columns) const {
  const WeightedSystem& s = A_.system();
  const Index I = s.I;
  Eigen::MatrixXcd result = Eigen::MatrixXcd::Zero(I * rows, I * columns);
  for (Index l = 0; l < columns; ++l)
    for (Index k = 0; k < rows; ++k) {
      const Index m = row + k - column - l;
      if (std::abs(m) > P_) continue;
      const auto coefficient = s.K.col(std::abs(m)).reshaped(I, I);
      auto target = result.block(I * k, I * l, I, I);
      if (m >= 0)
        target = coefficient;
      else
        target = coefficient.conjugate();
      if (m == 0) {
        const double n = static_cast<double>(row + k);
        target += std::complex<double>(0, n) * s.G.cast<std::complex<double>>();
        target.diagonal().array() -= n * n;
      }
    }
  return result;
}

DirectInverse::DirectInverse(Operator& A) : EliminatedInverse(A) {
  const WeightedSystem& s = A.system();
  const Index I = s.I, H = A.num_harmonics();
  P_ = factor_harmonics(s);
  const Partition part = partition(I, P_, H);
  c_ = part.core;
  p_ = part.per_block;
  const Index G = part.num_blocks;
  S_.resize(static_cast<std::size_t>(G));
  up_.resize(static_cast<std::size_t>(G));
  down_.resize(static_cast<std::size_t>(G));

  Eigen::MatrixXcd Schur;  // what the block outside has taken from this one
  for (Index g = G; g-- > 0;) {
    end_if_wished();
    const Index first = c_ + 1 + g * p_;
    // The innermost block couples to the last p harmonics of the core (c >= P; fewer where the core is shorter).
    const Index inner = g > 0 ? first - p_ : std::max<Index>(0, c_ + 1 - p_), width = first - inner;
    Eigen::MatrixXcd diagonal = block(first, first, p_, p_);
    if (g + 1 < G) diagonal -= Schur;
    const auto at = static_cast<std::size_t>(g);
    S_[at].compute(diagonal);
    regular_ = regular_ && S_[at].pivots().cwiseAbs().minCoeff() > smallest_pivot;
    up_[at] = S_[at].solve(block(first, inner, p_, width));
    down_[at] = block(inner, first, width, p_);
    Schur = down_[at] * up_[at];
  }

  // Core, real unknowns [x_0, Re x_1, Im x_1, Re x_2, ...]. With x = a + i b, row k holds
  // sum_l (A_{k-l} + K_{k+l}) a_l + i (A_{k-l} - K_{k+l}) b_l.
  const Index n = I * (2 * c_ + 1);
  Eigen::MatrixXcd linear = block(0, 0, c_ + 1, c_ + 1);
  if (G > 0) linear.bottomRightCorner(Schur.rows(), Schur.cols()) -= Schur;
  Eigen::MatrixXd core(n, n);
  const auto place = [I](Index k) { return k == 0 ? 0 : I * (2 * k - 1); };
  for (Index l = 0; l <= c_; ++l)
    for (Index j = 0; j < I; ++j)
      for (Index k = 0; k <= c_; ++k)
        for (Index i = 0; i < I; ++i) {
          const std::complex<double> here = linear(I * k + i, I * l + j);
          const std::complex<double> conjugate = l > 0 && k + l <= P_ ? s.K(i + I * j, k + l) : 0;
          const std::complex<double> cosine = here + conjugate, sine = here - conjugate;
          const Index row = place(k) + i, column = place(l) + j;
          core(row, column) = cosine.real();
          if (k > 0) core(row + I, column) = cosine.imag();
          if (l == 0) continue;
          core(row, column + I) = -sine.imag();
          if (k > 0) core(row + I, column + I) = sine.real();
        }
  core_.compute(core);
  regular_ = regular_ && core_.pivots().cwiseAbs().minCoeff() > smallest_pivot;
}

void DirectInverse::substitute(const Spectrum& rhs, Spectrum& z) const {
  const Index I = A_.num_modes(), H = A_.num_harmonics();
  Eigen::MatrixXcd y = rhs.topRows(H + 1).transpose();  // column per harmonic
  const auto piece = [&](Index first, Index count) {
    return Eigen::Map<Eigen::VectorXcd>(y.data() + I * first, I * count);
  };
  // y_g <- S_g^-1 y_g, then y_{g-1} -= A_{g-1,g} y_g.
  for (std::size_t g = S_.size(); g-- > 0;) {
    const Index first = c_ + 1 + static_cast<Index>(g) * p_;
    auto here = piece(first, p_);
    here = S_[g].solve(here).eval();
    const Index width = down_[g].rows() / I;
    piece(first - width, width) -= down_[g] * here;
  }
  Eigen::VectorXd core(I * (2 * c_ + 1));
  core.head(I) = y.col(0).real();
  for (Index k = 1; k <= c_; ++k) {
    core.segment(I * (2 * k - 1), I) = y.col(k).real();
    core.segment(I * 2 * k, I) = y.col(k).imag();
  }
  core = core_.solve(core).eval();
  y.col(0) = core.head(I).cast<std::complex<double>>();
  for (Index k = 1; k <= c_; ++k) {
    y.col(k).real() = core.segment(I * (2 * k - 1), I);
    y.col(k).imag() = core.segment(I * 2 * k, I);
  }
  for (std::size_t g = 0; g < S_.size(); ++g) {
    const Index first = c_ + 1 + static_cast<Index>(g) * p_;
    const Index width = down_[g].rows() / I;
    const Eigen::VectorXcd inner = piece(first - width, width);
    piece(first, p_) -= up_[g] * inner;
  }
  z = y.transpose();
}

}  // namespace hb::steady
