#include "hb/engine/boundaries/discriminant_patch.hpp"

#include <algorithm>

#include "lib/chebyshev.hpp"
#include "lib/constants.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ChebyshevProduct::ChebyshevProduct(const MatrixXd& values)
    : c_(to_coefficients(values.rows() - 1).transpose() * values * to_coefficients(values.cols() - 1)),
      rows_(c_.rows()),
      columns_(c_.cols()) {
  const double least = 2 * eps * c_.cwiseAbs().maxCoeff();
  while (rows_ > 1 && c_.row(rows_ - 1).cwiseAbs().maxCoeff() <= least) --rows_;
  while (columns_ > 1 && c_.col(columns_ - 1).cwiseAbs().maxCoeff() <= least) --columns_;
  dropped_ = c_.bottomRows(c_.rows() - rows_).cwiseAbs().sum() +
             c_.topRightCorner(rows_, c_.cols() - columns_).cwiseAbs().sum();
}

double ChebyshevProduct::tail(std::size_t axis) const {
  const VectorXd sums = axis == 0 ? VectorXd(c_.cwiseAbs().rowwise().sum()) : c_.cwiseAbs().colwise().sum().transpose();
  return sums.size() == 1 ? 0 : sums.tail(std::min<Index>(3, sums.size() - 1)).maxCoeff();
}

double ChebyshevProduct::at(double u, double v) const {
  return chebyshev(u, rows_ - 1).dot(c_.topLeftCorner(rows_, columns_) * chebyshev(v, columns_ - 1));
}

VectorXd ChebyshevProduct::along(std::size_t axis, double other) const {
  if (axis == 0) return c_.topLeftCorner(rows_, columns_) * chebyshev(other, columns_ - 1);
  return c_.topLeftCorner(rows_, columns_).transpose() * chebyshev(other, rows_ - 1);
}

MatrixXd ChebyshevProduct::at_all(const VectorXd& u, const VectorXd& v) const {
  const auto table = [](const VectorXd& t, Index degree) {
    MatrixXd T(t.size(), degree + 1);
    T.col(0).setOnes();
    if (degree > 0) T.col(1) = t;
    for (Index k = 2; k <= degree; ++k) T.col(k) = 2 * t.cwiseProduct(T.col(k - 1)) - T.col(k - 2);
    return T;
  };
  const MatrixXd first = table(u, rows_ - 1) * c_.topLeftCorner(rows_, columns_);
  return first * table(v, columns_ - 1).transpose();
}

DiscriminantValue DiscriminantPatch::at(double x, double y) const {
  const double u = box.unit(0, x), v = box.unit(1, y);
  return {value.at(u, v), limit.at(u, v), error, damping.at(u, v), damping_error, speed.at(u, v), speed_error};
}

bool settled(const DiscriminantValue& at, bool undamped, SettledGrowth& growth) {
  // Ten times the error; beyond it exponents that are known to 1e-9 tell what they are.
  constexpr double safe = 10, least_distance = 1e-6, least_growth = 1e-6, growth_tolerance = 1e-8;
  const double size = std::abs(at.value), distance = std::max(least_distance, safe * at.error);
  if (!(std::abs(size - 1) > distance)) return false;
  growth.real = size > 1;
  double s = undamped ? 0 : -at.damping / 2, error = undamped ? 0 : at.damping_error / 2 + eps * std::abs(at.damping);
  if (growth.real) {
    const double sinh = std::sqrt((size - 1) * (size + 1)), mu = std::log(size + sinh) / two_pi;
    s += mu;
    error += at.error / (two_pi * std::sqrt((size - at.error - 1) * (size - at.error + 1))) + 4 * eps * mu;
  } else if (undamped) {
    growth = {Verdict::bounded, 0, 0, false};
    return true;
  }
  error += (at.speed_error / at.speed + 4 * eps) * std::abs(s);
  if (!(error <= growth_tolerance * std::max(1.0, std::abs(s)))) return false;
  if (!(std::abs(s) > std::max(least_growth, safe * error))) return false;
  growth.verdict = s > 0 ? Verdict::unstable : Verdict::stable;
  growth.growth_rate = at.speed * s;
  growth.growth_error = at.speed * error;
  return true;
}

}  // namespace hb
