// The project's own systems and synthetic ones, named as in the tables.
#pragma once

#include <string>
#include <vector>

#include "lib/hill_system.hpp"

namespace hb::benchmarks {

struct Case {
  std::string name;
  HillSystem system;
  double speed;
  bool integrate;  // shooting takes seconds at most
};

// x'' + 0.1 x' + (1.2 + 0.4 cos t) x = cos t; rod AB of the six-link mechanism and the slider-crank's, five modes;
// synthetic systems of 1 to 40 modes.
[[nodiscard]] std::vector<Case> all_cases();

}  // namespace hb::benchmarks
