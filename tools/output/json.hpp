#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace hb::tools {

// Keys stay in the order in which they were set.
using Json = nlohmann::ordered_json;

// null where it is not finite.
[[nodiscard]] inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace hb::tools
