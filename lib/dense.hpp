// Dense factorisations behind functions: their sources (dense_*.cpp) alone instantiate Eigen's solvers for matrices of
// run-time size, so that files which use them compile in seconds. Algorithms and roundings are Eigen's (of LU up to
// 1024 unknowns).
#pragma once

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <optional>

namespace hb::dense {

template <class Scalar>
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
template <class Scalar>
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

// max |A_ij|; 0 of an empty matrix.
[[nodiscard]] inline double largest(const Eigen::MatrixXd& A) { return A.size() > 0 ? A.cwiseAbs().maxCoeff() : 0.0; }

// P A = L U with row pivoting, A square. Scalar: double or std::complex<double>.
template <class Scalar>
class Lu {
 public:
  Lu();
  explicit Lu(const Eigen::Ref<const Matrix<Scalar>>& A);
  Lu(const Lu& other);
  Lu(Lu&&) noexcept;
  Lu& operator=(Lu other) noexcept;
  ~Lu();

  void compute(const Eigen::Ref<const Matrix<Scalar>>& A);
  // A^-1 b, A^-1 B.
  [[nodiscard]] Vector<Scalar> solve(const Vector<Scalar>& b) const;
  [[nodiscard]] Matrix<Scalar> solve(const Matrix<Scalar>& B) const;
  template <class Expression>
  [[nodiscard]] auto solve(const Eigen::MatrixBase<Expression>& rhs) const {
    if constexpr (Expression::ColsAtCompileTime == 1)
      return solve(Vector<Scalar>(rhs));
    else
      return solve(Matrix<Scalar>(rhs));
  }
  // A^-T b and A^-H b.
  [[nodiscard]] Vector<Scalar> solve_transposed(const Vector<Scalar>& b) const;
  [[nodiscard]] Vector<Scalar> solve_adjoint(const Vector<Scalar>& b) const;
  [[nodiscard]] Matrix<Scalar> inverse() const;
  // Estimated reciprocal condition number in the 1-norm.
  [[nodiscard]] double rcond() const;
  // The diagonal of U, and the sign of P: det A = sign prod u_ii.
  [[nodiscard]] Vector<Scalar> pivots() const;
  [[nodiscard]] int sign() const;
  // Of A; 0 before one was factorised.
  [[nodiscard]] Eigen::Index size() const;
  [[nodiscard]] bool all_finite() const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};
extern template class Lu<double>;
extern template class Lu<std::complex<double>>;

[[nodiscard]] Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);
[[nodiscard]] Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& A);
// Whether A has full rank, by Householder reflections with column pivoting.
[[nodiscard]] bool is_invertible(const Eigen::MatrixXd& A);

// A V = V diag(values), columns of V of length 1; no particular order. Empty where the iteration does not converge.
struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};
[[nodiscard]] std::optional<Eigenpairs> eigenpairs(const Eigen::MatrixXd& A);
[[nodiscard]] std::optional<Eigenpairs> eigenpairs(const Eigen::MatrixXcd& A);
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

// A = V diag(values) V^T, A symmetric, values ascending.
struct SymmetricEigenpairs {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
[[nodiscard]] SymmetricEigenpairs symmetric_eigenpairs(const Eigen::MatrixXd& A);
// A^(-1/2) of a symmetric positive definite matrix; empty if A has an eigenvalue <= 0.
[[nodiscard]] std::optional<Eigen::MatrixXd> inverse_square_root(const Eigen::MatrixXd& A);

// x with the smallest |A x - b|. Of columns that depend on others to rounding the first counts them as zero, the second
// takes the shortest x.
[[nodiscard]] Eigen::VectorXd basic_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
[[nodiscard]] Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

// A = Q R by Householder reflections: Q square, R of A's shape with zeros below the diagonal.
struct Qr {
  Eigen::MatrixXd Q, R;
};
[[nodiscard]] Qr qr(const Eigen::MatrixXd& A);

}  // namespace hb::dense
