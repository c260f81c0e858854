#include "hb/engine/time/shooting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "hb/engine/time/floquet_product.hpp"
#include "hb/engine/time/integration_cost.hpp"
#include "hb/engine/time/run_comparison.hpp"
#include "lib/constants.hpp"
#include "lib/stopwatch.hpp"

namespace hb {

const char* to_string(ShootingStatus status) {
  switch (status) {
    case ShootingStatus::converged:
      return "converged";
    case ShootingStatus::not_reached:
      return "tolerance not reached";
    case ShootingStatus::too_expensive:
      return "too expensive";
    case ShootingStatus::time_limit:
      return "time limit";
    case ShootingStatus::singular:
      return "singular";
    case ShootingStatus::failed:
      return "failed";
  }
  return "";
}

namespace {

// What one run over the turn gives.
struct Run {
  ShootingStatus status = ShootingStatus::failed;
  std::string message;
  Eigen::MatrixXd states;  // (x; v) at the outputs
  LogMultipliers multipliers;
  // Of the periodic displacements and velocities, relative to their largest, when the maps change by their own errors.
  double x_sensitivity = 0, v_sensitivity = 0;
  long steps = 0;
};

struct Precision {
  double tolerance = 0;  // CVODE
  int cells = 0;  // collocation, between outputs
};

// An ill-conditioned cycle (a multiplier near 1) amplifies errors of the maps, and in two runs that err alike the
// difference does not show it: the cycle is solved again with every entry changed at random by up to `noise` of the
// largest in its map.
void add_sensitivity(Run& run, const std::vector<SegmentMap>& segments, const CyclicSolution& cycle, double noise) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(-noise, noise);
  std::vector<SegmentMap> changed = segments;
  for (SegmentMap& segment : changed) {
    const double map_size = std::max(1.0, segment.transition.cwiseAbs().maxCoeff());
    const double load_size = segment.particular.cwiseAbs().maxCoeff();
    for (double& entry : segment.transition.reshaped()) entry += map_size * uniform(generator);
    for (double& entry : segment.particular) entry += load_size * uniform(generator);
  }
  const CyclicSolution other = solve_cyclic(changed);
  const Eigen::Index I = segments.front().particular.size() / 2;
  double x = 0, v = 0, dx = 0, dv = 0;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Eigen::VectorXd &state = cycle.states[k], change = other.states[k] - state;
    x = std::max(x, state.head(I).cwiseAbs().maxCoeff());
    v = std::max(v, state.tail(I).cwiseAbs().maxCoeff());
    dx = std::max(dx, change.head(I).cwiseAbs().maxCoeff());
    dv = std::max(dv, change.tail(I).cwiseAbs().maxCoeff());
  }
  run.x_sensitivity = x > 0 ? dx / x : 0;
  run.v_sensitivity = v > 0 ? dv / v : 0;
}

// All 2I unit columns and the forced one over every segment; then the cycle.
Run shoot(ScaledMotion& motion, Integrator integrator, Precision precision, int num_segments, int num_outputs,
          Deadline deadline) {
  const Eigen::Index n = 2 * motion.num_modes();
  Eigen::MatrixXd Y0 = Eigen::MatrixXd::Zero(n, n + 1);
  Y0.leftCols(n).setIdentity();
  const Eigen::VectorXd load = Eigen::VectorXd::Unit(n + 1, n);

  Run run;
  std::vector<SegmentMap> segments;
  std::vector<Eigen::MatrixXd> maps;  // from the segment's start to each output
  const int outputs_per_segment = num_outputs / num_segments;
  std::vector<double> outputs(static_cast<std::size_t>(outputs_per_segment));
  for (int k = 0; k < num_segments; ++k) {
    for (int j = 0; j < outputs_per_segment; ++j)
      outputs[static_cast<std::size_t>(j)] = two_pi * (k * outputs_per_segment + j + 1) / num_outputs;
    const double start = two_pi * k / num_segments;
    Trajectory part =
        integrator == Integrator::collocation
            ? integrate_collocation(motion, precision.cells, start, Y0, load, outputs, deadline)
            : integrate_cvode(motion, integrator, precision.tolerance, start, Y0, load, outputs, deadline);
    run.steps += part.steps;
    if (part.status != IntegrationStatus::finished) {
      run.status = part.status == IntegrationStatus::time_limit ? ShootingStatus::time_limit : ShootingStatus::failed;
      run.message = part.message;
      return run;
    }
    const Eigen::MatrixXd& end = part.states.back();
    segments.push_back({end.leftCols(n), end.col(n)});
    for (Eigen::MatrixXd& state : part.states) maps.push_back(std::move(state));
  }

  const double noise = integrator == Integrator::collocation ? 1e-10 : 1e3 * precision.tolerance;
  run.multipliers = log_multipliers(segments, noise);
  run.states = Eigen::MatrixXd::Zero(n, num_outputs);
  run.status = ShootingStatus::converged;
  if (!motion.loaded()) return run;
  const CyclicSolution cycle = solve_cyclic(segments);
  // The maps' own errors hide how singular the cycle is; a loose run may still be used, its error bar says how far.
  const double map_error = integrator == Integrator::collocation ? 1e-12 : std::min(1e3 * precision.tolerance, 1e-6);
  if (!(cycle.reciprocal_condition >= map_error)) {
    run.status = ShootingStatus::singular;
    run.message = "a multiplier is 1 to the accuracy of the integration: no unique periodic solution";
    return run;
  }
  // Errors of the steps add up at random.
  const double per_step =
      eps + (integrator == Integrator::collocation ? 0 : error_per_step(integrator, precision.tolerance));
  add_sensitivity(run, segments, cycle, per_step * std::sqrt(static_cast<double>(run.steps) / num_segments));
  // states(j) belongs to tau_j; the map to tau_(j+1) starts at its segment's first state.
  for (int j = 0; j < num_outputs; ++j) {
    const Eigen::VectorXd& first = cycle.states[static_cast<std::size_t>(j / outputs_per_segment)];
    const Eigen::MatrixXd& map = maps[static_cast<std::size_t>(j)];
    run.states.col((j + 1) % num_outputs) = map.leftCols(n) * first + map.col(n);
  }
  return run;
}

