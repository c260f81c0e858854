// What hb check found, in words and tables.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/cross_check.hpp"

namespace hb::tools {

// One speed in detail or a table of speeds, then what disagrees, what was not reached, and the verdict.
[[nodiscard]] std::string check_report(const SceneModel& model, const std::vector<SpeedCheck>& checks,
                                       const Settings& settings, bool stats);

}  // namespace hb::tools
