#include "hb/engine/exponents/inexact_eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

constexpr double eps = 2.220446049250313e-16;

// With V^-1 M V = D, |v_j| = 1 and w_i the rows of V^-1, a change E adds |w_i E v_j| <= |w_i| |E|. Scaled so that row
// i's disc is small, its radius is |w_i| |E| (1 + (n-1)/n) and that of row j is |w_j| |E| (2n - 1). Zero: not apart.
struct Discs {
  VectorXd radii;
  double rest = HUGE_VAL;  // bound on the moduli of those that are not apart: their unscaled radii are |w_i| |E| n
};
Discs gershgorin_discs(const VectorXcd& value, const MatrixXcd& V, double change) {
  const Index n = value.size();
  const MatrixXcd inverse = Eigen::PartialPivLU<MatrixXcd>(V).inverse();
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
      separated = 2 * change * shifted.inverse().norm() < 1;
    }
    if (separated) return r;
  }
  return HUGE_VAL;
}

}  // namespace

InexactEigenvalues inexact_eigenvalues(const MatrixXd& M, double change, bool leading_only) {
  const Index n = M.rows();
  if (n == 1) return {VectorXcd::Constant(1, M(0, 0)), VectorXd::Constant(1, change)};
  const Eigen::EigenSolver<MatrixXd> solver(M);
  InexactEigenvalues result{solver.eigenvalues(), VectorXd::Zero(n)};
  const Discs discs = gershgorin_discs(result.value, solver.eigenvectors(), change);
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
