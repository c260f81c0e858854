// Points of a sweep as lists of numbers, for checkpoint.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tools/sweep_analysis.hpp"

namespace hb::tools {

[[nodiscard]] std::vector<double> packed(const SweepPoint& point);
// Empty if the numbers are not those of a point.
[[nodiscard]] std::optional<SweepPoint> unpacked(const std::vector<double>& numbers);

// Of everything that the points depend on: the scene's numbers, the axis, the flags.
[[nodiscard]] std::uint64_t sweep_key(const SweepScene& scene);

}  // namespace hb::tools
