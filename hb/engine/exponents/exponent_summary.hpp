// From exponents per radian of crank angle, with their errors, to growth rate and verdict. Used inside the engine.
#pragma once

#include <vector>

#include "hb/engine/exponents/exponent_search.hpp"

namespace hb {

// Imaginary part in units of Omega to (-1/2, 1/2].
[[nodiscard]] double folded(double s);

// Real part descending, then imaginary part ascending.
void sort(std::vector<Exponent>& exponents);

// The growth rate from what is known about it; an interval without a finite end on both sides leaves the verdict to
// the other one.
void set_growth(Stability& result, double growth, double low, double high);

// Exponents in given units, those resolved and the others, with growth rate and verdict.
[[nodiscard]] Stability summary(const ExponentSearch& search, double speed, double tolerance);

}  // namespace hb
