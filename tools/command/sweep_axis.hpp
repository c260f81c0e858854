// What a sweep goes along, as written on the command line.
#pragma once

#include <string>

#include "hb/analysis/analyses.hpp"
#include "tools/command/common_flags.hpp"

namespace hb::tools {

// All but --no-search: --rpm or --omega as a range, or a number of the source given as `x` ("AB.J=30:60:1") at the one
// speed. `scene`: the source with --set. Throws UsageError, SceneError.
[[nodiscard]] SweepRequest asked_sweep(const CommonFlags& flags, const std::string& x, const SceneSource& source,
                                       const Scene& scene);

}  // namespace hb::tools
