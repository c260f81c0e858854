// What a sweep found, in words that its table and its pictures share.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/sweep_analysis.hpp"

namespace hb::tools {

[[nodiscard]] bool is_speed(const SweepScene& scene);
// "rpm", "rad/s", "mm^4"; empty where the number has no unit or its name does not tell it.
[[nodiscard]] std::string axis_unit(const SweepScene& scene);

// The refined point at a peak or boundary; nullptr where that is a point asked for or lies outside.
[[nodiscard]] const SweepPoint* refined_point(const SweepResult& result, double x);

// To the nearest end of an unstable band of this rod; nothing where there is none.
[[nodiscard]] std::optional<double> distance_to_boundary(const SweepRod& rod, double x);

// The verdict of the mechanism along the axis: "stable at all 56 points", "UNSTABLE because of AB, at 1683.85 to
// 1895.07 rpm; stable elsewhere"; empty where stability was not asked for.
[[nodiscard]] std::string sweep_verdict(const SweepScene& scene, const SweepResult& result);
// The same, short, for titles of pictures.
[[nodiscard]] std::string sweep_title_verdict(const SweepResult& result);

// Of the scene, what the theory does not hold for, and where the search for bands was not settled.
[[nodiscard]] std::vector<std::string> sweep_warnings(const SweepScene& scene, const SweepResult& result);

}  // namespace hb::tools
