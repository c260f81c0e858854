// What a sweep goes along, as written on the command line.
#pragma once

#include <string>

#include "hb/analysis/sweep_analysis.hpp"
#include "tools/command/common_flags.hpp"

namespace hb::tools {

struct AxisAndSpeed {
  Axis axis;
  double speed = 0, rpm = 0;  // where that is not the axis
};

// --rpm or --omega as a range, or a scene number given as `x` ("AB.J=30:60:1") at the one speed; throws UsageError.
[[nodiscard]] AxisAndSpeed axis_of(const CommonFlags& flags, const std::string& x, const Scene& scene);

}  // namespace hb::tools
