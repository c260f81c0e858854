#include "hb/engine/nonlinear/motion_shooting.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "hb/engine/time/floquet_product.hpp"
#include "hb/engine/time/integration_cost.hpp"
#include "hb/engine/time/run_comparison.hpp"
#include "hb/engine/time/variational_integration.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int num_outputs = 128;  // per period

// r(tau, q, q_t, q_tt) = 0 solved for q_tt by Newton's method (one step where r is linear in it), with
//     da/dq = -r_a^-1 r_q,   da/dv = -r_a^-1 r_v;      in radians of crank angle a/Omega^2, v Omega.
class Acceleration {
 public:
  Acceleration(const NonlinearSystem& system, double parameter)
      : system_(system), p_(parameter), Omega_(system.speed(parameter)) {
    const Index n = system.num_unknowns;
    at_.angle.resize(1);
    at_.q = at_.v = at_.a = MatrixXd::Zero(n, 1);
  }

  bool operator()(double tau, const VectorXd& q, const VectorXd& v, AccelerationSamples& result) {
    const Index n = system_.num_unknowns;
    at_.angle(0) = tau;
    at_.q = q;
    at_.v = Omega_ * v;
    constexpr int most_steps = 10;
    bool settled = false;
    for (int step = 0; step < most_steps && !settled; ++step) {
      if (auto failure = system_.evaluate(p_, at_, Derivatives::state, r_)) {
        failure_ = failure->reason;
        at_.a.setZero();
        return false;
      }
      mass_.compute(MatrixXd(r_.da.reshaped(n, n)));
      const VectorXd change = mass_.solve(VectorXd(r_.r.col(0)));
      if (!change.allFinite()) return false;
      at_.a -= change;
      // Derivatives are those before this change, of which they feel no more than its size.
      settled = step > 0 && change.norm() <= 1e-11 * at_.a.norm() + 1e-300;
      settled = settled || change.norm() == 0;
    }
    result.a = at_.a / (Omega_ * Omega_);
    result.by_q = mass_.solve(MatrixXd(r_.dq.reshaped(n, n))) / (-Omega_ * Omega_);
    result.by_v = mass_.solve(MatrixXd(r_.dv.reshaped(n, n))) / -Omega_;
    return true;
  }

  double speed() const { return Omega_; }
  const std::string& failure() const { return failure_; }

 private:
  const NonlinearSystem& system_;
  double p_, Omega_;
  MotionSamples at_;
  ResidualSamples r_;
  dense::Lu<double> mass_;
  std::string failure_;
};

// Frequencies, and all eigenvalues, of the variations frozen at angles along the start.
bool look_along(Acceleration& acceleration, const StartingOrbit& start, double period, NonlinearMotion& motion,
                FrozenSpectrum& spectrum) {
  constexpr Index most_looks = 16;
  const Index n = start.q.rows(), N = start.q.cols(), looks = std::min(N, most_looks);
  VectorXd stiffness = VectorXd::Zero(n);
  AccelerationSamples at;
  double mean = 0;
  for (Index j = 0; j < looks; ++j) {
    const Index sample = j * N / looks;
    if (!acceleration(period * double(sample) / double(N), start.q.col(sample), start.q1.col(sample), at)) return false;
    stiffness += at.by_q.diagonal().cwiseAbs() / double(looks);
    MatrixXd J = MatrixXd::Zero(2 * n, 2 * n);
    J.topRightCorner(n, n).setIdentity();
    J.bottomLeftCorner(n, n) = at.by_q;
    J.bottomRightCorner(n, n) = at.by_v;
    spectrum.eigenvalues.push_back(dense::eigenvalues(J));
    mean += spectrum.eigenvalues.back().real().maxCoeff() / double(looks);
    spectrum.fastest = std::max(spectrum.fastest, spectrum.eigenvalues.back().cwiseAbs().maxCoeff());
  }
  spectrum.slowest = std::abs(mean);
  motion.w = stiffness.cwiseSqrt().cwiseMax(1.0);
  const double largest = start.q.cwiseAbs().maxCoeff();
  motion.q_scale = largest > 0 ? largest : 1;
  return true;
}

struct Cycle {
  ShootingStatus status = ShootingStatus::failed;
  std::string message;
  std::vector<VectorXd> starts;  // of the segments
  MatrixXd states;  // 2n x num_outputs
  std::vector<SegmentMap> segments;
  double last_change = 0;  // of the starts
  long steps = 0;
};

