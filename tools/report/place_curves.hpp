// What is drawn of one point of a report: Fourier series over its period, and ranges along the links.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tools/report/byte_block.hpp"
#include "tools/report/report_places.hpp"

namespace hb::tools {

// Of the motion without linearisation where the point has it, else of the linear answer.
[[nodiscard]] nlohmann::ordered_json place_curves(const ReportPlace& place, ByteBlock& block);

}  // namespace hb::tools
