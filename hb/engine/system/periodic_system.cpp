#include "hb/engine/system/periodic_system.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Index root(Index squared) { return Index(std::lround(std::sqrt(double(squared)))); }

// A and B, column-major, become M^-1 A and M^-1 B; M is used up. Gauss' elimination with row pivots, a column at a
// time.
void divide(MatrixXd& M, double* A, double* B) {
  const Index n = M.rows();
  const auto eliminate = [&](Index k, Index pivot, double* column) {
    std::swap(column[k], column[pivot]);
    for (Index i = k + 1; i < n; ++i) column[i] -= M(i, k) * column[k];
  };
  for (Index k = 0; k < n; ++k) {
    Index pivot = k;
    for (Index i = k + 1; i < n; ++i)
      if (std::abs(M(i, k)) > std::abs(M(pivot, k))) pivot = i;
    std::swap(M(k, k), M(pivot, k));
    for (Index i = k + 1; i < n; ++i) M(i, k) /= M(k, k);
    for (Index j = k + 1; j < n; ++j) eliminate(k, pivot, &M(0, j));
    for (Index j = 0; j < n; ++j) {
      eliminate(k, pivot, A + n * j);
      eliminate(k, pivot, B + n * j);
    }
  }
  for (Index k = n - 1; k >= 0; --k)
    for (Index j = 0; j < n; ++j)
      for (double* column : {A + n * j, B + n * j}) {
        column[k] /= M(k, k);
        for (Index i = 0; i < k; ++i) column[i] -= M(i, k) * column[k];
      }
}

}  // namespace

Index PeriodicSystem::num_modes() const { return root(mass.rows()); }
Index NormalForm::num_modes() const { return root(alpha.rows()); }

VectorXd NormalForm::weights() const {
  const Index n = num_modes();
  VectorXd w(n);
  for (Index i = 0; i < n; ++i) w(i) = std::max(1.0, std::sqrt(std::abs(alpha.row(i * (n + 1)).mean())));
  return w;
}

NormalForm normal_form(const PeriodicSystem& system) {
  const Index n = system.num_modes(), N = system.num_samples();
  const auto fits = [&](const MatrixXd& samples) { return samples.rows() == n * n && samples.cols() == N; };
  if (n < 1 || N < 1 || !fits(system.mass) || !fits(system.damping) || !fits(system.stiffness))
    throw std::invalid_argument("PeriodicSystem: mass, damping and stiffness need n*n x N samples each");
  if (!(system.speed > 0 && std::isfinite(system.speed)))
    throw std::invalid_argument("PeriodicSystem: speed must be positive and finite");
  NormalForm form{system.stiffness / (system.speed * system.speed), system.damping / system.speed};
  MatrixXd mass(n, n);
  for (Index j = 0; j < N; ++j) {
    mass = system.mass.col(j).reshaped(n, n);
    divide(mass, form.alpha.col(j).data(), form.beta.col(j).data());
  }
  if (!form.alpha.allFinite() || !form.beta.allFinite())
    throw std::invalid_argument("PeriodicSystem: the mass is singular, or an entry is not finite");
  return form;
}

CoefficientErrors difference(const NormalForm& a, const NormalForm& b) {
  const Index n = a.num_modes();
  const VectorXd w = a.weights();
  CoefficientErrors errors;
  for (Index k = 0; k < n; ++k)
    errors.alpha = std::max(errors.alpha,
                            (a.alpha.middleRows(n * k, n) - b.alpha.middleRows(n * k, n)).cwiseAbs().maxCoeff() / w(k));
  errors.beta = (a.beta - b.beta).cwiseAbs().maxCoeff();
  return errors;
}

}  // namespace hb
