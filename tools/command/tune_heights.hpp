// Heights of rods' sections in the plane of motion, for stress (--height).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "hb/analysis/tune/tune_problem.hpp"

namespace hb::tools {

// "ROD=H" by rod, or "*", H with a unit or in the scene's. Throws UsageError.
[[nodiscard]] std::map<std::string, double> heights_flag(const std::vector<std::string>& texts, const Units& units);

// Heights are for rods without a section, where something asks for stress; throws UsageError for others.
void require_heights(const TuneTask& task, const Scene& scene);

}  // namespace hb::tools
