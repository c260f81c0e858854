// Exponents of Mathieu's damped equation x'' + b x' + (w^2 + 2 Re(c e^{i tau})) x = 0 by Hill's determinant: four
// three-term recurrences and a closed-form tail, no propagation.
#pragma once

#include <complex>
#include <optional>

#include "hb/engine/exponents/scalar_hill.hpp"

namespace hb {

struct MathieuEquation {
  double w2 = 0;  // mean stiffness; per radian of crank angle as everything here
  double q = 0;  // |c|
  double b = 0;
  double stiffness_error = 0;  // bounds on the errors of w2 and q, and of b
  double damping_error = 0;
};

// With x = e^{-b tau/2} y and a = w^2 - b^2/4, exponents are -b/2 +- mu (Whittaker & Watson, Modern Analysis, 19.42):
//     sinh^2 pi mu = -pi^2 F_even F_odd,      cosh^2 pi mu = G_even G_odd,
// F and G the determinants of the Fourier recurrences of even and odd solutions, periodic (harmonics 0, 1, 2, ..) and
// antiperiodic (1/2, 3/2, ..), each row divided by minus its harmonic squared. Their zeros are the boundaries of the
// tongues, so that nothing is lost near one. Rounding is bounded step by step; cosh^2 - sinh^2 = 1 is checked. Empty if
// that fails, or if the recurrences would have to be too long.
[[nodiscard]] std::optional<ExponentPair> mathieu_exponents(const MathieuEquation& equation);

}  // namespace hb
