#include "hb/engine/nonlinear/motion_search.hpp"

#include <numbers>

#include "hb/engine/nonlinear/continuation.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

// The start's samples at the angles of others.
MotionSamples start_at(const FourierSeries& start, const MotionSamples& other, double Omega, int turns) {
  MotionSamples samples = other;
  samples.q.setZero();
  samples.v.setZero();
  samples.a.setZero();
  const double omega = Omega / turns;
  for (Index k = 0; k < start.c.cols(); ++k)
    for (Index j = 0; j < other.num_samples(); ++j) {
      const double w = double(k) * omega, factor = k == 0 ? 1 : 2;
      const std::complex<double> turned = std::polar(factor, double(k) * other.angle(j) / turns);
      const Eigen::VectorXcd term = turned * start.c.col(k);
      samples.q.col(j) += term.real();
      samples.v.col(j) -= w * term.imag();
      samples.a.col(j) -= w * w * term.real();
    }
  return samples;
}

NonlinearSystem homotopy(const NonlinearSystem& system, double parameter, const FourierSeries& start, int turns) {
  const double Omega = system.speed(parameter);
  NonlinearSystem result;
  result.num_unknowns = system.num_unknowns;
  result.speed = [Omega](double) { return Omega; };
  struct Known {
    Eigen::VectorXd angle;
    MatrixXd r;
  };
  result.evaluate = [&system, parameter, start, turns, Omega, known = Known{}](
                        double lambda, const MotionSamples& motion, Derivatives wanted,
                        ResidualSamples& samples) mutable -> std::optional<EvaluationFailure> {
    if (known.angle.size() != motion.num_samples() || known.angle != motion.angle) {
      ResidualSamples at_start;
      if (auto failure = system.evaluate(parameter, start_at(start, motion, Omega, turns), Derivatives::none, at_start))
        return failure;
      known = {motion.angle, at_start.r};
    }
    if (auto failure = system.evaluate(parameter, motion, wanted, samples)) return failure;
    samples.r -= (1 - lambda) * known.r;
    if (wanted == Derivatives::state) samples.dp = known.r;
    return std::nullopt;
  };
  return result;
}

}  // namespace

PeriodicMotion find_periodic_motion(const NonlinearSystem& system, double parameter, const FourierSeries& start,
                                    const MotionOptions& options) {
  PeriodicMotion motion = solve_periodic_motion(system, parameter, start, options);
  if (motion.status != MotionStatus::no_motion && motion.status != MotionStatus::no_residual) return motion;
  const FourierSeries from = start.c.cols() > 0 ? start : FourierSeries(system.num_unknowns, 0);
  const NonlinearSystem path = homotopy(system, parameter, from, options.turns);
  ContinuationOptions along;
  along.motion = options;
  along.motion.tolerance = std::max(options.tolerance, 1e-3);
  along.low = -1;
  along.high = 1;
  // From rest lengths have no measure of their own: the linear response's.
  along.motion_scale = motion.q.c.norm();
  along.max_points = 300;
  along.stability = false;
  along.stop = options.stop;
  PeriodicMotion at_start;
  at_start.status = MotionStatus::not_reached;
  at_start.turns = options.turns;
  at_start.q = from;
  const Branch branch = follow_branch(path, at_start, along);
  if (branch.points.empty() || branch.points.back().motion.parameter != 1) return motion;
  PeriodicMotion found = solve_periodic_motion(system, parameter, branch.points.back().motion.q, options);
  found.factorisations += motion.factorisations + branch.factorisations;
  found.evaluations += motion.evaluations + branch.evaluations;
  return found;
}

}  // namespace hb
