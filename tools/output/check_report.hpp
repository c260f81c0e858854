// What hb check found, in words and tables.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/analyses.hpp"

namespace hb::tools {

// Of the mechanism, by harmonic balance, over all elastic links: "stable (AB, CD)", "UNSTABLE because of AB at 2 of 5
// speeds"; empty where stability was not asked for.
[[nodiscard]] std::string check_verdict(const std::vector<SpeedCheck>& checks);

// Of the scene, then of the linear theory, over several speeds in the words of a sweep.
[[nodiscard]] std::vector<std::string> check_warnings(const SceneModel& model, const std::vector<SpeedCheck>& checks);

// The verdict and whether the paths agree; one speed in detail or a table of speeds, then what disagrees, what was not
// reached.
[[nodiscard]] std::string check_report(const Check& check, bool stats);

}  // namespace hb::tools
