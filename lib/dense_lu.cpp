#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

namespace hb::dense {

// Eigen's factorisation, of a large matrix a panel of columns at a time: with [A11; A21] = P [L11; L21] U11 the rest is
//     U12 = L11^-1 (P A)12,   A22 <- (P A)22 - L21 U12.
// Seconds of work look at the wish to stop between panels.
template <class Scalar>
class EndingLu : public Eigen::PartialPivLU<Matrix<Scalar>> {
  using Base = Eigen::PartialPivLU<Matrix<Scalar>>;

 public:
  void factor(const Eigen::Ref<const Matrix<Scalar>>& A) {
    constexpr Eigen::Index large = 1024, panel = 128;
    const Eigen::Index n = A.rows();
    if (n < large) {
      this->compute(A);
      return;
    }
    this->m_lu = A;
    this->m_l1_norm = A.cwiseAbs().colwise().sum().maxCoeff();
    this->m_rowsTranspositions.resize(n);
    int swaps = 0;
    for (Eigen::Index k = 0; k < n; k += panel) {
      end_if_wished();
      swaps += eliminate(k, std::min(panel, n - k));
    }
    this->m_det_p = swaps % 2 == 0 ? 1 : -1;
    this->m_p = this->m_rowsTranspositions;
    this->m_isInitialized = true;
  }

 private:
  // Columns k .. k+b-1 and all right of them.
  int eliminate(Eigen::Index k, Eigen::Index b) {
    Matrix<Scalar>& lu = this->m_lu;
    const Eigen::Index n = lu.rows(), rest = n - k - b;
    Eigen::Matrix<int, Eigen::Dynamic, 1> exchanged(b);
    int swaps = 0;
    Eigen::internal::partial_lu_impl<Scalar, Eigen::ColMajor, int, Eigen::Dynamic>::blocked_lu(
        n - k, b, &lu.coeffRef(k, k), lu.outerStride(), exchanged.data(), swaps);
    for (Eigen::Index j = 0; j < b; ++j) {
      const Eigen::Index other = k + exchanged(j);
      this->m_rowsTranspositions.coeffRef(k + j) = static_cast<int>(other);
      if (other == k + j) continue;
      lu.row(k + j).head(k).swap(lu.row(other).head(k));
      lu.row(k + j).tail(rest).swap(lu.row(other).tail(rest));
    }
    if (rest > 0) {
      auto upper = lu.block(k, k + b, b, rest);
      lu.block(k, k, b, b).template triangularView<Eigen::UnitLower>().solveInPlace(upper);
      lu.bottomRightCorner(rest, rest).noalias() -= lu.block(k + b, k, rest, b) * upper;
    }
    return swaps;
  }
};

template <class Scalar>
struct Lu<Scalar>::Factors {
  EndingLu<Scalar> lu;
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
  factors_->lu.factor(A);
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
template <class Scalar>
Eigen::Index Lu<Scalar>::size() const {
  return factors_->lu.rows();
}
template <class Scalar>
bool Lu<Scalar>::all_finite() const {
  return factors_->lu.matrixLU().allFinite();
}
template class Lu<double>;
template class Lu<std::complex<double>>;

Eigen::MatrixXd inverse(const Eigen::MatrixXd& A) {
  if (A.isDiagonal(0)) return A.diagonal().cwiseInverse().asDiagonal();
  return A.inverse();
}
Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& A) { return A.inverse(); }

}  // namespace hb::dense
