// Symmetric matrices diagonalised side by side, against Eigen's one by one.
#include "lib/jacobi_rotations.hpp"

#include <gtest/gtest.h>

#include <random>

#include "lib/dense.hpp"

namespace hb {
namespace {

Eigen::MatrixXd matrix_in(const Eigen::ArrayXXd& packed, Eigen::Index row, Eigen::Index n) {
  return Eigen::MatrixXd::NullaryExpr(
      n, n, [&](Eigen::Index i, Eigen::Index j) { return packed(row, symmetric_entry(n, i, j)); });
}

// Random entries, the diagonal falling and rising from matrix to matrix, so that eigenvalues come out of order.
TEST(JacobiRotations, GiveEigenvaluesInOrderAndTurnTheOtherMatrix) {
  constexpr Eigen::Index n = 6, count = 37;
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  const auto random = [&] { return normal(engine); };
  Eigen::ArrayXXd A = Eigen::ArrayXXd::NullaryExpr(count, n * (n + 1) / 2, random);
  Eigen::ArrayXXd B = Eigen::ArrayXXd::NullaryExpr(count, n * (n + 1) / 2, random);
  for (Eigen::Index row = 0; row < count; ++row)
    for (Eigen::Index i = 0; i < n; ++i)
      A(row, symmetric_entry(n, i, i)) += 4 * normal(engine) * static_cast<double>(i);
  const Eigen::ArrayXXd given_A = A, given_B = B;
  ASSERT_TRUE(diagonalise_all(n, A, B));
  for (Eigen::Index row = 0; row < count; ++row) {
    const dense::SymmetricEigenpairs expected = dense::symmetric_eigenpairs(matrix_in(given_A, row, n));
    const Eigen::MatrixXd turned = expected.vectors.transpose() * matrix_in(given_B, row, n) * expected.vectors;
    const Eigen::MatrixXd diagonal = expected.values.asDiagonal();
    EXPECT_LT((matrix_in(A, row, n) - diagonal).norm(), 1e-13 * diagonal.norm());
    // Eigenvectors have either sign.
    EXPECT_LT((matrix_in(B, row, n).cwiseAbs() - turned.cwiseAbs()).norm(), 1e-6 * turned.norm());
  }
}

TEST(JacobiRotations, KeepWhatIsDiagonal) {
  Eigen::ArrayXXd A(2, 3), B = Eigen::ArrayXXd::Ones(2, 3);
  A << 1, 0, 2,  //
      5, 0, 5;
  const Eigen::ArrayXXd given = A;
  EXPECT_TRUE(diagonalise_all(2, A, B));
  EXPECT_TRUE((A == given).all());
  EXPECT_TRUE((B == 1).all());
}

}  // namespace
}  // namespace hb
