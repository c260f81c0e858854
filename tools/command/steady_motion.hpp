// hb steady --theory nonlinear.
#pragma once

#include <string>
#include <vector>

#include "tools/command/common_flags.hpp"
#include "tools/command/theory_flags.hpp"

namespace hb::tools {

struct SteadyFlags : CommonFlags {
  TheoryFlags theory;
  bool multipliers = false;
  std::string measured;
  std::vector<std::string> bands;
};

// Motions of one turn have tables and pictures, longer ones the document alone.
[[nodiscard]] int run_steady_motion(const SteadyFlags& flags);

}  // namespace hb::tools