double relative_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double size = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  return size > 0 ? (a - b).cwiseAbs().maxCoeff() / size : 0;
}

int power_of_two_at_least(double number, int limit) {
  int power = 1;
  while (power < number && power < limit) power *= 2;
  return power;
}

struct Plan {
  Integrator integrator = Integrator::automatic;
  Precision fine, coarse;
  int num_segments = 1, num_outputs = 128;
  double work = 0;  // counted, to compare methods by
  double predicted_seconds = 0;  // measured, for the time limit
};

Plan plan_shooting(ScaledMotion& motion, const FrozenSpectrum& spectrum, Integrator integrator, double tolerance,
                   double single_run) {
  Plan plan;
  plan.integrator = integrator;
  // A segment in which the slow modes change by no more than e^4 keeps them above the integrator's noise.
  // Collocation starts anew at no cost: short segments keep the fast decaying modes in sight as well.
  const double least = integrator == Integrator::collocation ? 32 : 1;
  plan.num_segments = power_of_two_at_least(std::max(least, two_pi * spectrum.slowest / 4), 4096);
  plan.num_outputs = std::max(128, plan.num_segments);
  const Eigen::Index columns = 2 * motion.num_modes() + 1;
  double steps = 0;
  if (integrator == Integrator::collocation) {
    const int cells = single_run > 0 ? std::max(1, static_cast<int>(std::ceil(two_pi / single_run / plan.num_outputs)))
                                     : collocation_cells(spectrum, plan.num_outputs);
    plan.coarse.cells = cells;
    plan.fine.cells = single_run > 0 ? cells : 2 * cells;
    steps = static_cast<double>(plan.num_outputs) * (plan.fine.cells + (single_run > 0 ? 0 : plan.coarse.cells));
  } else {
    // Measured: the error of an exponent is 1e2 (Adams) to 1e5 (BDF, many oscillations per turn) local tolerances.
    // Below 1e-14 (Adams) and 1e-13 (BDF) rounding takes over.
    const double floor = integrator == Integrator::bdf ? 1e-13 : 1e-14;
    plan.fine.tolerance = single_run > 0 ? single_run : std::clamp(1e-4 * tolerance, floor, 1e-3);
    plan.coarse.tolerance = single_run > 0 ? single_run : 8 * plan.fine.tolerance;
    steps = predicted_steps(spectrum, integrator, plan.fine.tolerance, plan.num_segments);
    if (single_run <= 0) steps += predicted_steps(spectrum, integrator, plan.coarse.tolerance, plan.num_segments);
  }
  plan.work = steps * work_per_step(integrator, motion.num_modes(), columns);
  plan.predicted_seconds = steps * seconds_per_step(motion, integrator, columns);
  return plan;
}

// CVODE is preferred while it takes a small part of the time allowed. Chosen by counted work: the same in every run.
Plan choose_plan(ScaledMotion& motion, const FrozenSpectrum& spectrum, const ShootingOptions& options) {
  if (options.integrator != Integrator::automatic)
    return plan_shooting(motion, spectrum, options.integrator, options.tolerance, options.single_run);
  const Plan adams = plan_shooting(motion, spectrum, Integrator::adams, options.tolerance, options.single_run);
  const Plan bdf = plan_shooting(motion, spectrum, Integrator::bdf, options.tolerance, options.single_run);
  const Plan& cvode = adams.work <= bdf.work ? adams : bdf;
  if (cvode.work <= options.time_limit / 20 || options.single_run > 0) return cvode;
  const Plan collocation = plan_shooting(motion, spectrum, Integrator::collocation, options.tolerance, 0);
  return collocation.work < cvode.work ? collocation : cvode;
}

