// What tells one map from another, for what is kept of it in a file.
#pragma once

#include <cstdint>

#include "hb/analysis/map_task.hpp"

namespace hb::tools {

// Of everything that the map depends on; numbers of the scene by what they lead to, at the corners and inside.
[[nodiscard]] std::uint64_t map_key(const MapTask& task);

}  // namespace hb::tools
