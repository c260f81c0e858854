#include "hb/engine/exponents/inexact_eigenvalues.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd random_matrix(Index n, std::mt19937& generator) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return MatrixXd::NullaryExpr(n, n, [&] { return uniform(generator); });
}

// For any E within the change, every circle holds an eigenvalue of M + E.
void expect_covered(const MatrixXd& M, double change, std::mt19937& generator) {
  const InexactEigenvalues inexact = inexact_eigenvalues(M, change);
  ASSERT_EQ(inexact.value.size(), M.rows());
  for (int trial = 0; trial < 20; ++trial) {
    MatrixXd E = random_matrix(M.rows(), generator);
    E *= 0.999 * change / E.operatorNorm();
    const Eigen::VectorXcd moved = MatrixXd(M + E).eigenvalues();
    for (Index i = 0; i < inexact.value.size(); ++i) {
      ASSERT_TRUE(std::isfinite(inexact.radius(i)));
      EXPECT_LE((moved.array() - inexact.value(i)).abs().minCoeff(), inexact.radius(i));
    }
  }
}

TEST(InexactEigenvalues, RandomMatricesStayInTheirCircles) {
  std::mt19937 generator(7);
  for (const Index n : {1, 2, 3, 6, 10})
    for (const double change : {1e-12, 1e-8, 1e-4}) expect_covered(random_matrix(n, generator), change, generator);
}

TEST(InexactEigenvalues, DefectiveOnesGetTheRootThatTheyNeed) {
  std::mt19937 generator(8);
  for (const Index n : {2, 3, 4}) {
    MatrixXd M = MatrixXd::Identity(n, n) * 0.7;
    M.diagonal(1).setOnes();
    const double change = 1e-9;
    expect_covered(M, change, generator);
    const double root = std::pow(change, 1.0 / double(n));
    EXPECT_GE(inexact_eigenvalues(M, change).radius.minCoeff(), root);
    EXPECT_LE(inexact_eigenvalues(M, change).radius.maxCoeff(), 30 * root);
  }
}

TEST(InexactEigenvalues, WellConditionedOnesMoveByLittleMoreThanTheChange) {
  const MatrixXd M = Eigen::Vector4d(1, -0.5, 0.25, 2).asDiagonal();
  EXPECT_LE(inexact_eigenvalues(M, 1e-10).radius.maxCoeff(), 3e-10);
}

}  // namespace
}  // namespace hb
