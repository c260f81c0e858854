#include <Eigen/QR>

#include "lib/dense.hpp"

namespace hb::dense {

bool is_invertible(const Eigen::MatrixXd& A) { return A.colPivHouseholderQr().isInvertible(); }

Eigen::VectorXd basic_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

Qr qr(const Eigen::MatrixXd& A) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> solver(A);
  return {solver.householderQ(), solver.matrixQR().triangularView<Eigen::Upper>()};
}

}  // namespace hb::dense
