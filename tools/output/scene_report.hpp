// What a scene means, as `hb scene` tells it: a table for people and a JSON document in the scene's units.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace hb::tools {

// Natural frequencies at rest without axial load, i = 1..count, rad per unit time: omega_i = (i pi/l)^2 sqrt(EJ/mu),
// and with shear those of Timoshenko's rod.
[[nodiscard]] std::vector<double> natural_frequencies(const Body& link, int count);

[[nodiscard]] std::string scene_table(const Scene& scene);
[[nodiscard]] nlohmann::ordered_json scene_json(const Scene& scene);

}  // namespace hb::tools
