// The discriminant of one mode, from which its growth rate and its verdict follow: unlike the growth rate it is an
// analytic function of all that the coefficients depend on. Derivation: hb/engine/README.md, "One mode".
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <optional>

#include "hb/engine/system/scaled_system.hpp"

namespace hb {

// Of x'' + b x' + k(tau) x = 0 with its shortest period as a turn, exponents s: hb/engine/README.md, (D1).
struct Discriminant {
  double value = 0;  // cosh 2 pi (s + b/2)
  double error = HUGE_VAL;  // estimate, as that of the exponents
  double damping = 0;  // b
  double damping_error = HUGE_VAL;  // bound
  double speed = 0;  // of the shortest period, rad per unit time

  // Where |value| exceeds it the mode is unstable: cosh pi b, b >= 0.
  double limit() const { return std::cosh(std::numbers::pi * damping); }
};

// `divisor`: K has only every such harmonic (independent_parts.hpp, common_divisor). `tolerance`: wanted error of the
// exponents as in reduced_exponents.hpp. Empty where K has other harmonics, or no exponents are found.
[[nodiscard]] std::optional<Discriminant> discriminant(const ScaledSystem& one_mode, Eigen::Index divisor,
                                                       double tolerance);

}  // namespace hb
