// The periodic state of one rod in q_1..q_I, whatever unknowns its system has (lib/rod/shear.hpp).
#pragma once

#include <optional>

#include "hb/engine/steady/steady_state.hpp"

namespace hb {

// solve_steady_state of a rod's or a [hill] scene's system with num_modes or 2 num_modes unknowns: status and error
// bound are those of q.
[[nodiscard]] SteadyState solve_rod(const HillSystem& system, Eigen::Index num_modes, double speed,
                                    const SteadyOptions& options);
// The same where the scaled form of the system at a speed is there already.
[[nodiscard]] SteadyState solve_rod(const HillSystem& system, Eigen::Index num_modes, const ScaledSystem& scaled,
                                    SteadyOptions options);
// q to nearly `accuracy` of its largest value, without an error bound: what is left of the load grows by the resonance.
// Empty where that is not reached at once, as near a response without bound: solve_rod tells why. `near`: q of fewer
// modes where it is there, or nullptr.
[[nodiscard]] std::optional<FourierSeries> rough_rod(const HillSystem& system, Eigen::Index num_modes, double speed,
                                                     double accuracy, const FourierSeries* near = nullptr);

}  // namespace hb
