#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace hb::tools {

// Keys stay in the order in which they were set.
using Json = nlohmann::ordered_json;

// null where it is not finite.
[[nodiscard]] inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
[[nodiscard]] inline Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

}  // namespace hb::tools
