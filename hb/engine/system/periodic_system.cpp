#include "hb/engine/system/periodic_system.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "lib/lanes.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Index root(Index squared) { return Index(std::lround(std::sqrt(double(squared)))); }

// M^-1 C/omega^2 and M^-1 B/omega at one angle (double), or at neighbouring ones side by side (Lanes), by Gauss'
// elimination with row pivots.
template <class Number>
class Division {
  static constexpr bool side_by_side = std::is_same_v<Number, Lanes>;

 public:
  explicit Division(Index num_modes) : n_(num_modes), mass_(std::size_t(n_ * n_)), both_(std::size_t(2 * n_ * n_)) {}

  // Columns of the form from j on; false where angles side by side need exchange of rows.
  bool divide(const PeriodicSystem& system, Index j, NormalForm& form) {
    const double per_stiffness = 1 / (system.speed * system.speed), per_damping = 1 / system.speed;
    for (Index k = 0; k < n_; ++k)
      for (Index i = 0; i < n_; ++i) {
        const Index q = i + n_ * k;
        M(i, k) = load(system.mass, q, j);
        X(i, k) = per_stiffness * load(system.stiffness, q, j);
        X(i, n_ + k) = per_damping * load(system.damping, q, j);
      }
    if (!eliminate()) return false;
    for (Index k = 0; k < n_; ++k)
      for (Index i = 0; i < n_; ++i) {
        const Index q = i + n_ * k;
        store(X(i, k), form.alpha, q, j);
        store(X(i, n_ + k), form.beta, q, j);
      }
    return true;
  }

 private:
  Number& M(Index i, Index k) { return mass_[std::size_t(n_ * i + k)]; }
  Number& X(Index i, Index k) { return both_[std::size_t(2 * n_ * i + k)]; }

  static Number load(const MatrixXd& samples, Index q, Index j) {
    if constexpr (side_by_side)
      return Lanes::of([&](Index lane) { return samples(q, j + lane); });
    else
      return samples(q, j);
  }
  static void store(const Number& value, MatrixXd& samples, Index q, Index j) {
    if constexpr (side_by_side) {
      const Lanes::Values values = value.values();
      for (Index lane = 0; lane < Lanes::width; ++lane) samples(q, j + lane) = values[std::size_t(lane)];
    } else {
      samples(q, j) = value;
    }
  }

  // The largest number of column k from row k on to row k.
  bool pivot(Index k) {
    if constexpr (side_by_side) {
      Lanes below = 0;
      for (Index i = k + 1; i < n_; ++i) below = max(abs(M(i, k)), below);
      const Lanes::Values largest = below.values(), own = abs(M(k, k)).values();
      for (std::size_t lane = 0; lane < own.size(); ++lane)
        if (!(own[lane] >= largest[lane])) return false;
    } else {
      Index from = k;
      for (Index i = k + 1; i < n_; ++i)
        if (std::abs(M(i, k)) > std::abs(M(from, k))) from = i;
      if (from != k) {
        std::swap_ranges(&M(k, 0), &M(k, 0) + n_, &M(from, 0));
        std::swap_ranges(&X(k, 0), &X(k, 0) + 2 * n_, &X(from, 0));
      }
    }
    return true;
  }

  // X becomes M^-1 X; M is used up.
  bool eliminate() {
    for (Index k = 0; k < n_; ++k) {
      if (!pivot(k)) return false;
      M(k, k) = 1.0 / M(k, k);
      for (Index i = k + 1; i < n_; ++i) {
        const Number factor = M(i, k) * M(k, k);
        for (Index j = k + 1; j < n_; ++j) M(i, j) -= factor * M(k, j);
        for (Index j = 0; j < 2 * n_; ++j) X(i, j) -= factor * X(k, j);
      }
    }
    for (Index k = n_ - 1; k >= 0; --k) {
      for (Index j = 0; j < 2 * n_; ++j) X(k, j) *= M(k, k);
      for (Index i = 0; i < k; ++i)
        for (Index j = 0; j < 2 * n_; ++j) X(i, j) -= M(i, k) * X(k, j);
    }
    return true;
  }

  Index n_;
  std::vector<Number> mass_, both_;  // M; C/omega^2, B/omega
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
  Division<Lanes> several(n);
  Division<double> one(n);
  Index exchanging = 0;  // angles up to here are done one by one
  for (Index j = 0; j < N;) {
    if (j >= exchanging && j + Lanes::width <= N) {
      if (several.divide(system, j, form)) {
        j += Lanes::width;
        continue;
      }
      exchanging = j + Lanes::width;
    }
    one.divide(system, j++, form);
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
