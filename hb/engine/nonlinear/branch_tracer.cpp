#include "hb/engine/nonlinear/branch_tracer.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/nonlinear/motion_stability.hpp"

namespace hb::nonlinear {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double iteration_share = 0.05, truncation_share = 0.2;
constexpr Index most_oversampling = 4;
constexpr int most_factorisations = 10;

VectorXd padded(const VectorXd& u, Index size) {
  VectorXd result = VectorXd::Zero(size);
  result.head(std::min(size, u.size())) = u.head(std::min(size, u.size()));
  return result;
}

}  // namespace

double Metric::product(const Unknowns& a, const Unknowns& b) const {
  const Index common = std::min(a.u.size(), b.u.size());
  return mean_product(a.u.head(common), b.u.head(common), num_components) / (motion * motion) +
         a.p * b.p / (parameter * parameter);
}

Constraint Metric::across(const Unknowns& direction) const {
  Constraint constraint{2 / motion * direction.u, motion / (parameter * parameter) * direction.p};
  constraint.row.head(num_components) /= 2;
  return constraint;
}

Unknowns combination(double a, const Unknowns& x, double b, const Unknowns& y) {
  const Index size = std::max(x.u.size(), y.u.size());
  return {a * padded(x.u, size) + b * padded(y.u, size), a * x.p + b * y.p};
}

Unknowns with_harmonics(const Unknowns& x, Index num_components, Index num_harmonics) {
  return {padded(x.u, num_components * (2 * num_harmonics + 1)), x.p};
}

Unknowns place_of(const BranchPoint& point) {
  return {to_unknowns(point.motion.q, point.motion.q.num_harmonics()), point.motion.parameter};
}

Unknowns tangent_of(const BranchPoint& point) {
  return {to_unknowns(point.tangent, point.tangent.num_harmonics()), point.parameter_tangent};
}

namespace {

// Shares of both points and of both tangents in the cubic.
struct Hermite {
  double a, b, slope_a, slope_b;
  Hermite(double s, double length) {
    const double x = s / length;
    b = x * x * (3 - 2 * x);
    a = 1 - b;
    slope_a = x * (1 - x) * (1 - x) * length;
    slope_b = x * x * (x - 1) * length;
  }
};

}  // namespace

Unknowns between(const BranchPoint& a, const BranchPoint& b, double s) {
  const Hermite share(s, b.arc - a.arc);
  return combination(1, combination(share.a, place_of(a), share.b, place_of(b)), 1,
                     combination(share.slope_a, tangent_of(a), share.slope_b, tangent_of(b)));
}

double parameter_between(const BranchPoint& a, const BranchPoint& b, double s) {
  const Hermite share(s, b.arc - a.arc);
  return share.a * a.motion.parameter + share.b * b.motion.parameter + share.slope_a * a.parameter_tangent +
         share.slope_b * b.parameter_tangent;
}

BranchTracer::BranchTracer(const NonlinearSystem& system, const ContinuationOptions& options)
    : system_(&system), options_(&options) {
  parameter_scale_ =
      options.parameter_scale > 0 ? options.parameter_scale : std::max(std::abs(options.low), std::abs(options.high));
}

Metric BranchTracer::metric(const Unknowns& x) const {
  const double rms = std::sqrt(mean_product(x.u, x.u, system_->num_unknowns));
  const double motion = std::max(rms, options_->motion_scale);
  return {motion > 0 ? motion : 1, parameter_scale_, system_->num_unknowns};
}

void BranchTracer::take_harmonics(Index num_harmonics) {
  evaluations_ = evaluations();
  corrector_.reset();
  H_ = num_harmonics;
  balance_ = std::make_unique<HarmonicBalance>(*system_, options_->motion.turns, H_, samples_for(H_, oversampling_));
  corrector_ = std::make_unique<Corrector>(*balance_, parameter_scale_, options_->stop);
}

void BranchTracer::set_harmonics(Index num_harmonics) {
  const MotionOptions& motion = options_->motion;
  const Index H =
      motion.num_harmonics > 0 ? motion.num_harmonics : std::clamp<Index>(num_harmonics, 1, motion.max_harmonics);
  if (H != H_) take_harmonics(H);
}

