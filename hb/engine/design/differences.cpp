#include "hb/engine/design/differences.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::optional<MatrixXd> difference_jacobian(const std::function<OptionalVector(const VectorXd& x)>& f,
                                            const VectorXd& x, const VectorXd& lower, const VectorXd& upper,
                                            const VectorXd& step) {
  MatrixXd jacobian;
  const auto moved = [&](Index i, double by) -> OptionalVector {
    VectorXd y = x;
    y(i) += by;
    OptionalVector values = f(y);
    if (values && !values->allFinite()) values.reset();
    return values;
  };
  for (Index i = 0; i < x.size(); ++i) {
    const double h = step(i);
    const bool low = x(i) - h<lower(i), high = x(i) + h> upper(i);
    OptionalVector slope;
    if (low || high) {
      const double s = low ? h : -h;
      const OptionalVector here = moved(i, 0), near = moved(i, s), far = moved(i, 2 * s);
      if (here && near && far) slope = (4 * *near - *far - 3 * *here) / (2 * s);
    } else {
      const OptionalVector more = moved(i, h), less = moved(i, -h);
      if (more && less) slope = (*more - *less) / (2 * h);
    }
    if (!slope) return std::nullopt;
    if (i == 0) jacobian.resize(slope->size(), x.size());
    jacobian.col(i) = *slope;
  }
  return jacobian;
}

}  // namespace hb
