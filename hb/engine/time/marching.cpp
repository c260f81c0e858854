#include "hb/engine/time/marching.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/time/integration_cost.hpp"
#include "lib/constants.hpp"
#include "lib/stopwatch.hpp"

namespace hb {

namespace {

// Factor per turn by which the changes shrank over the second half of the turns; 1 before it can be told.
double measured_decay(const std::vector<double>& changes) {
  constexpr std::size_t least = 16;
  const std::size_t n = changes.size(), half = n / 2;
  if (n < least || !(changes.back() < changes[half])) return changes.back() == 0 ? 0 : 1;
  return std::pow(changes.back() / changes[half], 1 / static_cast<double>(n - 1 - half));
}

// The envelope is no smaller than half of what it was when the transient was a hundred times larger: what is left are
// the integrator's own errors, which differ from turn to turn.
bool stagnates(const std::vector<double>& envelopes, double decay) {
  if (!(decay > 0 && decay < 1)) return false;
  const double turns = std::max(2.0, std::ceil(std::log(0.01) / std::log(decay)));
  if (!(turns < static_cast<double>(envelopes.size()))) return false;
  return envelopes.back() >= envelopes[envelopes.size() - 1 - static_cast<std::size_t>(turns)] / 2;
}

// The cheaper one, unless it is asked for.
Integrator marching_integrator(const FrozenSpectrum& spectrum, Integrator asked, double tolerance) {
  if (asked == Integrator::adams || asked == Integrator::bdf) return asked;
  return predicted_steps(spectrum, Integrator::adams, tolerance, 1) <=
                 predicted_steps(spectrum, Integrator::bdf, tolerance, 1)
             ? Integrator::adams
             : Integrator::bdf;
}

// Whether it is worth beginning; if not the result says why.
bool worth_marching(ScaledMotion& motion, const FrozenSpectrum& spectrum, const MarchingOptions& options,
                    double tolerance, double per_turn, MarchingResult& result) {
  if (per_turn > 0) {
    result.status = ShootingStatus::not_reached;
    result.message = "the motion is unstable: marching never settles";
    return false;
  }
  const double turns = per_turn < 0 ? std::max(1.0, std::log(options.tolerance) / per_turn) : 1;
  const double predicted = turns * predicted_steps(spectrum, result.integrator, tolerance, 1) *
                           seconds_per_step(motion, result.integrator, 1);
  if (!(predicted <= options.time_limit)) {
    result.status = ShootingStatus::too_expensive;
    result.message = "marching would need about " + std::to_string(static_cast<long long>(std::min(predicted, 1e15))) +
                     " s (" + std::to_string(static_cast<long long>(std::min(turns, 1e15))) +
                     " turns), more than the limit for a case";
    return false;
  }
  return true;
}

}  // namespace

MarchingResult march_from_rest(const TimeDomainSystem& system, const MarchingOptions& options) {
  const Deadline start = std::chrono::steady_clock::now();
  const Deadline deadline = deadline_after(start, options.time_limit);
  ScaledMotion motion(system);
  const FrozenSpectrum spectrum = frozen_spectrum(motion);
  const Eigen::Index n = 2 * motion.num_modes();
  const double tolerance = options.integrator_tolerance > 0 ? options.integrator_tolerance
                                                            : std::clamp(options.tolerance / 1000, 1e-13, 1e-3);
  MarchingResult result;
  result.integrator = marching_integrator(spectrum, options.integrator, tolerance);
  // The transient shrinks by e^{growth_rate T} per turn.
  const double per_turn = options.growth_rate != 0 ? options.growth_rate * two_pi / system.speed : 0;
  if (!worth_marching(motion, spectrum, options, tolerance, per_turn, result)) {
    result.seconds = seconds_since(start);
    return result;
  }

  constexpr int num_outputs = 128;
  std::vector<double> outputs(num_outputs);
  for (int j = 0; j < num_outputs; ++j) outputs[static_cast<std::size_t>(j)] = two_pi * (j + 1) / num_outputs;
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(n, 1), states(n, num_outputs), before;
  const Eigen::VectorXd load = Eigen::VectorXd::Ones(1);
  std::vector<double> changes, envelopes;
  double envelope = 0;
  result.status = ShootingStatus::time_limit;
  while (true) {
    // Each turn starts at tau = 0 again: the coefficients are periodic and a large tau would cost digits.
    const Trajectory trajectory =
        integrate_cvode(motion, result.integrator, tolerance, 0, state, load, outputs, deadline);
    result.steps += trajectory.steps;
    if (trajectory.status != IntegrationStatus::finished) {
      result.message = trajectory.message;
      result.status =
          trajectory.status == IntegrationStatus::time_limit ? ShootingStatus::time_limit : ShootingStatus::failed;
      break;
    }
    ++result.turns;
    before = states;
    states.col(0) = state;
    for (int j = 0; j + 1 < num_outputs; ++j) states.col(j + 1) = trajectory.states[static_cast<std::size_t>(j)];
    state = trajectory.states.back();
    const double size = states.cwiseAbs().maxCoeff();
    result.change = size > 0 ? (state - states.col(0)).cwiseAbs().maxCoeff() / size : 0;
    changes.push_back(result.change);
    result.decay_per_turn = per_turn < 0 ? std::exp(per_turn) : measured_decay(changes);
    // A transient that oscillates passes through small changes: the envelope of the changes shrinks by the decay. What
    // is left sums to envelope/(1 - decay), and so do the errors of the turns.
    envelope = std::max(envelope * result.decay_per_turn, result.change);
    envelopes.push_back(envelope);
    const double turns_kept = 1 / (1 - result.decay_per_turn);
    result.q_error =
        turns_kept * (envelope + error_per_step(result.integrator, tolerance) * static_cast<double>(trajectory.steps));
    if (envelope * turns_kept <= options.tolerance || stagnates(envelopes, result.decay_per_turn)) {
      result.status = ShootingStatus::converged;
      break;
    }
    if (!(size <= 1e12)) {
      result.status = ShootingStatus::not_reached;
      result.message = "the motion grows: marching does not settle";
      break;
    }
  }
  if (result.turns > 0) result.orbit = orbit_of(motion, states);
  result.evaluations = motion.evaluations();
  result.seconds = seconds_since(start);
  return result;
}

}  // namespace hb
