// How many Ritz terms an elastic link gets: asked for, or chosen from the error of the cut at the places that are
// looked at (a speed; ends and middle of a sweep; corners and middle of a map; the ends and worst cases of a design's
// speeds).
#pragma once

#include <Eigen/Core>
#include <variant>
#include <vector>

#include "lib/scene/scene.hpp"

namespace hb {

struct RodResult;

using Modes = std::variant<int, AutoModes>;

[[nodiscard]] inline bool is_auto(const Modes& modes) { return std::holds_alternative<AutoModes>(modes); }

// The number asked for, or the one that a choice starts from.
[[nodiscard]] int start_modes(const Modes& modes);

// For the error of the cut I modes are compared with half as many again, at least three more.
[[nodiscard]] Eigen::Index comparison_modes(Eigen::Index num_modes);
// Where I are too few: as many as they are compared with, to max_modes.
[[nodiscard]] Eigen::Index more_modes(Eigen::Index num_modes);

// The largest number of these rods, for the deflection or for the exponents, `least` at least.
[[nodiscard]] int most_modes(const std::vector<RodResult>& rods, int least = 1);

}  // namespace hb
