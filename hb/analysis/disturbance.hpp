// What a disturbance of the periodic motion looks like to someone who records it: its lines in a spectrum.
#pragma once

#include <vector>

#include "hb/engine/exponents/stability.hpp"
#include "lib/hill_system.hpp"

namespace hb {

struct DisturbanceLine {
  double frequency = 0;  // >= 0, rad per unit time
  double share = 0;  // of the strongest line, by the length of the vector of all q_i
};

// Lines |Im lambda + k Omega| of Re x(t) e^(lambda t), x its Floquet vector, the strongest first, those above `least`.
// Empty where the vector is not resolved.
[[nodiscard]] std::vector<DisturbanceLine> disturbance_lines(const HillSystem& system, double speed,
                                                             const Exponent& exponent, double least = 0.5);

}  // namespace hb
