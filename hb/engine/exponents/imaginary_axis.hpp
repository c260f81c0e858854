// Exponents of systems without damping that are known to lie on the imaginary axis.
//
// M and C symmetric, B = -B^T: the equations are Hamilton's, and with s also -conj(s) is an exponent (A. M. Lyapunov;
// V. A. Yakubovich & V. M. Starzhinskii, Linear Differential Equations with Periodic Coefficients, 1975, ch. III). An
// exponent whose mirror image reaches no other exponent's disc is therefore its own image: Re s = 0; if all are listed,
// which needs discs that do not overlap.
#pragma once

#include <complex>
#include <span>

#include "hb/engine/exponents/stability.hpp"

namespace hb {

// Whether each disc and its mirror image, |z + conj(s_i)| <= error_i, lie apart from all the other discs modulo i
// `period`.
[[nodiscard]] bool images_apart(std::span<const std::complex<double>> s, std::span<const double> error, double period);

// All exponents of one independent part lie on the axis and are simple: disturbances stay bounded. Real parts, growth
// rate and its error become exactly zero.
void put_on_axis(Stability& stability);

}  // namespace hb
