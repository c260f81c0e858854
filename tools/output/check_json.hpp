// What hb check found, as one JSON document.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "hb/analysis/analyses.hpp"

namespace hb::tools {

// One speed in all detail, or of several that were asked for the differences.
[[nodiscard]] nlohmann::ordered_json check_json(const Check& check);

// What missed its tolerance or could not be compared at one speed.
struct ShortfallsAt {
  double speed = 0;  // rad per unit time
  std::vector<std::string> sentences;
};
// `status` and, where there are some, `notes`, with the speed where there are several.
void add_shortfalls(nlohmann::ordered_json& json, const Scene& scene, const std::vector<ShortfallsAt>& all);

}  // namespace hb::tools
