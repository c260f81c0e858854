// Reference: Floquet exponents in 113 bits, by Taylor series over a turn and QR sweeps. Shares nothing with the engine
// but the type of its input.
#pragma once

#include <vector>

#include "lib/hill_system.hpp"
#include "tools/attack/quad.hpp"

namespace hb::attack {

struct ReferenceExponent {
  QuadComplex s;  // per radian of crank angle, imaginary part in (-1/2, 1/2]
  double error = 0;  // ten times what another first angle, step and order change
};

// All 2I of M q'' + B q' + C(Omega t) q = 0, real part descending. Throws std::runtime_error where the sweeps do not
// settle, or the system would take too many steps.
[[nodiscard]] std::vector<ReferenceExponent> reference_exponents(const HillSystem& system, double speed);

// Distance modulo i.
[[nodiscard]] double distance(QuadComplex a, QuadComplex b);

}  // namespace hb::attack