Index BranchTracer::finish(Trace& trace, const Unknowns& x, const Unknowns& direction, double last_correction,
                           bool hold_parameter, bool with_exponents) {
  const Index n = system_->num_unknowns;
  const Metric here = metric(x);
  const Constraint across = here.across(with_harmonics(direction, n, H_));
  const Correction factors = corrector_->factorise(x, across);
  factorisations_ += factors.factorisations;
  trace.status = factors.status;
  if (factors.status != CorrectionStatus::converged) {
    if (!factors.failure.reason.empty()) trace.failure = factors.failure;
    return H_;
  }
  PeriodicMotion& motion = trace.point.motion;
  motion.parameter = x.p;
  motion.speed = system_->speed(x.p);
  motion.turns = options_->motion.turns;
  motion.q = to_series(x.u, n);
  motion.num_harmonics = int(H_);
  motion.num_samples = int(balance_->num_samples());
  motion.status = MotionStatus::not_reached;
  motion.error = VectorXd::Constant(n, HUGE_VAL);
  motion.error_bound = HUGE_VAL;

  Unknowns t = corrector_->apply(VectorXd::Zero(x.u.size()), 1);
  const double length = here.length(t);
  t.u /= length;
  t.p /= length;
  trace.point.tangent = to_series(t.u, n);
  trace.point.parameter_tangent = t.p;

  const double tolerance = options_->motion.tolerance;
  const TruncationCheck check = check_truncation(*system_, *corrector_, *balance_, x, across, parameter_scale_,
                                                 iteration_share * tolerance, options_->stop);
  evaluations_ += check.evaluations;
  if (!check.found && !check.failure.reason.empty()) trace.failure = check.failure;
  const Index most = options_->motion.num_harmonics > 0 ? H_ : Index(options_->motion.max_harmonics);
  if (!check.found) return H_ < most && !stopped() ? std::min(most, 2 * H_) : H_;
  motion.q_finer = to_series(check.finer.u, n);
  motion.error = check.error.array() + last_correction;
  motion.parameter_error = check.parameter_error;
  if (hold_parameter) {
    // At the parameter itself the motion moves along the branch by what the parameter moved.
    motion.error += std::abs(check.parameter_error / t.p) * sizes(t.u, n);
    motion.parameter_error = 0;
  }
  const double largest = balance_->motion(x.u, x.p).q.cwiseAbs().maxCoeff(), error = motion.error.maxCoeff();
  motion.error_bound = error > 0 ? error / largest : 0;
  needed_ = nonlinear::harmonics_needed(check.finer.u, n, truncation_share * tolerance);
  if (motion.error_bound <= tolerance)
    motion.status = MotionStatus::converged;
  else if (needed_ > H_ && H_ < most)
    return std::min(most, std::max(H_ + 2, needed_ + needed_ / 8));
  else if (needed_ <= H_ && oversampling_ < most_oversampling && options_->motion.num_harmonics == 0 && !stopped()) {
    oversampling_ *= 2;
    return H_ + 1;
  }
  if (with_exponents)
    trace.point.stability =
        motion_stability(*system_, motion, corrector_->linearisation().samples, options_->exponents);
  return H_;
}

Trace BranchTracer::run(const Unknowns& prediction, const Unknowns& direction, bool hold_parameter, bool keep_factors,
                        bool with_exponents) {
  const Index n = system_->num_unknowns;
  Unknowns x = prediction;
  Trace trace;
  if (!corrector_) set_harmonics(std::max<Index>(8, (prediction.u.size() / n - 1) / 2));
  for (;;) {
    x = with_harmonics(x, n, H_);
    const Constraint constraint = hold_parameter ? Constraint{} : metric(x).across(with_harmonics(direction, n, H_));
    const Correction correction = corrector_->solve(x, constraint, iteration_share * options_->motion.tolerance,
                                                    keep_factors, most_factorisations);
    factorisations_ += correction.factorisations;
    trace.status = correction.status;
    if (!correction.failure.reason.empty()) trace.failure = correction.failure;
    if (trace.contraction == 0) trace.contraction = correction.contraction;
    if (correction.status != CorrectionStatus::converged) return trace;
    trace.moved = metric(x).length(combination(1, x, -1, prediction));
    const Index wanted = finish(trace, x, direction, correction.last, hold_parameter, with_exponents);
    if (trace.status != CorrectionStatus::converged || wanted == H_) return trace;
    const FourierSeries& finer = trace.point.motion.q_finer;
    if (finer.c.cols() > 0) x.u = to_unknowns(finer, finer.num_harmonics());
    take_harmonics(wanted);
    keep_factors = false;
  }
}

}  // namespace hb::nonlinear
