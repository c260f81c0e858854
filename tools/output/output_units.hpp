// Units of tables, CSV and pictures: lengths and times as in the scene, forces in N, moments in N m, angles in degrees.
// (JSON keeps the scene's units throughout.)
#pragma once

#include <numbers>
#include <string>

#include "lib/scene/scene.hpp"

namespace hb::tools {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

struct OutputUnits {
  std::string length, time, rate;  // "mm", "s", "1/s"
  std::string response;  // of q: the length, or empty for a [hill] scene
  double force = 1;  // scene's force unit in N
  double moment = 1;  // scene's moment unit in N m
  double megapascal = 1;  // scene's unit of stress in MPa
};

[[nodiscard]] inline OutputUnits output_units(const Scene& scene) {
  const Units& units = scene.units;
  const bool linkage = std::holds_alternative<Linkage>(scene.model);
  return {units.length,
          units.time,
          "1/" + units.time,
          linkage ? units.length : "",
          units.force_in_newton(),
          units.torque_in_newton_metre(),
          1e-6 * units.force_in_newton() / (units.length_in_m * units.length_in_m)};
}

// " [mm]", or nothing for a quantity without unit.
[[nodiscard]] inline std::string bracketed(const std::string& unit) { return unit.empty() ? "" : " [" + unit + "]"; }

// A crank angle in the scene's own unit of angle.
[[nodiscard]] inline double scene_angle(double radian, const Units& units) {
  return units.angle == "deg" ? radian * degrees_per_radian : radian;
}

}  // namespace hb::tools
