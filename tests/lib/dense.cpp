// Elimination of large matrices, which is the program's own above 1024 unknowns.
#include "lib/dense.hpp"

#include <gtest/gtest.h>

#include <random>

#include "lib/stop_wish.hpp"

namespace hb {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index n) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(engine); });
}

// Signs and pivots of a product of known factors, rows permuted.
TEST(Dense, LargeEliminationSolvesAndKnowsPivotsAndSign) {
  constexpr Eigen::Index n = 1100;
  const Eigen::MatrixXd A = random_matrix(n);
  const dense::Lu<double> lu(A);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(n, -1, 1);
  const Eigen::VectorXd found = lu.solve(Eigen::VectorXd(A * x)), turned = lu.solve_transposed(A.transpose() * x);
  EXPECT_LT((A * found - A * x).norm(), 1e-11 * A.norm() * x.norm());
  EXPECT_LT((A.transpose() * (turned - x)).norm(), 1e-11 * A.norm() * x.norm());
  // A and its first 1000 rows and columns, which Eigen eliminates, have determinants that Schur's complement relates.
  constexpr Eigen::Index k = 1000, rest = n - k;
  const dense::Lu<double> corner(A.topLeftCorner(k, k));
  const Eigen::MatrixXd between = corner.solve(Eigen::MatrixXd(A.topRightCorner(k, rest)));
  const dense::Lu<double> complement(A.bottomRightCorner(rest, rest) - A.bottomLeftCorner(rest, k) * between);
  const auto log_size = [](const dense::Lu<double>& of) { return of.pivots().cwiseAbs().array().log().sum(); };
  EXPECT_NEAR(log_size(lu), log_size(corner) + log_size(complement), 1e-8);
  const auto sign = [](const dense::Lu<double>& of) {
    return (of.pivots().array() < 0).count() % 2 == 0 ? of.sign() : -of.sign();
  };
  EXPECT_EQ(sign(lu), sign(corner) * sign(complement));
  EXPECT_GT(lu.rcond(), 1e-8);
  EXPECT_LT(lu.rcond(), 1);
}

TEST(Dense, LargeEliminationEndsWhereItIsWished) {
  const Eigen::MatrixXcd A = random_matrix(1100).cast<std::complex<double>>();
  long looks = 0;
  const StopWish wish([&] { return ++looks == 5; });
  EXPECT_THROW(dense::Lu<std::complex<double>>{A}, Stopped);
}

TEST(Dense, InverseOfADiagonalMatrixIsExact) {
  const Eigen::Vector3d diagonal(4, -0.5, 1e-200);
  const Eigen::MatrixXd D = diagonal.asDiagonal();
  const Eigen::MatrixXd inverse = dense::inverse(D);
  EXPECT_EQ(inverse, Eigen::MatrixXd(diagonal.cwiseInverse().asDiagonal()));
  Eigen::MatrixXd nearly = D;
  nearly(0, 1) = 2;
  EXPECT_LE((nearly * dense::inverse(nearly) - Eigen::MatrixXd::Identity(3, 3)).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace hb
