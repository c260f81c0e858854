// Systems of any size to measure on.
#pragma once

#include "lib/hill_system.hpp"

namespace hb::benchmarks {

// Frequencies 2.3 i, damping 1 %, two harmonics of stiffness coupling all modes by 10 %, load of three harmonics.
[[nodiscard]] HillSystem synthetic(Eigen::Index num_modes);

}  // namespace hb::benchmarks
