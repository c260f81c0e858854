// Fixed-step integrators as engineers use them, marching from rest until the state repeats; for comparison only.
#pragma once

#include "hb/engine/time/marching.hpp"
#include "lib/time_domain.hpp"

namespace hb {

enum class FixedStep {
  newmark,  // average acceleration (beta = 1/4, gamma = 1/2): second order, stable at any step
  runge_kutta,  // classical, fourth order, explicit
};

// Marches turn by turn with `steps_per_turn` (a multiple of 8) equal steps until the state repeats within `tolerance`
// of its largest, at most `max_turns`. The orbit holds 8 samples if steps_per_turn is no multiple of 128, else 128.
// Status not_reached: did not settle, or grew beyond all bounds (an explicit step too long).
[[nodiscard]] MarchingResult march_fixed_step(const TimeDomainSystem& system, FixedStep method, int steps_per_turn,
                                              double tolerance, int max_turns, double time_limit);

}  // namespace hb
