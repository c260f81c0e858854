#include "lib/positive_definite.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>
#include <vector>

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Another random matrix in each lane, its eigenvalues from 1 to 1e6.
TEST(PositiveDefinite, EveryLaneHasItsOwnSolution) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const Index n : {1, 2, 5, 8, 20}) {
    SCOPED_TRACE(n);
    std::vector<MatrixXd> A;
    std::vector<VectorXd> x;
    for (Index lane = 0; lane < Lanes::width; ++lane) {
      const MatrixXd any = MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
      const MatrixXd Q = any.householderQr().householderQ();
      A.push_back(Q * VectorXd::LinSpaced(n, 0, 6).unaryExpr([](double e) { return std::pow(10, e); }).asDiagonal() *
                  Q.transpose());
      x.push_back(VectorXd::NullaryExpr(n, [&] { return normal(random); }));
    }
    const auto lanes = [](const auto& value) {
      return Lanes::of([&](Index lane) { return value(static_cast<std::size_t>(lane)); });
    };
    std::vector<Lanes> matrix, right;
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)  // the upper triangle is not looked at
        matrix.push_back(i < j ? Lanes(std::nan("")) : lanes([&](std::size_t lane) { return A[lane](i, j); }));
    for (Index i = 0; i < n; ++i) right.push_back(lanes([&](std::size_t lane) { return (A[lane] * x[lane])(i); }));
    ASSERT_TRUE(solve_positive_definite(n, matrix.data(), right.data()));
    for (Index i = 0; i < n; ++i) {
      const Lanes::Values found = right[static_cast<std::size_t>(i)].values();
      for (std::size_t lane = 0; lane < found.size(); ++lane)
        EXPECT_NEAR(found[lane], x[lane](i), 1e-8 * x[lane].norm()) << lane;
    }
  }
}

TEST(PositiveDefinite, OneLaneThatIsNotSpoilsAll) {
  for (const double last : {1.0, 0.0, -1.0, std::nan("")}) {
    // [[2, 1], [1, (1 + last)/2]] has the determinant `last`.
    std::vector<Lanes> A = {2.0, 1.0, 1.0,
                            Lanes::of([last](Index lane) { return lane + 1 == Lanes::width ? (1 + last) / 2 : 1.0; })};
    std::vector<Lanes> b = {1.0, 1.0};
    EXPECT_EQ(solve_positive_definite(2, A.data(), b.data()), last > 0) << last;
  }
}

}  // namespace
}  // namespace hb
