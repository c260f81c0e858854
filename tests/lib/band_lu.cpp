#include "lib/band_lu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lib/dense.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Without care for the diagonal, so that rows are interchanged.
MatrixXd random_band(Index n, Index half_width, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  MatrixXd A = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (std::abs(i - j) <= half_width) A(i, j) = (i == j ? 1e-3 : 1) * normal(engine);
  return A;
}

dense::BandLu factors_of(const MatrixXd& A, Index half_width) {
  dense::BandLu lu(A.rows(), half_width);
  for (Index i = 0; i < A.rows(); ++i)
    for (Index j = 0; j < A.cols(); ++j)
      if (std::abs(i - j) <= half_width) lu(i, j) = A(i, j);
  lu.factorise();
  return lu;
}

TEST(BandLu, SolvesAsDenseEliminationDoes) {
  for (const Index half_width : {0, 1, 3, 7})
    for (const Index n : {1, 2, 5, 40}) {
      const MatrixXd A = random_band(n, half_width, unsigned(10 * n + half_width));
      const dense::BandLu lu = factors_of(A, half_width);
      const dense::Lu<double> dense(A);
      VectorXd x = VectorXd::LinSpaced(n, 1, 2);
      const VectorXd b = A * x, expected = dense.solve(b);
      x = b;
      lu.solve_in_place(x);
      EXPECT_LT((x - expected).norm(), 1e-13 / dense.rcond() * expected.norm()) << n << ", " << half_width;
      EXPECT_NEAR(lu.smallest_pivot(), dense.pivots().cwiseAbs().minCoeff(), 1e-12 * A.cwiseAbs().maxCoeff());
    }
}

TEST(BandLu, TellsSingularMatricesAndThoseThatAreNoNumbers) {
  MatrixXd A = random_band(10, 2, 3);
  A.col(4).setZero();
  EXPECT_EQ(factors_of(A, 2).smallest_pivot(), 0);
  A(4, 4) = std::nan("");
  EXPECT_FALSE(factors_of(A, 2).smallest_pivot() > 0);
}

}  // namespace
}  // namespace hb
