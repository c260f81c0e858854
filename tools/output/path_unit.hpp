// The unit of a scene's number, by the last name of its path.
#pragma once

#include <string>

#include "lib/scene/scene.hpp"

namespace hb::tools {

// Empty where the number has none or its name does not tell it.
[[nodiscard]] inline std::string path_unit(const std::string& path, const Units& units) {
  if (path.starts_with("hill.")) return "";
  const std::string name = path.substr(path.rfind('.') + 1), &L = units.length, &M = units.mass, &T = units.time;
  for (const char* size :
       {"length", "width", "height", "diameter", "wall", "outer", "inner", "web", "flange", "bore"}) {
    if (name == size) return L;
  }
  if (name == "mass") return M;
  if (name == "area") return L + "^2";
  if (name == "J") return L + "^4";
  if (name == "E" || name == "G") return M + "/(" + L + " " + T + "^2)";
  if (name == "damping_x" || name == "damping_y") return M + "/(" + L + " " + T + ")";
  if (name == "direction") return units.angle;
  if (name == "density") return M + "/" + L + "^3";
  if (name == "damping_internal") return T;
  if (name == "inertia" || name == "inertia_pivot") return M + " " + L + "^2";
  if (name == "gravity") return L + "/" + T + "^2";
  return "";
}

}  // namespace hb::tools
