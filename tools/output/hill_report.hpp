// What a [hill] scene means, as `hb scene` tells it: mean matrix, natural frequencies of the mean system, symmetry.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "lib/scene/scene.hpp"

namespace hb::tools {

[[nodiscard]] std::string hill_table(const HillSystem& system, const Scene& scene);
[[nodiscard]] nlohmann::ordered_json hill_json(const HillSystem& system, const Scene& scene);

}  // namespace hb::tools
