#include "hb/engine/exponents/qr_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/small_matrix.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

QrSweep qr_sweep(const MatrixXd& cells, const MatrixXd& from) {
  const Index n = cells.rows(), N = cells.cols() / n;
  constexpr int most_sweeps = 16;
  constexpr Index often = 64;
  const double apart = std::log(10.0);
  QrSweep result{MatrixXd(n, n * N), {}, {}, MatrixXd(n, n * (N + 1))};
  MatrixXd Q = MatrixXd::Zero(n, n), start(n, n), next(n, n);
  if (from.rows() == n)
    Q = from;
  else
    for (Index i = 0; i < n; ++i) Q(i % 2 == 0 ? i / 2 : n / 2 + i / 2, i) = 1;
  for (int count = 0; count < most_sweeps; ++count) {
    start = Q;
    result.frames.leftCols(n) = Q;
    VectorXd logs = VectorXd::Zero(n);
    for (Index i = 0; i < N; ++i) {
      if (i % often == 0) end_if_wished();
      multiply_columns(cells, n * i, Q, next);
      orthogonalise(next, Q);
      result.R.middleCols(n * i, n) = next;
      result.frames.middleCols(n * (i + 1), n) = Q;
      logs += next.diagonal().cwiseAbs().cwiseMax(1e-300).array().log().matrix();
    }
    // Split where the growth over the turn differs by 10 and the leading subspace has come back onto itself.
    result.turned = start.transpose() * Q;
    result.ends.clear();
    bool settled = true;
    for (Index j = 1; j < n; ++j) {
      if (!(logs(j - 1) - logs(j) > apart)) continue;
      if (result.turned.bottomLeftCorner(n - j, j).norm() <= 1e-13 * std::sqrt(double(n)))
        result.ends.push_back(j);
      else
        settled = false;
    }
    result.ends.push_back(n);
    if (settled && count > 0) break;
  }
  return result;
}

namespace {

// What one step needs besides V, row after row: W = V^-1, one cell's R and its diagonal blocks, and V diag(blocks).
struct StepBack {
  std::vector<double> W, R, D, product;

  explicit StepBack(Index n) : W(std::size_t(n * n)), R(W), D(W), product(W) {}
};

// One cell backwards: left = V^-1, then V <- R^-1 V diag(blocks of R), which is also `right`; V row after row, unit
// upper triangular by blocks. `last`: of the block that each column is in, exclusive.
template <class Length>
void step_back(Length n, const Index* last, const double* __restrict cell, double* __restrict V, StepBack& work,
               double* __restrict left, double* __restrict right) {
  double* __restrict W = work.W.data();
  double* __restrict R = work.R.data();
  double* __restrict D = work.D.data();
  double* __restrict product = work.product.data();
  for (Index r = 0; r < n; ++r)
    for (Index c = 0; c < n; ++c) {
      R[r * n + c] = cell[r + n * c];
      D[r * n + c] = last[r] == last[c] ? cell[r + n * c] : 0;
      W[r * n + c] = r == c ? 1 : 0;
    }
  for (Index r = n - 2; r >= 0; --r)
    for (Index c = r + 1; c < n; ++c)
      for (Index j = 0; j < n; ++j) W[r * n + j] -= V[r * n + c] * W[c * n + j];
  for (Index r = 0; r < n; ++r) {
    for (Index j = 0; j < n; ++j) product[r * n + j] = V[r * n] * D[j];
    for (Index k = 1; k < n; ++k)
      for (Index j = 0; j < n; ++j) product[r * n + j] += V[r * n + k] * D[k * n + j];
  }
  for (Index r = n - 1; r >= 0; --r) {
    for (Index c = r + 1; c < n; ++c)
      for (Index j = 0; j < n; ++j) product[r * n + j] -= R[r * n + c] * V[c * n + j];
    const double pivot = R[r * n + r];
    const bool vanishes = !(std::abs(pivot) > 1e-290);
    const double factor = vanishes ? 0 : 1 / pivot;
    for (Index j = 0; j < n; ++j) V[r * n + j] = factor * product[r * n + j];
    if (vanishes) V[r * n + r] = 1;
  }
  for (Index r = 0; r < n; ++r)
    for (Index c = 0; c < n; ++c) {
      left[r + n * c] = W[r * n + c];
      right[r + n * c] = V[r * n + c];
    }
}

}  // namespace

// Solved from the last cell to the first, which contracts, since what leads grows more over a turn.
std::optional<SubspaceBases> subspace_bases(const QrSweep& sweep) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Index n = sweep.R.rows(), N = sweep.R.cols() / n;
  const auto blocks = Index(sweep.ends.size());
  SubspaceBases bases{MatrixXd::Identity(n, n).replicate(1, N), MatrixXd::Identity(n, n).replicate(1, N)};
  if (blocks == 1) return bases;
  const auto begin = [&](Index b) { return b == 0 ? 0 : sweep.ends[std::size_t(b - 1)]; };
  const auto width = [&](Index b) { return sweep.ends[std::size_t(b)] - begin(b); };
  std::vector<Index> last;  // of the block of each column
  for (Index b = 0; b < blocks; ++b) last.insert(last.end(), std::size_t(width(b)), sweep.ends[std::size_t(b)]);
  Rows V = Rows::Identity(n, n), before;
  StepBack work(n);
  constexpr int most_turns = 8;
  constexpr Index often = 64;  // cells between looks
  for (int turn = 0; turn < most_turns; ++turn) {
    before = V;
    V = sweep.turned.transpose() * (V * sweep.turned).eval();
    for (Index b = 0; b < blocks; ++b) {
      V.block(begin(b), 0, n - begin(b), sweep.ends[std::size_t(b)]).setZero();
      V.diagonal().segment(begin(b), width(b)).setOnes();
    }
    for (Index i = N - 1; i >= 0; --i) {
      if (i % often == 0) end_if_wished();
      with_size(n, [&](auto size) {
        step_back(size, last.data(), sweep.R.data() + n * n * i, V.data(), work, bases.left.data() + n * n * i,
                  bases.right.data() + n * n * i);
      });
    }
    bool settled = turn > 0;
    for (Index b = 0; b < blocks; ++b) {
      const auto columns = V.middleCols(begin(b), width(b));
      settled = settled && (columns - before.middleCols(begin(b), width(b))).norm() <= 0.1 * columns.norm();
    }
    if (settled) return bases;
  }
  return std::nullopt;
}

}  // namespace hb
