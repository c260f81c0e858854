// How a sweep moves with damping, Young's modulus or mass, as the page draws it.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/report/byte_block.hpp"

namespace hb::tools {

// `sweep` as sweep_json has it, with `bands` of sweep_bands_json. A list: factors, of each rod max_abs (the first
// components) and growth_rate as columns at both ends over the points, the largest of all points, and the verdicts at
// both ends as letters.
[[nodiscard]] nlohmann::ordered_json sweep_band_data(const nlohmann::ordered_json& sweep, ByteBlock& block);

}  // namespace hb::tools
