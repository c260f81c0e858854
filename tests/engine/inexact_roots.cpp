#include "hb/engine/exponents/inexact_roots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "lib/dense.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

// scale prod (z - root), with the conjugates of the roots off the real axis.
VectorXd polynomial(double scale, const std::vector<cplx>& roots) {
  VectorXcd a = VectorXcd::Constant(1, scale);
  const auto times = [&](cplx root) {
    VectorXcd next = VectorXcd::Zero(a.size() + 1);
    next.tail(a.size()) = a;
    next.head(a.size()) -= root * a;
    a = next;
  };
  for (const cplx root : roots) {
    times(root);
    if (root.imag() != 0) times(std::conj(root));
  }
  return a.real();
}

VectorXcd roots_of(const VectorXd& a) {
  const Index n = a.size() - 1;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  companion.col(n - 1) = -a.head(n) / a(n);
  return dense::eigenvalues(companion);
}

// Polynomials within the change, which is one of the coefficients' sum: as many roots of each in every circle, and as
// many within `rest`, as of the given one.
void expect_covered(const VectorXd& a, double change, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const InexactRoots inexact = inexact_roots(a, change);
  const auto inside = [](const VectorXcd& roots, cplx centre, double radius) {
    return ((roots.array() - centre).abs() <= radius).count();
  };
  for (int trial = 0; trial < 20; ++trial) {
    VectorXd e = VectorXd::NullaryExpr(a.size(), [&] { return uniform(generator); });
    e *= 0.999 * change / e.cwiseAbs().sum();
    const VectorXcd moved = roots_of(a + e);
    for (Index j = 0; j < inexact.value.size(); ++j) {
      if (!std::isfinite(inexact.radius(j))) continue;
      const cplx centre = inexact.value(j);
      EXPECT_EQ(inside(moved, centre, inexact.radius(j)), inside(inexact.value, centre, inexact.radius(j)));
    }
    if (!std::isfinite(inexact.rest)) continue;
    EXPECT_EQ(inside(moved, 0, inexact.rest), inside(inexact.value, 0, inexact.rest));
  }
}

TEST(InexactRoots, PolynomialsWithinTheChangeHaveAsManyInEveryCircle) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  unsigned seed = 0;
  for (const double change : {1e-12, 1e-8, 1e-5, 1e-3})
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<cplx> roots;
      for (int q = 0; q < 1 + trial % 4; ++q) roots.emplace_back(uniform(generator), std::abs(uniform(generator)));
      roots.emplace_back(uniform(generator), 0);
      expect_covered(polynomial(0.7, roots), change, ++seed);
    }
}

// A pair on the unit circle, and roots too near to zero to be told from one another.
TEST(InexactRoots, TheLargestAreFoundBesideOthersNearZero) {
  const cplx pair = std::polar(1.0, 0.07);
  const VectorXd a = polynomial(0.25, {pair, {1e-4, 1e-5}, {1e-9, 0}, {-1e-12, 1e-30}, {1e-20, 1e-21}, {1e-30, 0}});
  const double change = 1e-6;
  const InexactRoots inexact = inexact_roots(a, change);
  int found = 0;
  for (Index j = 0; j < inexact.value.size(); ++j)
    if (std::isfinite(inexact.radius(j)) && std::abs(inexact.value(j)) > 0.5) {
      ++found;
      // change/|P'| and a little.
      EXPECT_LT(inexact.radius(j), 1.2 * change / (0.25 * 2 * std::sin(0.07)));
      EXPECT_LT(std::abs(inexact.value(j) - (inexact.value(j).imag() > 0 ? pair : std::conj(pair))), inexact.radius(j));
    }
  EXPECT_EQ(found, 2);
  EXPECT_LT(inexact.rest, 0.5);
  expect_covered(a, change, 99);
}

TEST(InexactRoots, OfDoubleOnesTheRadiusIsTheRootOfTheChange) {
  const double change = 1e-8;
  const InexactRoots inexact = inexact_roots(polynomial(1, {0.8, 0.8, -0.3}), change);
  for (Index j = 0; j < 3; ++j) {
    const bool twice = inexact.value(j).real() > 0;
    EXPECT_LT(inexact.radius(j), twice ? 2 * std::sqrt(change) : 2 * change);
    EXPECT_GT(inexact.radius(j), twice ? 0.5 * std::sqrt(change) : 0.5 * change);
  }
  EXPECT_EQ(inexact.rest, 0);
}

TEST(InexactRoots, NoneIsSaidToBeKnownWhereTheChangeIsAsLargeAsThePolynomial) {
  const InexactRoots inexact = inexact_roots(polynomial(1, {0.8, -0.3}), 10);
  EXPECT_EQ(inexact.radius.minCoeff(), HUGE_VAL);
  EXPECT_EQ(inexact.rest, HUGE_VAL);
}

}  // namespace
}  // namespace hb