struct Shooting {
  const NonlinearMotion& motion;
  Acceleration& acceleration;
  Integrator method;
  double period;  // rad of crank angle
  int num_segments;
  const MotionShootingOptions& options;

  // Newton's method on the segments' starts: y_(k+1) = end_k(y_k), y_K = y_0.
  Cycle solve(std::vector<VectorXd> starts, double tolerance) const {
    Cycle cycle;
    cycle.starts = std::move(starts);
    const int outputs_per_segment = num_outputs / num_segments;
    std::vector<double> outputs(std::size_t(outputs_per_segment), 0.0);
    double last = HUGE_VAL;
    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
      cycle.segments.clear();
      cycle.states.resize(cycle.starts.front().size(), num_outputs);
      for (int k = 0; k < num_segments; ++k) {
        for (int j = 0; j < outputs_per_segment; ++j)
          outputs[std::size_t(j)] = period * (k * outputs_per_segment + j + 1) / num_outputs;
        const VectorXd& start = cycle.starts[std::size_t(k)];
        const Trajectory part =
            integrate_variations(motion, method, tolerance, period * k / num_segments, start, outputs, options.stop);
        cycle.steps += part.steps;
        if (part.status != IntegrationStatus::finished) {
          cycle.status =
              part.status == IntegrationStatus::time_limit ? ShootingStatus::time_limit : ShootingStatus::failed;
          cycle.message = part.message;
          if (!acceleration.failure().empty()) cycle.message += " (" + acceleration.failure() + ")";
          return cycle;
        }
        cycle.states.col(k * outputs_per_segment) = start;
        for (int j = 1; j < outputs_per_segment; ++j)
          cycle.states.col(k * outputs_per_segment + j) = part.states[std::size_t(j - 1)].col(0);
        const MatrixXd& end = part.states.back();
        const VectorXd& next = cycle.starts[std::size_t((k + 1) % num_segments)];
        cycle.segments.push_back({end.rightCols(start.size()), end.col(0) - next});
      }
      const CyclicSolution change = solve_cyclic(cycle.segments);
      if (!(change.reciprocal_condition > 1e-13)) {
        cycle.status = ShootingStatus::singular;
        cycle.message = "a multiplier is 1 to the accuracy of the integration: no unique periodic motion";
        return cycle;
      }
      double size = 0, largest = 0;
      for (int k = 0; k < num_segments; ++k) {
        cycle.starts[std::size_t(k)] += change.states[std::size_t(k)];
        size = std::max(size, change.states[std::size_t(k)].cwiseAbs().maxCoeff());
        largest = std::max(largest, cycle.starts[std::size_t(k)].cwiseAbs().maxCoeff());
      }
      cycle.last_change = size;
      if (!std::isfinite(size)) break;
      // Below the integration's errors, where Newton's method no longer gains.
      const double floor = 100 * tolerance * std::max(largest, 1e-3);
      if (size <= floor || (size <= 1e3 * floor && size > 0.1 * last)) {
        // The motion through the changed starts, to first order.
        for (int k = 0; k < num_segments; ++k) cycle.states.col(k * outputs_per_segment) = cycle.starts[std::size_t(k)];
        cycle.status = ShootingStatus::converged;
        return cycle;
      }
      last = size;
    }
    cycle.message = "Newton's method on the starting states does not converge";
    return cycle;
  }

  PeriodicOrbit orbit(const Cycle& cycle) const {
    const Index n = motion.num_unknowns();
    PeriodicOrbit orbit;
    orbit.q = motion.q_scale * cycle.states.topRows(n);
    orbit.q1 = motion.q_scale * motion.w.asDiagonal() * cycle.states.bottomRows(n);
    orbit.q2.resize(n, num_outputs);
    AccelerationSamples at;
    for (Index j = 0; j < num_outputs; ++j) {
      (void)motion.acceleration(period * double(j) / num_outputs, orbit.q.col(j), orbit.q1.col(j), at);
      orbit.q2.col(j) = at.a;
    }
    return orbit;
  }
};

double relative_difference(const MatrixXd& a, const MatrixXd& b) {
  const double size = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  return size > 0 ? (a - b).cwiseAbs().maxCoeff() / size : 0;
}

