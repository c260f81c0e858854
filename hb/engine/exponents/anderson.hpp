// Anderson mixing for x <- x + f(x): the step that the last few secants say is best (D. G. Anderson, J. ACM 12 (1965)
// 547, doi:10.1145/321296.321305).
#pragma once

#include <Eigen/Core>

namespace hb {

class Anderson {
 public:
  // The next x, from x and f(x).
  Eigen::VectorXd step(const Eigen::VectorXd& x, const Eigen::VectorXd& f);

 private:
  static constexpr Eigen::Index depth = 8;
  Eigen::MatrixXd dx_, df_;  // the last differences, a ring of columns; none before the second step
  Eigen::MatrixXd gram_;  // df' df, of the columns taken so far
  Eigen::VectorXd last_x_, last_f_;
  Eigen::Index taken_ = 0;
};

}  // namespace hb