void solve_by(ScaledMotion& motion, const Plan& plan, const ShootingOptions& options, double Omega, Deadline deadline,
              ShootingResult& result) {
  if (options.begin) options.begin(plan.integrator, plan.predicted_seconds);
  const bool single = options.single_run > 0;
  const bool collocation = plan.integrator == Integrator::collocation;
  result.integrator = plan.integrator;
  result.num_segments = plan.num_segments;
  result.integrator_tolerance =
      collocation ? two_pi / (static_cast<double>(plan.num_outputs) * plan.fine.cells) : plan.fine.tolerance;
  result.message.clear();

  const auto run_with = [&](Precision precision) {
    Run run = shoot(motion, plan.integrator, precision, plan.num_segments, plan.num_outputs, deadline);
    result.steps += run.steps;
    return run;
  };
  Run coarse, fine = run_with(single ? plan.fine : plan.coarse);
  if (!single && fine.status == ShootingStatus::converged) {
    coarse = std::move(fine);
    fine = run_with(plan.fine);
    if (fine.status != ShootingStatus::converged) {
      // Keep the coarser answer; its error is not known.
      result.status = fine.status;
      result.message = fine.message;
      fine = std::move(coarse);
      result.orbit = orbit_of(motion, fine.states);
      result.exponents = exponents_of({fine.multipliers, nullptr, 0, plan.num_segments, fine.steps, Omega});
      result.q_error = result.q1_error = result.growth_error = INFINITY;
      if (!result.exponents.empty()) result.growth_rate = result.exponents.front().value.real();
      return;
    }
  }
  result.status = fine.status;
  result.message = fine.message;
  if (fine.status != ShootingStatus::converged) return;

  result.orbit = orbit_of(motion, fine.states);
  // Collocation: rounding, some 1e-15 (measured), taken tenfold. CVODE: all steps of a segment err the same way.
  const double map_error = collocation ? 1e-14
                                       : error_per_step(plan.integrator, plan.fine.tolerance) *
                                             static_cast<double>(fine.steps) / plan.num_segments;
  if (!single) {
    result.coarser = orbit_of(motion, coarse.states);
    const double rounding = 1e-14 + eps * std::sqrt(static_cast<double>(fine.steps));
    const auto error = [&](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double sensitivity) {
      return difference_factor * (relative_difference(a, b) + sensitivity) + rounding;
    };
    result.q_error = error(result.orbit.q, result.coarser.q, fine.x_sensitivity);
    result.q1_error = error(result.orbit.q1, result.coarser.q1, fine.v_sensitivity);
  }
  if (!judge_exponents(
          {fine.multipliers, single ? nullptr : &coarse.multipliers, map_error, plan.num_segments, fine.steps, Omega},
          result))
    return;
  const double growth_scale = std::max(std::abs(result.growth_rate), Omega);
  const bool reached =
      single || (result.q_error <= options.tolerance && result.growth_error <= options.tolerance * growth_scale);
  if (!reached) {
    result.status = ShootingStatus::not_reached;
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(),
                  "%s reaches an error of q of %.1e and of the growth rate of %.1e, asked %.1e",
                  to_string(plan.integrator), result.q_error, result.growth_error / growth_scale, options.tolerance);
    result.message = text.data();
  }
}

}  // namespace

ShootingResult solve_by_shooting(const TimeDomainSystem& system, const ShootingOptions& options) {
  const Deadline start = std::chrono::steady_clock::now();
  const Deadline deadline = deadline_after(start, options.time_limit);
  ScaledMotion motion(system);
  const FrozenSpectrum spectrum = frozen_spectrum(motion);
  Plan plan = choose_plan(motion, spectrum, options);

  ShootingResult result;
  const auto affordable = [&](const Plan& candidate) {
    return candidate.predicted_seconds <= options.time_limit - seconds_since(start);
  };
  result.integrator = plan.integrator;
  result.predicted_seconds = plan.predicted_seconds;
  if (!affordable(plan)) {
    result.status = ShootingStatus::too_expensive;
    result.message = std::string(to_string(plan.integrator)) + " would need about " +
                     std::to_string(static_cast<long long>(std::min(std::ceil(plan.predicted_seconds), 1e15))) +
                     " s, more than the limit for a case";
  } else {
    solve_by(motion, plan, options, system.speed, deadline, result);
    // What CVODE cannot reach, collocation of order 17 usually can.
    const bool may_supplement =
        options.integrator == Integrator::automatic && options.single_run <= 0 &&
        plan.integrator != Integrator::collocation &&
        (result.status == ShootingStatus::not_reached || result.status == ShootingStatus::failed);
    if (may_supplement) {
      plan = plan_shooting(motion, spectrum, Integrator::collocation, options.tolerance, 0);
      if (affordable(plan)) {
        ShootingResult supplement;
        supplement.steps = result.steps;
        supplement.predicted_seconds = result.predicted_seconds + plan.predicted_seconds;
        solve_by(motion, plan, options, system.speed, deadline, supplement);
        const bool better = supplement.status == ShootingStatus::converged ||
                            (supplement.status == ShootingStatus::not_reached && supplement.q_error < result.q_error);
        if (better) result = std::move(supplement);
      }
    }
  }
  result.evaluations = motion.evaluations();
  result.seconds = seconds_since(start);
  return result;
}

}  // namespace hb
