// Floquet exponents of a system whose mass and damping vary over the period as its stiffness does.
#pragma once

#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/system/periodic_system.hpp"

namespace hb {

// All unknowns propagated over the period by Radau IIA with two numbers of cells. Errors of exponents are estimates:
// cells, rounding, harmonics that the samples cannot tell, and `errors` of the coefficients carried over the period.
// Of the options only the tolerance and leading_only are used. Imaginary parts are modulo the system's own speed.
[[nodiscard]] Stability analyse_stability(const PeriodicSystem& system, const StabilityOptions& options = {},
                                          const CoefficientErrors& errors = {});
[[nodiscard]] Stability analyse_stability(const NormalForm& form, double speed, const StabilityOptions& options = {},
                                          const CoefficientErrors& errors = {});

}  // namespace hb
