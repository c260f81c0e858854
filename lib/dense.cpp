#include "lib/dense.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <utility>

namespace hb::dense {

template <class Scalar>
struct Lu<Scalar>::Factors {
  Eigen::PartialPivLU<Matrix<Scalar>> lu;
};

template <class Scalar>
Lu<Scalar>::Lu() : factors_(std::make_unique<Factors>()) {}
template <class Scalar>
Lu<Scalar>::Lu(const Eigen::Ref<const Matrix<Scalar>>& A) : Lu() {
  compute(A);
}
template <class Scalar>
Lu<Scalar>::Lu(const Lu& other) : factors_(std::make_unique<Factors>(*other.factors_)) {}
template <class Scalar>
Lu<Scalar>::Lu(Lu&&) noexcept = default;
template <class Scalar>
Lu<Scalar>& Lu<Scalar>::operator=(Lu other) noexcept {
  std::swap(factors_, other.factors_);
  return *this;
}
template <class Scalar>
Lu<Scalar>::~Lu() = default;

template <class Scalar>
void Lu<Scalar>::compute(const Eigen::Ref<const Matrix<Scalar>>& A) {
  factors_->lu.compute(A);
}
template <class Scalar>
Vector<Scalar> Lu<Scalar>::solve(const Vector<Scalar>& b) const {
  return factors_->lu.solve(b);
}
template <class Scalar>
Matrix<Scalar> Lu<Scalar>::solve(const Matrix<Scalar>& B) const {
  return factors_->lu.solve(B);
}
template <class Scalar>
Vector<Scalar> Lu<Scalar>::solve_transposed(const Vector<Scalar>& b) const {
  return factors_->lu.transpose().solve(b);
}
template <class Scalar>
Vector<Scalar> Lu<Scalar>::solve_adjoint(const Vector<Scalar>& b) const {
  return factors_->lu.adjoint().solve(b);
}
template <class Scalar>
Matrix<Scalar> Lu<Scalar>::inverse() const {
  return factors_->lu.inverse();
}
template <class Scalar>
double Lu<Scalar>::rcond() const {
  return factors_->lu.rcond();
}
template <class Scalar>
Vector<Scalar> Lu<Scalar>::pivots() const {
  return factors_->lu.matrixLU().diagonal();
}
template <class Scalar>
int Lu<Scalar>::sign() const {
  return factors_->lu.permutationP().determinant() < 0 ? -1 : 1;
}
template class Lu<double>;
template class Lu<std::complex<double>>;

Eigen::MatrixXd inverse(const Eigen::MatrixXd& A) { return A.inverse(); }
Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& A) { return A.inverse(); }
bool is_invertible(const Eigen::MatrixXd& A) { return Eigen::FullPivLU<Eigen::MatrixXd>(A).isInvertible(); }

std::optional<Eigenpairs> eigenpairs(const Eigen::MatrixXd& A) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  if (solver.info() != Eigen::Success) return std::nullopt;
  return Eigenpairs{solver.eigenvalues(), solver.eigenvectors()};
}
std::optional<Eigenpairs> eigenpairs(const Eigen::MatrixXcd& A) {
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> solver(A);
  if (solver.info() != Eigen::Success) return std::nullopt;
  return Eigenpairs{solver.eigenvalues(), solver.eigenvectors()};
}
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A) { return A.eigenvalues(); }

SymmetricEigenpairs symmetric_eigenpairs(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}
std::optional<Eigen::MatrixXd> inverse_square_root(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
  if (!(solver.eigenvalues().minCoeff() > 0)) return std::nullopt;
  return solver.operatorInverseSqrt();
}

Qr qr(const Eigen::MatrixXd& A) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> solver(A);
  return {solver.householderQ(), solver.matrixQR().triangularView<Eigen::Upper>()};
}

}  // namespace hb::dense
