#include "hb/engine/nonlinear/periodic_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hb/engine/nonlinear/truncation_check.hpp"

namespace hb {

using Eigen::Index;
using Eigen::VectorXd;
using nonlinear::Correction;
using nonlinear::CorrectionStatus;

namespace {

// Shares of the tolerance: for what Newton's method leaves, and for the harmonics left out.
constexpr double iteration_share = 0.05, truncation_share = 0.2;
constexpr Index most_oversampling = 16;

void check_options(const NonlinearSystem& system, const FourierSeries& start, const MotionOptions& options) {
  validate(system);
  if (!(options.tolerance > 0)) throw std::invalid_argument("MotionOptions: tolerance must be positive");
  if (options.turns < 1) throw std::invalid_argument("MotionOptions: turns must be at least 1");
  if (options.num_harmonics < 0) throw std::invalid_argument("MotionOptions: num_harmonics must not be negative");
  if (options.max_harmonics < 1) throw std::invalid_argument("MotionOptions: max_harmonics must be at least 1");
  if (start.c.cols() > 0 && start.num_components() != system.num_unknowns)
    throw std::invalid_argument("solve_periodic_motion: the start has not as many components as the system");
  if (!start.c.allFinite()) throw std::invalid_argument("solve_periodic_motion: the start is not finite");
}

MotionStatus status_of(CorrectionStatus status) {
  switch (status) {
    case CorrectionStatus::stopped:
      return MotionStatus::stopped;
    case CorrectionStatus::no_residual:
      return MotionStatus::no_residual;
    default:
      return MotionStatus::no_motion;
  }
}

}  // namespace

FourierSeries repeated(const FourierSeries& q, int times) {
  FourierSeries result(q.num_components(), q.num_harmonics() * times);
  for (Index k = 0; k <= q.num_harmonics(); ++k) result.c.col(k * times) = q.c.col(k);
  return result;
}

PeriodicMotion solve_periodic_motion(const NonlinearSystem& system, double parameter, const FourierSeries& start,
                                     const MotionOptions& options) {
  check_options(system, start, options);
  const Index n = system.num_unknowns;
  const bool fixed = options.num_harmonics > 0;
  constexpr Index first_harmonics = 8;
  const Index most = fixed ? options.num_harmonics : options.max_harmonics;
  nonlinear::Unknowns x{VectorXd::Zero(n), parameter};
  if (start.c.cols() > 0) x.u = nonlinear::to_unknowns(start, start.num_harmonics());
  // One harmonic more than the start needed: a motion whose harmonics do not suffice is solved for again.
  Index H =
      fixed ? options.num_harmonics
            : std::min(most, std::max(first_harmonics * options.turns,
                                      1 + nonlinear::harmonics_needed(x.u, n, truncation_share * options.tolerance)));
  Index oversampling = 1;
  PeriodicMotion motion;
  motion.parameter = parameter;
  motion.speed = system.speed(parameter);
  motion.turns = options.turns;
  motion.q = nonlinear::to_series(x.u, n);
  double last_bound = HUGE_VAL;
  for (;;) {
    nonlinear::HarmonicBalance balance(system, options.turns, H, nonlinear::samples_for(H, oversampling));
    nonlinear::Corrector corrector(balance, std::max(std::abs(parameter), 1e-300), options.stop);
    x.u = nonlinear::to_unknowns(nonlinear::to_series(x.u, n), H);
    const Correction correction =
        corrector.solve(x, {}, iteration_share * options.tolerance, false, options.max_factorisations);
    motion.factorisations += correction.factorisations;
    motion.evaluations += balance.evaluated_samples();
    if (!correction.failure.reason.empty()) motion.failure = correction.failure;
    // What was found with fewer harmonics stays.
    const bool found_before = motion.status == MotionStatus::not_reached;
    if (correction.status != CorrectionStatus::converged) {
      if (found_before) return motion;
      motion.q = nonlinear::to_series(x.u, n);
      motion.num_harmonics = int(H);
      motion.num_samples = int(balance.num_samples());
      motion.status = status_of(correction.status);
      return motion;
    }
    const nonlinear::TruncationCheck check = nonlinear::check_truncation(
        system, corrector, balance, x, {}, 1, iteration_share * options.tolerance, options.stop);
    motion.evaluations += check.evaluations;
    motion.num_harmonics = int(H);
    motion.num_samples = int(balance.num_samples());
    motion.q = nonlinear::to_series(x.u, n);
    motion.status = MotionStatus::not_reached;
    if (!check.found) {
      if (!check.failure.reason.empty()) motion.failure = check.failure;
      motion.q_finer = {};
      motion.error = VectorXd::Constant(n, HUGE_VAL);
      motion.error_bound = HUGE_VAL;
      if (H >= most || (options.stop && options.stop())) return motion;
      H = std::min(most, 2 * H);
      continue;
    }
    motion.q_finer = nonlinear::to_series(check.finer.u, n);
    motion.error = check.error.array() + correction.last;
    const double largest = balance.motion(x.u, x.p).q.cwiseAbs().maxCoeff(), error = motion.error.maxCoeff();
    motion.error_bound = error > 0 ? error / largest : 0;
    if (motion.error_bound <= options.tolerance) {
      motion.status = MotionStatus::converged;
      return motion;
    }
    const Index needed = nonlinear::harmonics_needed(check.finer.u, n, truncation_share * options.tolerance);
    x.u = check.finer.u;
    if (needed > H) {
      if (H >= most) return motion;
      H = std::min(most, std::max(H + 2, needed));
    } else {
      // The harmonics are there: samples are missing, or this is rounding.
      if (oversampling >= most_oversampling || !(motion.error_bound < 0.3 * last_bound || oversampling == 1))
        return motion;
      oversampling *= 2;
    }
    last_bound = motion.error_bound;
  }
}

const char* to_string(MotionStatus status) {
  switch (status) {
    case MotionStatus::converged:
      return "converged";
    case MotionStatus::not_reached:
      return "tolerance not reached";
    case MotionStatus::no_motion:
      return "no motion found";
    case MotionStatus::no_residual:
      return "the equations do not exist on the way";
    case MotionStatus::stopped:
      return "stopped";
  }
  return "";
}

}  // namespace hb
