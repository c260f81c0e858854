// How far the linear theory of a map can be trusted: the theory error at some places of its grid, corners included.
// A theory error takes a steady state and an evaluation of the exact model, about as much as one place of the grid.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/scene_plane.hpp"

namespace hb {

struct TheoryPlace {
  std::size_t x = 0, y = 0;  // indices of the grid
  // TheoryErrors::Rod::q by rod asked for; empty: beyond the linear theory.
  std::vector<std::optional<double>> rods;
  std::optional<double> growth;  // TheoryErrors::growth, of the mechanism
  std::string reason;  // why a rod has no value

  [[nodiscard]] bool beyond() const;  // of any rod
};

// Of a grid of that many values, evenly spread, both ends among them: 2 for few points of the grid, 5 for many, so that
// their work is a few per cent of the map's.
[[nodiscard]] std::vector<std::size_t> theory_indices(std::size_t values, std::size_t points_of_the_grid);

// At theory_indices of both axes; none for a [hill] scene, and none where the linkage does not turn through. `settings`
// with a number of modes; `speed` (rad per unit time) where no axis is the speed. Lines of equal scenes are the parts
// of the work.
[[nodiscard]] std::vector<TheoryPlace> map_theory(const SceneFamily& family, const PlaneAxis& x_axis,
                                                  const std::vector<double>& x, const PlaneAxis& y_axis,
                                                  const std::vector<double>& y, Settings settings, double speed,
                                                  const PartsOf& parts);

}  // namespace hb
