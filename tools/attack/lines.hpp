// Lines through random systems: one number varies, the speed or the strength of what is periodic.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hb/analysis/scene_family.hpp"

namespace hb::attack {

struct SystemOnLine {
  HillSystem system;
  double speed = 1;
};

// What a sweep is asked, and beside it the systems of its rods (of a [hill] scene: the one).
struct Line {
  std::string name;
  SceneFamily family;
  std::string path;  // "omega", or a number of the family
  double speed = 0;  // of a path that is not the speed
  int num_modes = 0;  // of linkages; 0: the system's own
  double from = 0, to = 1;
  std::vector<std::function<SystemOnLine(double x)>> rods;
};

inline constexpr int num_line_families = 16;
[[nodiscard]] const char* line_family(int family);

// The same line for the same family and number, on every machine.
[[nodiscard]] Line random_line(int family, std::uint64_t number);

}  // namespace hb::attack
