#include "hb/engine/exponents/anderson.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/constants.hpp"

namespace hb {

using Eigen::Index;
using Eigen::VectorXd;

// min |f - dF gamma| by the normal equations of columns scaled to length 1, by Cholesky's method with the largest pivot
// first; columns that depend on those before drop out.
Anderson::Weights Anderson::weights(Index kept) const {
  std::array<Index, depth> order{};
  Weights scale = Weights::Zero(), solution = scale, y = scale, pivot = Weights::Ones();
  Square L = Square::Zero();  // a row per column of dF; factors in the order of pivots
  for (Index i = 0; i < kept; ++i) scale(i) = 1 / std::max(std::sqrt(gram_(i, i)), 1e-300);
  std::array<bool, depth> taken{};
  Index rank = 0;
  for (; rank < kept; ++rank) {
    Index next = -1;
    for (Index i = 0; i < kept; ++i)
      if (!taken[std::size_t(i)] && (next < 0 || pivot(i) > pivot(next))) next = i;
    if (!(pivot(next) > double(depth) * eps)) break;
    const double root = std::sqrt(pivot(next));
    double sum = right_(next) * scale(next);
    for (Index p = 0; p < rank; ++p) sum -= L(next, p) * y(p);
    y(rank) = sum / root;
    L(next, rank) = root;
    taken[std::size_t(next)] = true;
    order[std::size_t(rank)] = next;
    for (Index i = 0; i < kept; ++i) {
      if (taken[std::size_t(i)]) continue;
      double entry = gram_(i, next) * scale(i) * scale(next);
      for (Index p = 0; p < rank; ++p) entry -= L(i, p) * L(next, p);
      L(i, rank) = entry / root;
      pivot(i) -= L(i, rank) * L(i, rank);
    }
  }
  for (Index p = rank; p-- > 0;) {
    double sum = y(p);
    for (Index r = p + 1; r < rank; ++r) sum -= L(order[std::size_t(r)], p) * solution(order[std::size_t(r)]);
    solution(order[std::size_t(p)]) = sum / L(order[std::size_t(p)], p);
  }
  return solution.cwiseProduct(scale);
}

VectorXd Anderson::step(const Eigen::Ref<const VectorXd>& x, const Eigen::Ref<const VectorXd>& f) {
  if (last_x_.size() > 0) {
    if (taken_ == 0) {
      moved_.resize(x.size(), depth);
      df_.resize(x.size(), depth);
      gram_.setZero();
      right_.setZero();
    }
    const Index column = taken_++ % depth;
    df_.col(column) = f - last_f_;
    moved_.col(column) = (x - last_x_) + df_.col(column);
    const Index kept = std::min(taken_, depth);
    // dF' df = dF' f - dF' last f, as steps are as large as what they lead away from; of the column itself as it is
    const Weights last = right_;
    right_.head(kept).noalias() = df_.leftCols(kept).transpose() * f;
    gram_.col(column).head(kept) = (right_ - last).head(kept);
    gram_(column, column) = df_.col(column).squaredNorm();
    gram_.row(column).head(kept) = gram_.col(column).head(kept).transpose();
  }
  last_x_ = x;
  last_f_ = f;
  VectorXd next = x + f;
  const Index kept = std::min(taken_, depth);
  if (kept == 0) return next;
  const Weights gamma = weights(kept);
  if (gamma.allFinite()) next.noalias() -= moved_.leftCols(kept) * gamma.head(kept);
  return next;
}

}  // namespace hb
