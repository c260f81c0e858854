// How `hb tune` searches: --algorithm, --analyses, --seed.
#pragma once

#include "hb/analysis/tune/tune_problem.hpp"
#include "tools/command/tune_flags.hpp"

namespace hb::tools {

// Both throw UsageError.
[[nodiscard]] DesignOptions design_options(const TuneFlags& flags);
// Conditions and variables that the algorithm can take.
void require_algorithm(const TuneTask& task);

}  // namespace hb::tools
