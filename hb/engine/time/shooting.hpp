// Periodic solution and Floquet exponents by time integration: multiple shooting on a time-domain system. Validation of
// harmonic balance; independent of Fourier series and Hill systems.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/time/periodic_orbit.hpp"
#include "hb/engine/time/time_integration.hpp"
#include "lib/time_domain.hpp"

namespace hb {

struct ShootingOptions {
  double tolerance = 1e-9;  // wanted: max_t |error of q| / max_t |q|, and error of the growth rate relative to Omega
  Integrator integrator = Integrator::automatic;
  double time_limit = 60;  // seconds; work predicted to exceed it is not begun
  // 0: two runs at integrator tolerances 8 apart, chosen from `tolerance`, their difference the error. Else one run at
  // this CVODE tolerance (collocation: 2 pi/this many cells per turn) without an error estimate.
  double single_run = 0;
  std::function<void(Integrator, double seconds)> begin = {};  // told before work is begun, with its predicted time
};

enum class ShootingStatus {
  converged,  // both errors within the tolerance
  not_reached,  // a result, errors above the tolerance
  too_expensive,  // predicted to exceed the time limit; nothing was integrated
  time_limit,  // stopped by the limit
  singular,  // no unique periodic solution (a multiplier 1 to working accuracy)
  failed,  // the integrator gave up
};

// Error of the finer of two runs from their difference and the cycle's sensitivity. Both together are no bound: where
// fast modes have died out, Adams and BDF of high order step at their bound of stability, err far less than the
// tolerance or as much, and the looser of two runs by chance less than the tighter. Of 1475 runs of the project's
// scenes one erred 3.5 times this sum, the others 2.2 times at most.
inline constexpr double difference_factor = 5;

struct ShootingResult {
  ShootingStatus status = ShootingStatus::failed;
  std::string message;  // what stopped it; empty if converged
  PeriodicOrbit orbit;
  PeriodicOrbit coarser;  // of the less accurate run: the difference of what is computed from both, times
                          // difference_factor, is its error
  double q_error = 0;  // estimate of max_t |error of q| / max_t |q|
  double q1_error = 0;  // of q', relative to max_t |q'|
  std::vector<Exponent> exponents;  // real part descending; those that the integration resolves
  bool some_below = false;  // others, with smaller real parts than `complete_above`, are not listed
  double complete_above = -INFINITY;
  double growth_rate = 0, growth_error = 0;
  Verdict verdict = Verdict::undecided;
  Integrator integrator = Integrator::automatic;  // the one used
  double integrator_tolerance = 0;  // CVODE's, or collocation's cell length in rad, of the finer run
  int num_segments = 0;
  long steps = 0, evaluations = 0;  // all runs
  double predicted_seconds = 0, seconds = 0;
};

[[nodiscard]] ShootingResult solve_by_shooting(const TimeDomainSystem& system, const ShootingOptions& options = {});

[[nodiscard]] const char* to_string(ShootingStatus status);

}  // namespace hb
