// Results as text for people, in the units of output_units.hpp.
#pragma once

#include <string>

#include "hb/analysis/linkage_analysis.hpp"

namespace hb::tools {

// `multipliers`: beside the exponents.
[[nodiscard]] std::string steady_table(const SceneModel& model, const SpeedResult& result, const Settings& settings,
                                       bool multipliers = false);
[[nodiscard]] std::string stages_table(const std::vector<Stage>& stages);
// What the tolerance means for each solver.
[[nodiscard]] std::string accuracy_table(const Settings& settings);

}  // namespace hb::tools
