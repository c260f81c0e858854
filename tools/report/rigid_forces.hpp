// Joint forces and torque of the rigid mechanism at all speeds at once.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "tools/report/byte_block.hpp"
#include "tools/report/report_places.hpp"

namespace hb::tools {

// "joints" by name and "torque": the series of the powers of Omega, from places of one mechanism; null where no place
// has forces.
[[nodiscard]] nlohmann::ordered_json rigid_forces_json(const std::vector<ReportPlace>& places, ByteBlock& block);

}  // namespace hb::tools
