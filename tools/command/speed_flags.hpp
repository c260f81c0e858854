// Speeds as written on the command line.
#pragma once

#include <vector>

#include "lib/scene/scene.hpp"
#include "tools/command/common_flags.hpp"

namespace hb::tools {

// Speeds of --rpm, --omega or the scene's [analysis], in rpm when given so. One scene serves all commands: a range in
// the scene gives its first speed where one is wanted.
struct SpeedRange {
  Speeds speeds;
  bool in_rpm = true;  // else rad per unit time
};
[[nodiscard]] SpeedRange speed_range(const CommonFlags& flags, const Scene& scene);
// A range; throws UsageError at a single speed, telling what to add.
[[nodiscard]] SpeedRange several_speeds(const CommonFlags& flags, const Scene& scene);
// Every speed of a range, in its own unit.
[[nodiscard]] std::vector<double> speed_values(const SpeedRange& range);
// One speed: of a range in the scene the first; throws UsageError where a flag gives a range.
[[nodiscard]] SpeedRange first_speed(const CommonFlags& flags, const Scene& scene);

}  // namespace hb::tools
