#include "hb/engine/exponents/inexact_roots.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

VectorXcd computed_roots(const VectorXd& a) {
  const Index n = a.size() - 1;
  MatrixXd companion = MatrixXd::Zero(n, n);
  companion.diagonal(-1).setOnes();
  companion.col(n - 1) = -a.head(n) / a(n);
  return dense::eigenvalues(companion);
}

// What a differs by from a_n prod_q (z - z_q) on the unit circle, and the rounding of that product.
double residue(const VectorXd& a, const VectorXcd& roots) {
  const Index n = roots.size();
  VectorXcd product = VectorXcd::Zero(n + 1);
  product(0) = a(n);
  double size = std::abs(a(n));
  for (Index q = 0; q < n; ++q) {
    for (Index r = q + 1; r > 0; --r) product(r) = product(r - 1) - roots(q) * product(r);
    product(0) *= -roots(q);
    size *= 1 + std::abs(roots(q));
  }
  return (product - a).cwiseAbs().sum() + 4 * eps * double(n) * size;
}

// Circles about one point, grown by steps until the polynomial is larger on one than its change.
struct Circles {
  double leading;  // |a_n|
  double change;
  double from;  // of the point from zero
  VectorXd distance;  // of each root from the point

  bool clear(double r) const {
    const double n = double(distance.size());
    const double least = leading * (distance.array() - r).abs().prod();
    return least > change * std::pow(std::max(1.0, from + r), n);
  }
  double smallest(double first, double most, double step) const {
    for (double r = first; r < most; r *= step)
      if (clear(r)) return r;
    return HUGE_VAL;
  }
};

}  // namespace

InexactRoots inexact_roots(const VectorXd& a, double change) {
  constexpr double step = 1.1, farthest = 8;
  const VectorXcd roots = computed_roots(a);
  const Index n = roots.size();
  InexactRoots result{roots, VectorXd::Constant(n, HUGE_VAL), roots.allFinite() ? 0 : HUGE_VAL};
  if (!roots.allFinite()) return result;
  const double total = change + residue(a, roots), leading = std::abs(a(n));
  for (Index j = 0; j < n; ++j) {
    const double size = std::abs(roots(j));
    const Circles circles{leading, total, size, (roots.array() - roots(j)).abs()};
    result.radius(j) = circles.smallest(std::max(eps * size, 1e-300), size / 2, step);
  }
  // What is not told apart lies within one circle about zero, which no other one's crosses.
  const Circles about_zero{leading, total, 0, roots.cwiseAbs()};
  for (bool more = true; more;) {
    more = false;
    double last = 0;
    for (Index j = 0; j < n; ++j)
      if (!std::isfinite(result.radius(j))) last = std::max(last, std::abs(roots(j)));
    if (last > 0) result.rest = about_zero.smallest(std::max(last, result.rest) * (1 + 1e-6), farthest, 1.02);
    for (Index j = 0; j < n; ++j) {
      const double size = std::abs(roots(j)), radius = result.radius(j);
      if (!std::isfinite(radius) || size - radius > result.rest || size + radius < result.rest) continue;
      result.radius(j) = HUGE_VAL;
      more = true;
    }
  }
  return result;
}

}  // namespace hb
