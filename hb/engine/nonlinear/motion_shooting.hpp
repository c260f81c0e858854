// A periodic motion and its multipliers by integration in time: multiple shooting with the variations integrated beside
// the motion. Checks harmonic balance; shares no Fourier series with it.
#pragma once

#include <functional>
#include <string>

#include "hb/engine/nonlinear/nonlinear_system.hpp"
#include "hb/engine/time/shooting.hpp"

namespace hb {

struct MotionShootingOptions {
  double tolerance = 1e-8;  // wanted: max_t |error of q| / max_t |q|, and error of the growth rate relative to Omega
  int turns = 1;
  Integrator integrator = Integrator::automatic;  // adams or bdf: the one predicted to take fewer steps
  int max_iterations = 20;
  std::function<bool()> stop = {};
};

// State at the start of a search: q and q' = dq/dtau at N equally spaced crank angles over the turns.
struct StartingOrbit {
  Eigen::MatrixXd q, q1;  // n x N
};

// Status not_reached where the errors exceed the tolerance, failed where Newton's method does not converge or the
// equations end, time_limit where it was stopped. The orbit's N samples span all turns; exponents are modulo
// Omega/turns. Two runs at integrator tolerances 8 apart give the errors (estimates).
[[nodiscard]] ShootingResult shoot_motion(const NonlinearSystem& system, double parameter, const StartingOrbit& start,
                                          const MotionShootingOptions& options = {});

}  // namespace hb
