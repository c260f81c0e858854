// Stability of a periodic motion: Floquet exponents of its variations
//     M(tau) x_tt + B(tau) x_t + C(tau) x = 0,     M = dr/dq_tt, B = dr/dq_t, C = dr/dq along the motion,
// over its T turns.
#pragma once

#include "hb/engine/exponents/periodic_exponents.hpp"
#include "hb/engine/nonlinear/periodic_motion.hpp"

namespace hb {

// Imaginary parts are folded to (-omega/2, omega/2], omega = Omega/T: +-omega/2 is a multiplier -1 over the T turns.
// The motion's own error enters by the coefficients along q_finer. Undecided where the motion is not known to anything.
[[nodiscard]] Stability motion_stability(const NonlinearSystem& system, const PeriodicMotion& motion,
                                         const StabilityOptions& options = {});

// The same where the derivatives of r along the motion are known at its own samples already.
[[nodiscard]] Stability motion_stability(const NonlinearSystem& system, const PeriodicMotion& motion,
                                         const ResidualSamples& along, const StabilityOptions& options = {});

}  // namespace hb
