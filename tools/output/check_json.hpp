// What hb check found, as one JSON document.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "hb/analysis/cross_check.hpp"

namespace hb::tools {

// One speed in all detail, or of several speeds the differences.
[[nodiscard]] nlohmann::ordered_json check_json(const SceneModel& model, const std::vector<SpeedCheck>& checks,
                                                const Settings& settings);

}  // namespace hb::tools
