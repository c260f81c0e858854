// The periodic answer to a load to a few digits, without an error bound: one solve on a predicted window of harmonics.
#pragma once

#include <optional>

#include "lib/hill_system.hpp"

namespace hb {

struct RoughState {
  FourierSeries q;
  // |q| over that of the load divided by the size of the diagonal without cancellation, both over the turn: large near
  // resonance. 0 without load.
  double amplification = 0;
};

// Of M q'' + B q' + C q = h over the crank angle, the residual of the window's rows below `tolerance` of the load; near
// resonance the error is as many times larger as the response. Empty where the iteration does not get there:
// solve_steady_state finds out why.
[[nodiscard]] std::optional<RoughState> rough_steady_state(const HillSystem& system, double speed, double tolerance);

}  // namespace hb