void check_start(const NonlinearSystem& system, const StartingOrbit& start, const MotionShootingOptions& options) {
  validate(system);
  if (start.q.rows() != system.num_unknowns || start.q1.rows() != start.q.rows() || start.q.cols() < 1 ||
      start.q1.cols() != start.q.cols())
    throw std::invalid_argument("shoot_motion: the start needs q and q' of every unknown at the same angles");
  if (options.turns < 1) throw std::invalid_argument("MotionShootingOptions: turns must be at least 1");
}

}  // namespace

ShootingResult shoot_motion(const NonlinearSystem& system, double parameter, const StartingOrbit& start,
                            const MotionShootingOptions& options) {
  check_start(system, start, options);
  const auto began = std::chrono::steady_clock::now();
  const double period = two_pi * options.turns;
  Acceleration acceleration(system, parameter);
  NonlinearMotion motion;
  FrozenSpectrum spectrum;
  ShootingResult result;
  if (!look_along(acceleration, start, period, motion, spectrum)) {
    result.message = acceleration.failure();
    return result;
  }
  motion.acceleration = [&](double tau, const VectorXd& q, const VectorXd& v, AccelerationSamples& at) {
    ++result.evaluations;
    return acceleration(tau, q, v, at);
  };
  // A segment in which the slow modes change by no more than e^4 keeps them above the integrator's noise.
  int num_segments = 1;
  while (num_segments < period * spectrum.slowest / 4 && num_segments < num_outputs) num_segments *= 2;
  // Measured for linear systems: an exponent's error is 1e2 (Adams) to 1e5 (BDF) local tolerances.
  const auto tolerance_of = [&](Integrator method) {
    return std::clamp(1e-4 * options.tolerance, method == Integrator::bdf ? 1e-13 : 1e-14, 1e-3);
  };
  Integrator method = options.integrator;
  if (method == Integrator::automatic) {
    const auto steps = [&](Integrator m) { return predicted_steps(spectrum, m, tolerance_of(m), num_segments); };
    method = steps(Integrator::adams) <= steps(Integrator::bdf) ? Integrator::adams : Integrator::bdf;
  }
  const Shooting shooting{motion, acceleration, method, period, num_segments, options};
  std::vector<VectorXd> starts;
  const Index n = system.num_unknowns, N = start.q.cols();
  for (int k = 0; k < num_segments; ++k) {
    // The nearest sample: Newton's method closes the gaps.
    const Index j = Index(std::lround(double(k) * double(N) / num_segments)) % N;
    VectorXd state(2 * n);
    state << start.q.col(j) / motion.q_scale, start.q1.col(j).cwiseQuotient(motion.w) / motion.q_scale;
    starts.push_back(std::move(state));
  }
  const double fine_tolerance = tolerance_of(method);
  result.integrator = method;
  result.num_segments = num_segments;
  result.integrator_tolerance = fine_tolerance;
  const Cycle coarse = shooting.solve(starts, 8 * fine_tolerance);
  const Cycle fine =
      coarse.status == ShootingStatus::converged ? shooting.solve(coarse.starts, fine_tolerance) : coarse;
  result.steps = coarse.steps + fine.steps;
  result.status = fine.status;
  result.message = fine.message;
  if (fine.status == ShootingStatus::converged) {
    result.orbit = shooting.orbit(fine);
    result.coarser = shooting.orbit(coarse);
    const double left = fine.last_change / std::max(1e-300, fine.states.cwiseAbs().maxCoeff());
    result.q_error = difference_factor * relative_difference(result.orbit.q, result.coarser.q) + left + 1e-14;
    result.q1_error = difference_factor * relative_difference(result.orbit.q1, result.coarser.q1) + left + 1e-14;
    const double noise = 1e3 * fine_tolerance;
    const LogMultipliers fine_log = log_multipliers(fine.segments, noise);
    const LogMultipliers coarse_log = log_multipliers(coarse.segments, noise);
    const double map_error = (method == Integrator::bdf ? 5 : 1) * fine_tolerance * double(fine.steps) / num_segments;
    const double omega = acceleration.speed() / options.turns;
    if (judge_exponents({fine_log, &coarse_log, map_error, num_segments, fine.steps, omega}, result)) {
      const double scale = std::max(std::abs(result.growth_rate), omega);
      if (!(result.q_error <= options.tolerance && result.growth_error <= options.tolerance * scale)) {
        result.status = ShootingStatus::not_reached;
        result.message = "the integration's errors are larger than asked";
      }
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return result;
}

}  // namespace hb
