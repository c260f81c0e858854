#include "hb/engine/system/periodic_system.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "lib/lanes.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Index root(Index squared) { return Index(std::lround(std::sqrt(double(squared)))); }

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// a <- a - factor b
void subtract(Index count, double factor, const double* __restrict b, double* __restrict a) {
  for (Index j = 0; j < count; ++j) a[j] -= factor * b[j];
}

// X becomes M^-1 X; M is used up. Gauss' elimination with row pivots.
void divide(Rows& M, Rows& X) {
  const Index n = M.rows(), width = X.cols();
  for (Index k = 0; k < n; ++k) {
    Index pivot = k;
    for (Index i = k + 1; i < n; ++i)
      if (std::abs(M(i, k)) > std::abs(M(pivot, k))) pivot = i;
    if (pivot != k) {
      M.row(k).swap(M.row(pivot));
      X.row(k).swap(X.row(pivot));
    }
    M(k, k) = 1 / M(k, k);
    for (Index i = k + 1; i < n; ++i) {
      const double factor = M(i, k) * M(k, k);
      for (Index j = k + 1; j < n; ++j) M(i, j) -= factor * M(k, j);
      subtract(width, factor, &X(k, 0), &X(i, 0));
    }
  }
  for (Index k = n - 1; k >= 0; --k) {
    for (Index j = 0; j < width; ++j) X(k, j) *= M(k, k);
    for (Index i = 0; i < k; ++i) subtract(width, M(i, k), &X(k, 0), &X(i, 0));
  }
}

// The same for the systems of neighbouring angles, one in each lane.
class SideBySide {
 public:
  explicit SideBySide(Index num_modes) : n_(num_modes), mass_(std::size_t(n_ * n_)), both_(std::size_t(2 * n_ * n_)) {}

  // Columns j, j + 1, .. of the form; false where a system of theirs needs exchange of rows.
  bool divide(const PeriodicSystem& system, Index j, NormalForm& form) {
    const double per_stiffness = 1 / (system.speed * system.speed), per_damping = 1 / system.speed;
    for (Index k = 0; k < n_; ++k)
      for (Index i = 0; i < n_; ++i) {
        const auto at = [&](const MatrixXd& samples) {
          return Lanes::of([&](Index lane) { return samples(i + n_ * k, j + lane); });
        };
        M(i, k) = at(system.mass);
        X(i, k) = per_stiffness * at(system.stiffness);
        X(i, n_ + k) = per_damping * at(system.damping);
      }
    if (!eliminate()) return false;
    for (Index k = 0; k < n_; ++k)
      for (Index i = 0; i < n_; ++i) {
        const Lanes::Values alpha = X(i, k).values(), beta = X(i, n_ + k).values();
        for (Index lane = 0; lane < Lanes::width; ++lane) {
          form.alpha(i + n_ * k, j + lane) = alpha[std::size_t(lane)];
          form.beta(i + n_ * k, j + lane) = beta[std::size_t(lane)];
        }
      }
    return true;
  }

 private:
  Lanes& M(Index i, Index k) { return mass_[std::size_t(n_ * i + k)]; }
  Lanes& X(Index i, Index k) { return both_[std::size_t(2 * n_ * i + k)]; }

  // X becomes M^-1 X; false where a pivot is not the largest of its column.
  bool eliminate() {
    const Index width = 2 * n_;
    for (Index k = 0; k < n_; ++k) {
      Lanes below = 0;
      for (Index i = k + 1; i < n_; ++i) below = max(abs(M(i, k)), below);
      const Lanes::Values largest = below.values(), own = abs(M(k, k)).values();
      for (std::size_t lane = 0; lane < own.size(); ++lane)
        if (!(own[lane] >= largest[lane])) return false;
      M(k, k) = 1 / M(k, k);
      for (Index i = k + 1; i < n_; ++i) {
        const Lanes factor = M(i, k) * M(k, k);
        for (Index j = k + 1; j < n_; ++j) M(i, j) -= factor * M(k, j);
        for (Index j = 0; j < width; ++j) X(i, j) -= factor * X(k, j);
      }
    }
    for (Index k = n_ - 1; k >= 0; --k) {
      for (Index j = 0; j < width; ++j) X(k, j) *= M(k, k);
      for (Index i = 0; i < k; ++i)
        for (Index j = 0; j < width; ++j) X(i, j) -= M(i, k) * X(k, j);
    }
    return true;
  }

  Index n_;
  std::vector<Lanes> mass_, both_;  // M; C/omega^2, B/omega
};

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
  Rows mass(n, n), both(n, 2 * n);  // M; C/omega^2, B/omega
  const double per_stiffness = 1 / (system.speed * system.speed), per_damping = 1 / system.speed;
  SideBySide lanes(n);
  Index exchanging = 0;  // angles up to here are done one by one
  for (Index j = 0; j < N; ++j) {
    if (j >= exchanging && j + Lanes::width <= N) {
      if (lanes.divide(system, j, form)) {
        j += Lanes::width - 1;
        continue;
      }
      exchanging = j + Lanes::width;
    }
    for (Index k = 0; k < n; ++k)
      for (Index i = 0; i < n; ++i) {
        const Index q = i + n * k;
        mass(i, k) = system.mass(q, j);
        both(i, k) = per_stiffness * system.stiffness(q, j);
        both(i, n + k) = per_damping * system.damping(q, j);
      }
    divide(mass, both);
    for (Index k = 0; k < n; ++k)
      for (Index i = 0; i < n; ++i) {
        form.alpha(i + n * k, j) = both(i, k);
        form.beta(i + n * k, j) = both(i, n + k);
      }
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
