#include "hb/engine/exponents/anderson.hpp"

#include <algorithm>

#include "lib/dense.hpp"

namespace hb {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd Anderson::step(const VectorXd& x, const VectorXd& f) {
  if (last_x_.size() > 0) {
    if (taken_ == 0) {
      dx_.resize(x.size(), depth);
      df_.resize(x.size(), depth);
      gram_.resize(depth, depth);
    }
    const Index column = taken_++ % depth;
    dx_.col(column) = x - last_x_;
    df_.col(column) = f - last_f_;
    const Index kept = std::min(taken_, depth);
    gram_.col(column).head(kept).noalias() = df_.leftCols(kept).transpose() * df_.col(column);
    gram_.row(column).head(kept) = gram_.col(column).head(kept).transpose();
  }
  last_x_ = x;
  last_f_ = f;
  VectorXd next = x + f;
  const Index kept = std::min(taken_, depth);
  if (kept == 0) return next;
  // min |f - dF gamma| by the normal equations of columns scaled to length 1; dependent ones drop out.
  const auto dF = df_.leftCols(kept);
  const VectorXd inverse = gram_.diagonal().head(kept).cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd gram = inverse.asDiagonal() * gram_.topLeftCorner(kept, kept) * inverse.asDiagonal();
  const VectorXd right = inverse.asDiagonal() * (dF.transpose() * f);
  const VectorXd gamma = inverse.cwiseProduct(dense::basic_least_squares(gram, right));
  if (gamma.allFinite()) next.noalias() -= dx_.leftCols(kept) * gamma + dF * gamma;
  return next;
}

}  // namespace hb
