// What tells one sweep from another, for what is kept of it in a file.
#pragma once

#include <cstdint>

#include "hb/analysis/sweep_analysis.hpp"

namespace hb::tools {

// Of everything that the points depend on: the scene's numbers, the axis, the flags.
[[nodiscard]] std::uint64_t sweep_key(const SweepScene& scene);

}  // namespace hb::tools
