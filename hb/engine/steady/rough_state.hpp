// The periodic answer to a load to a few digits, without an error bound: one solve on a predicted window of harmonics.
#pragma once

#include <optional>

#include "lib/hill_system.hpp"

namespace hb {

// Of M q'' + B q' + C q = h over the crank angle, the residual of the window's rows below `tolerance` of the load; near
// resonance the error is as many times larger as the response. Empty where the iteration does not get there:
// solve_steady_state finds out why.
[[nodiscard]] std::optional<FourierSeries> rough_steady_state(const HillSystem& system, double speed, double tolerance);

// How many times larger than without cancellation of stiffness and inertia one mode answers to the harmonic of the
// crank angle that is nearest to its resonance, with the mean stiffness; the largest of all modes.
[[nodiscard]] double nearest_amplification(const HillSystem& system, double speed);

}  // namespace hb
