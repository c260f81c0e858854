// What bending changes of the growth rate: the part of the theory error that concerns stability.
#pragma once

#include <optional>
#include <span>

#include "hb/analysis/theory_error.hpp"

namespace hb {

// Largest real part of the exponents of all rods together, of the variations about q + dq, less that of the linear
// rods, per unit time: absolute value, to 2 %, or the larger number by which it is still uncertain. The first modes of
// each rod alone, on both sides. Empty where the exact model has no value there: no correction, a rod with shear,
// exponents that do not resolve.
[[nodiscard]] std::optional<double> growth_theory_error(const Linkage& linkage, double speed,
                                                        std::span<const LinearRod> rods, const TheoryErrors& errors);

}  // namespace hb
