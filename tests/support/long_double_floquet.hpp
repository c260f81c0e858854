// Reference for tests: Floquet exponents by propagation over one turn in long double, Radau IIA with 12 stages (order
// 23, stiffly accurate), every exponent with the change that more cells and another first angle make. Shares nothing
// with the engine but types.
#pragma once

#include <complex>
#include <vector>

#include "lib/hill_system.hpp"

namespace hb::reference {

using Real = long double;
using Complex = std::complex<long double>;

struct FloquetExponent {
  Complex value;  // 1/time, imaginary part modulo speed
  Real error;
};

// Exponents whose multipliers are not lost in the rounding of the product (1e-13 of the largest), leading one first.
std::vector<FloquetExponent> floquet_exponents(const HillSystem& system, double speed);

}  // namespace hb::reference
