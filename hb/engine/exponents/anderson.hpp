// Anderson mixing for x <- x + f(x): the step that the last few secants say is best (D. G. Anderson, J. ACM 12 (1965)
// 547, doi:10.1145/321296.321305).
#pragma once

#include <Eigen/Core>

namespace hb {

class Anderson {
 public:
  // The next x, from x and f(x).
  Eigen::VectorXd step(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::Ref<const Eigen::VectorXd>& f);

 private:
  static constexpr Eigen::Index depth = 8;
  using Weights = Eigen::Matrix<double, depth, 1>;
  using Square = Eigen::Matrix<double, depth, depth>;

  // How much of each of the first `kept` columns is taken.
  [[nodiscard]] Weights weights(Eigen::Index kept) const;

  // The last differences dx + df and df, a ring of columns; none before the second step.
  Eigen::MatrixXd moved_, df_;
  Square gram_;  // dF' dF, of the columns taken so far
  Weights right_;  // dF' f
  Eigen::VectorXd last_x_, last_f_;
  Eigen::Index taken_ = 0;
};

}  // namespace hb
