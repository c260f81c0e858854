#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace hb::tools {

// Keys stay in the order in which they were set.
using Json = nlohmann::ordered_json;

// An object with room for so many members: one that outgrows its room copies all that it holds.
[[nodiscard]] inline Json object_with_room(std::size_t members) {
  Json object = Json::object();
  object.get_ref<Json::object_t&>().reserve(members);
  return object;
}

// null where it is not finite.
[[nodiscard]] inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
[[nodiscard]] inline Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

}  // namespace hb::tools
