#include "hb/engine/system/periodic_system.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lib/dense.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Index root(Index squared) { return Index(std::lround(std::sqrt(double(squared)))); }

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
  NormalForm form{MatrixXd(n * n, N), MatrixXd(n * n, N)};
  const double omega = system.speed;
  for (Index j = 0; j < N; ++j) {
    const auto square = [n, j](const MatrixXd& samples) { return samples.col(j).reshaped(n, n); };
    const dense::Lu<double> M(MatrixXd(square(system.mass)));
    form.alpha.col(j) = (M.solve(MatrixXd(square(system.stiffness))) / (omega * omega)).reshaped();
    form.beta.col(j) = (M.solve(MatrixXd(square(system.damping))) / omega).reshaped();
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
