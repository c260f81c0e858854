#include "hb/engine/nonlinear/motion_stability.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hb/engine/nonlinear/harmonic_balance.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

// Of this many samples one is compared with the motion of twice the harmonics.
constexpr Index compared = 4;
// The errors between those compared may be larger, and q_finer has an error of its own.
constexpr double margin = 2;
constexpr Index most_refinements = 2;

MotionSamples samples_of(const PeriodicMotion& motion, const FourierSeries& q, Index N) {
  const double omega = motion.speed / motion.turns;
  Index step = 1;
  while (step * N < 2 * q.num_harmonics() + 2) step *= 2;
  MotionSamples samples;
  samples.angle = Eigen::VectorXd::LinSpaced(N, 0, 2 * std::numbers::pi * motion.turns * double(N - 1) / double(N));
  const auto kept = Eigen::seqN(0, N, step);
  samples.q = fourier::synthesise(q, step * N)(Eigen::all, kept);
  samples.v = omega * fourier::synthesise(fourier::derivative(q), step * N)(Eigen::all, kept);
  samples.a = omega * omega * fourier::synthesise(fourier::derivative(q, 2), step * N)(Eigen::all, kept);
  return samples;
}

NormalForm form_of(const PeriodicMotion& motion, const ResidualSamples& along) {
  return normal_form({motion.speed / motion.turns, along.da, along.dv, along.dq});
}

Stability unknown(const char* why) {
  Stability nothing;
  nothing.growth_rate = -HUGE_VAL;
  nothing.growth_error = HUGE_VAL;
  nothing.evidence = why;
  return nothing;
}

// Deviations of the coefficients along the motion from those along q_finer.
std::optional<CoefficientErrors> motion_errors(const NonlinearSystem& system, const PeriodicMotion& motion,
                                               const NormalForm& form) {
  if (motion.q_finer.c.cols() == 0) return std::nullopt;
  if (motion.q_finer.c.cols() == motion.q.c.cols() && motion.q_finer.c == motion.q.c) return CoefficientErrors{};
  const Index N = form.alpha.cols(), step = N % compared == 0 ? compared : 1;
  ResidualSamples finer;
  if (system.evaluate(motion.parameter, samples_of(motion, motion.q_finer, N / step), Derivatives::state, finer))
    return std::nullopt;
  const auto kept = Eigen::seqN(0, N / step, step);
  const NormalForm coarse{form.alpha(Eigen::all, kept), form.beta(Eigen::all, kept)};
  CoefficientErrors errors = difference(coarse, form_of(motion, finer));
  return CoefficientErrors{margin * errors.alpha, margin * errors.beta};
}

}  // namespace

Stability motion_stability(const NonlinearSystem& system, const PeriodicMotion& motion, const ResidualSamples& along,
                           const StabilityOptions& options) {
  if (motion.status != MotionStatus::converged && motion.status != MotionStatus::not_reached)
    return unknown("no motion, no exponents");
  const double omega = motion.speed / motion.turns;
  const NormalForm form = form_of(motion, along);
  const std::optional<CoefficientErrors> errors = motion_errors(system, motion, form);
  if (!errors) return unknown("the motion's error is not known");
  Stability best = analyse_stability(form, omega, options, *errors);
  Index N = along.r.cols();
  for (Index refinement = 0; refinement < most_refinements && !best.converged; ++refinement) {
    N *= 2;
    ResidualSamples finer;
    if (system.evaluate(motion.parameter, samples_of(motion, motion.q, N), Derivatives::state, finer)) break;
    Stability better = analyse_stability(form_of(motion, finer), omega, options, *errors);
    if (!(better.growth_error < 0.5 * best.growth_error)) break;
    best = std::move(better);
  }
  return best;
}

Stability motion_stability(const NonlinearSystem& system, const PeriodicMotion& motion,
                           const StabilityOptions& options) {
  if (motion.status != MotionStatus::converged && motion.status != MotionStatus::not_reached)
    return unknown("no motion, no exponents");
  ResidualSamples along;
  if (system.evaluate(motion.parameter, samples_of(motion, motion.q, motion.num_samples), Derivatives::state, along))
    return unknown("the equations do not exist along the motion");
  return motion_stability(system, motion, along, options);
}

}  // namespace hb
