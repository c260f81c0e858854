// A stability map for the page.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "lib/scene/scene.hpp"
#include "tools/report/byte_block.hpp"

namespace hb::tools {

// `map` as map_json has it: grids as columns of floats and letters, curves as columns; with the scene's own values of
// the two numbers, where its file gives them.
[[nodiscard]] nlohmann::ordered_json map_data(nlohmann::ordered_json map, const SceneSource& source, const Units& units,
                                              ByteBlock& block);

}  // namespace hb::tools
