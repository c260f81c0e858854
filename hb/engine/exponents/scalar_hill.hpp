// Exponents of one damped Hill equation x'' + beta(tau) x' + alpha(tau) x = 0 by its phase function: no propagation,
// so a mode thousands of harmonics away from zero, or overdamped, costs the same as a slow one.
#pragma once

#include <array>
#include <complex>
#include <optional>

#include "lib/fourier/fourier.hpp"

namespace hb {

struct ExponentPair {
  std::array<std::complex<double>, 2> s;  // per radian of crank angle, imaginary part not folded
  std::array<double, 2> error;  // bounds on |error|
};

// With x = exp(-int beta/2) y, y'' + Q y = 0 and Q = alpha - beta^2/4 - beta'/2, the solutions are
// y = psi^-1/2 exp(+-i int psi) with
//     psi^2 = Q - psi''/(2 psi) + 3/4 (psi'/psi)^2,
// found by iteration from psi^2 = Q (E. Kummer's equation; WKB expansion). What is left of the equation is corrected to
// first order; the second, or the first where multipliers may be real, is the error bar: hb/engine/README.md (E9),
// (E25). `alpha_error`, `beta_error` bound the errors of the coefficients and enter it. Empty if Q changes sign, or the
// expansion does not settle within `tolerance` (bound on the error): then the equation has to be propagated.
[[nodiscard]] std::optional<ExponentPair> phase_exponents(const FourierSeries& alpha, const FourierSeries& beta,
                                                          double alpha_error, double beta_error, double tolerance);

}  // namespace hb
