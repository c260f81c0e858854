#include "hb/engine/nonlinear/corrector.hpp"

#include <algorithm>
#include <cmath>

namespace hb::nonlinear {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Corrections that contract more slowly than this get new factors.
constexpr double slow = 0.2;
// Corrections this small that no longer shrink are rounding.
constexpr double rounding_size = 1e-7;
constexpr double least_damping = 1.0 / 4096;

Unknowns moved(const Unknowns& x, double factor, const Unknowns& change) {
  return {x.u + factor * change.u, x.p + factor * change.p};
}

}  // namespace

Corrector::Corrector(HarmonicBalance& balance, double p_scale, std::function<bool()> stop)
    : balance_(&balance), p_scale_(p_scale), stop_(std::move(stop)) {}

double Corrector::norm(const Unknowns& change) const {
  return size(change.u, balance_->num_components()) + u_scale_ * std::abs(change.p) / p_scale_;
}

Correction Corrector::factorise(const Unknowns& x, const Constraint& constraint) {
  Correction result;
  factors_ = dense::Lu<double>();
  if (auto failure = balance_->linearise(x.u, x.p, residual_, linear_)) {
    result.status = CorrectionStatus::no_residual;
    result.failure = *failure;
    return result;
  }
  constraint_ = constraint;
  const Index m = x.u.size();
  MatrixXd J;
  if (constraint.holds_parameter()) {
    J = balance_->jacobian(linear_, x.p);
  } else {
    J.resize(m + 1, m + 1);
    J.topLeftCorner(m, m) = balance_->jacobian(linear_, x.p);
    VectorXd Fp;
    if (auto failure = balance_->parameter_derivative(x.u, x.p, p_scale_, linear_, Fp)) {
      result.status = CorrectionStatus::no_residual;
      result.failure = *failure;
      return result;
    }
    J.col(m).head(m) = Fp;
    J.row(m).head(m) = constraint.row.transpose();
    J(m, m) = constraint.row_p;
  }
  row_scale_ = J.cwiseAbs().leftCols(m).rowwise().maxCoeff();
  for (double& scale : row_scale_) scale = scale > 0 ? 1 / scale : 1;
  J = row_scale_.asDiagonal() * J;
  if (!J.allFinite()) return result;
  factors_.compute(J);
  result.factorisations = 1;
  const bool regular = (factors_.pivots().array() != 0).all() && factors_.all_finite();
  result.status = regular ? CorrectionStatus::converged : CorrectionStatus::singular;
  if (!regular) factors_ = dense::Lu<double>();
  return result;
}

Unknowns Corrector::apply(const VectorXd& F, double g) const {
  const Index m = F.size();
  VectorXd right(factors_.size());
  right.head(m) = F;
  if (right.size() > m) right(m) = g;
  const VectorXd change = factors_.solve(row_scale_.asDiagonal() * right);
  return {change.head(m), right.size() > m ? change(m) : 0};
}

int Corrector::determinant_sign() const {
  int sign = factors_.sign();
  for (const double pivot : factors_.pivots())
    if (pivot < 0) sign = -sign;
  return sign;
}

Correction Corrector::solve(Unknowns& x, const Constraint& constraint, double tolerance, bool keep_factors,
                            int max_factorisations) {
  Correction result;
  const auto ended = [&](CorrectionStatus status) {
    result.status = status;
    return result;
  };
  bool fresh = false;  // factors are those of x
  const auto renew = [&] {
    const Correction made = factorise(x, constraint);
    ++result.factorisations;
    fresh = made.status == CorrectionStatus::converged;
    if (!made.failure.reason.empty()) result.failure = made.failure;
    return made.status;
  };
  u_scale_ = size(x.u, balance_->num_components());
  VectorXd F;
  if (keep_factors && has_factors()) {
    if (auto failure = balance_->residual(x.u, x.p, F)) {
      result.failure = *failure;
      return ended(CorrectionStatus::no_residual);
    }
  } else {
    if (const auto status = renew(); status != CorrectionStatus::converged) return ended(status);
    F = residual_;
  }
  Unknowns e = apply(-F);
  result.first = norm(e);
  double damping = 1;
  for (;;) {
    if (stop_ && stop_()) return ended(CorrectionStatus::stopped);
    const double e_size = norm(e);
    if (!std::isfinite(e_size)) return ended(CorrectionStatus::no_convergence);
    if (e_size == 0 && e.p == 0) {
      result.last = 0;
      return ended(CorrectionStatus::converged);
    }
    // One step along e.
    const Unknowns next = moved(x, damping, e);
    std::optional<EvaluationFailure> failure = balance_->residual(next.u, next.p, F);
    if (failure) result.failure = *failure;
    const Unknowns simplified = failure ? Unknowns{} : apply(-F);
    const double theta = failure ? HUGE_VAL : norm(simplified) / e_size;
    if (damping == 1 && result.contraction == 0 && std::isfinite(theta)) result.contraction = theta;
    const double unknown_size = size((failure ? x : next).u, balance_->num_components());
    const bool at_rounding = !failure && damping == 1 && fresh && e_size <= rounding_size * unknown_size && theta > 0.3;
    if (theta <= 1 - damping / 4 || at_rounding) {
      x = next;
      if (damping == 1) {
        const double left = norm(simplified) * std::max(theta / (1 - std::min(theta, 0.9)), 0.1);
        if (left <= tolerance * unknown_size || at_rounding) {
          if (theta < 1) x = moved(x, 1, simplified);
          result.last = at_rounding ? std::max(e_size, norm(simplified)) : norm(simplified);
          return ended(CorrectionStatus::converged);
        }
        if (theta <= slow) {
          e = simplified;
          fresh = false;
          continue;
        }
      }
      if (result.factorisations >= max_factorisations) return ended(CorrectionStatus::no_convergence);
      if (const auto status = renew(); status != CorrectionStatus::converged) return ended(status);
      e = apply(-residual_);
      damping = std::min(1.0, 4 * damping);
      continue;
    }
    if (!fresh) {
      if (result.factorisations >= max_factorisations) return ended(CorrectionStatus::no_convergence);
      if (const auto status = renew(); status != CorrectionStatus::converged) return ended(status);
      e = apply(-residual_);
      continue;
    }
    damping /= 2;
    if (damping < least_damping)
      return ended(failure ? CorrectionStatus::no_residual : CorrectionStatus::no_convergence);
  }
}

}  // namespace hb::nonlinear
