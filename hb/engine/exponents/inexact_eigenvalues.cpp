#include "hb/engine/exponents/inexact_eigenvalues.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <vector>

#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

// With V^-1 M V = D, |v_j| = 1 and w_i the rows of V^-1, a change E adds |w_i E v_j| <= |w_i| |E|. Scaled so that row
// i's disc is small, its radius is |w_i| |E| (1 + (n-1)/n) and that of row j is |w_j| |E| (2n - 1). Zero: not apart.
struct Discs {
  VectorXd radii;
  double rest = HUGE_VAL;  // bound on the moduli of those that are not apart: their unscaled radii are |w_i| |E| n
};
Discs gershgorin_discs(const VectorXcd& value, const MatrixXcd& V, double change) {
  const Index n = value.size();
  const MatrixXcd inverse = dense::inverse(V);
  const VectorXd condition = inverse.rowwise().norm();
  // The eigenvectors' own rounding errors must not matter.
  if (!(condition.norm() * double(n * n) * eps < 1e-3)) return {VectorXd::Zero(n)};
  const VectorXd weighted = condition * (change + 4 * eps * double(n) * value.cwiseAbs().maxCoeff());
  Discs discs{2 * weighted, 0};
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (j != i && !(std::abs(value(i) - value(j)) > 2 * weighted(i) + 2 * double(n) * weighted(j)))
        discs.radii(i) = 0;
  for (Index i = 0; i < n; ++i)
    if (discs.radii(i) == 0) discs.rest = std::max(discs.rest, std::abs(value(i)) + double(n) * weighted(i));
  return discs;
}

double circle_radius(const MatrixXd& M, cplx mu, double change) {
  const Index n = M.rows();
  double r = std::max(change, 1e-300);
  for (int attempt = 0; attempt < 200; ++attempt, r *= 2) {
    bool separated = true;
    for (int q = 0; q < 8 && separated; ++q) {
      const cplx z = mu + r * std::polar(1.0, std::numbers::pi / 4 * (q + 0.5));
      const MatrixXcd shifted = z * MatrixXcd::Identity(n, n) - M.cast<cplx>();
      // 1/sigma_min <= |shifted^-1| (Frobenius).
      separated = 2 * change * dense::inverse(shifted).norm() < 1;
    }
    if (separated) return r;
  }
  return HUGE_VAL;
}

}  // namespace

// Row j scaled by a < 1 has the disc C_jj + a sum_k C_jk, the others sum_l C_kl + (1/a - 1) C_kj: apart for
// a >= C_kj/(|value_j - value_k| - ..), which leaves C_jj and terms of second order.
VectorXd gershgorin_radii(const VectorXcd& value, const MatrixXd& change) {
  const Index n = value.size();
  if (!change.allFinite()) return VectorXd::Constant(n, HUGE_VAL);
  const VectorXd sums = change.rowwise().sum();
  VectorXd radii = sums;
  std::vector<Index> group(static_cast<std::size_t>(n));
  std::iota(group.begin(), group.end(), Index(0));
  for (Index j = 0; j < n; ++j) {
    double scale = 0;
    for (Index k = 0; k < n; ++k) {
      if (k == j) continue;
      const double gap = std::abs(value(j) - value(k)) - sums(j) - sums(k);
      scale = gap > 0 ? std::max(scale, 2 * change(k, j) / gap) : HUGE_VAL;
    }
    if (scale < 1) {
      radii(j) = change(j, j) + scale * (sums(j) - change(j, j));
      continue;
    }
    for (Index k = 0; k < n; ++k)
      if (!(std::abs(value(j) - value(k)) > sums(j) + sums(k))) {
        const Index from = group[static_cast<std::size_t>(k)], to = group[static_cast<std::size_t>(j)];
        std::replace(group.begin(), group.end(), from, to);
      }
  }
  VectorXd result = radii;
  for (Index j = 0; j < n; ++j)
    for (Index k = 0; k < n; ++k)
      if (k != j && group[static_cast<std::size_t>(k)] == group[static_cast<std::size_t>(j)])
        result(j) = std::max({result(j), sums(j), std::abs(value(j) - value(k)) + sums(k)});
  return result;
}

InexactEigenvalues inexact_eigenvalues(const MatrixXd& M, double change, bool leading_only) {
  const Index n = M.rows();
  if (n == 1) return {VectorXcd::Constant(1, M(0, 0)), VectorXd::Constant(1, change)};
  const std::optional<dense::Eigenpairs> pairs = dense::eigenpairs(M);
  if (!pairs) return {VectorXcd::Zero(n), VectorXd::Constant(n, HUGE_VAL)};
  InexactEigenvalues result{pairs->values, VectorXd::Zero(n)};
  const Discs discs = gershgorin_discs(result.value, pairs->vectors, change);
  result.radius = discs.radii;
  const bool rest_is_far = leading_only && discs.rest < 0.1 * result.value.cwiseAbs().maxCoeff();
  for (Index i = 0; i < n; ++i) {
    if (result.radius(i) > 0) continue;
    if (rest_is_far) {
      result.radius(i) = std::abs(result.value(i)) + discs.rest;
      continue;
    }
    // The second of a complex pair has the first one's circle.
    const bool conjugate = i > 0 && result.value(i) == std::conj(result.value(i - 1));
    result.radius(i) = conjugate ? result.radius(i - 1) : circle_radius(M, result.value(i), change);
  }
  return result;
}

}  // namespace hb
