// Two scenes without a fault, to be edited into wrong ones, and what a wrong one is told.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace hb {

inline const std::filesystem::path scene_folder = std::filesystem::path(HB_SOURCE_DIR) / "tests/scenes";

inline const std::string linkage_text = R"(title = "Six-link"
gravity = 9810
[units]
length = "mm"
angle = "rad"
[crank]
pivot = [0, 0]
length = 55
[[dyad]]
on = "crank"
coupler = { name = "AB", length = 259, mass = 0.165, elastic = { E = 21e7, area = 10, J = 45 } }
rocker = { name = "OB", pivot = [270, 0], length = 200, mass = 2, com = [118, 0], inertia = 1800, points = { C = [200, 0] } }
branch = -1
[[dyad]]
on = "OB.C"
coupler = { name = "CD", length = 400, mass = 0.2, points = { P = [20, 1] } }
slider = { name = "S", mass = 0.3, guide = [0, 50], direction = 0, force = { cos = [1, 2], sin = [0, 3] } }
branch = 1
[analysis]
modes = 5
rpm = [100, 200, 10]
tolerance = 1e-9
)";

inline const std::string hill_text = R"([hill]
mass = [[1, 0], [0, 1]]
damping = [[0, 0], [0, 0]]
stiffness = [{ harmonic = 0, cos = [[1, 0], [0, 4]] },
             { harmonic = 1, sin = [[0, 1], [1, 0]], omega_power = 1 }]
load = [{ harmonic = 1, cos = [1, 0] }]
[analysis]
omega = 1.5
)";

inline std::string message_of(const std::string& text, const std::vector<Override>& overrides = {}) {
  try {
    (void)parse_scene(text, "file.toml", overrides, scene_folder);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

}  // namespace hb
