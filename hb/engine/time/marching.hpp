// Plain marching from rest until the motion repeats: what an experimenter would do, for validation.
#pragma once

#include <string>

#include "hb/engine/time/shooting.hpp"

namespace hb {

struct MarchingOptions {
  double tolerance =
      1e-9;  // march until the state repeats after a turn within this, relative to its largest over the turn
  double integrator_tolerance = 0;  // CVODE's; 0: tolerance/1000
  Integrator integrator = Integrator::automatic;  // adams or bdf
  double time_limit = 60;  // seconds
  double growth_rate = 0;  // if known, 1/time: predicts the turns that the transient needs; 0: not known
};

struct MarchingResult {
  // converged: settled, to the tolerance or as far as the integrator's own errors let it; q_error says how far
  ShootingStatus status = ShootingStatus::failed;
  std::string message;
  PeriodicOrbit orbit;  // of the last turn
  double change = 0;  // of the state over the last turn, relative
  double q_error = 0;  // changes summed to the end of the transient, plus CVODE's errors summed over it
  double decay_per_turn = 0;  // factor by which the transient shrinks in a turn, from growth_rate or measured
  int turns = 0;
  Integrator integrator = Integrator::automatic;
  long steps = 0, evaluations = 0;
  double seconds = 0;
};

// From rest, as an experimenter would.
[[nodiscard]] MarchingResult march_from_rest(const TimeDomainSystem& system, const MarchingOptions& options = {});

}  // namespace hb
