// Stress, safety and deflection of every elastic link over two numbers of a scene, at each point of a grid.
#pragma once

#include <optional>
#include <vector>

#include "hb/analysis/scene_family.hpp"
#include "hb/analysis/scene_plane.hpp"
#include "hb/analysis/sweep/sweep_point.hpp"

namespace hb {

struct RodLoads {
  std::optional<double> deflection, theory_error;  // RodPoint; empty: no periodic solution, beyond the linear theory
  std::optional<StressPoint> stress;
};
// By rod asked for; empty where there is no linkage.
using PlaceLoads = std::vector<RodLoads>;

// Throws RequestError for a scene without links, or for a rod asked for that has no section, with the key to add.
void require_sections(const Scene& scene, const Settings& settings);

// Rows along x, one for each y. `settings` with a number of modes; `speed` (rad per unit time) where no axis is the
// speed. Lines of equal scenes are the parts of the work.
[[nodiscard]] std::vector<PlaceLoads> map_loads(const SceneFamily& family, const PlaneAxis& x_axis,
                                                const std::vector<double>& x, const PlaneAxis& y_axis,
                                                const std::vector<double>& y, Settings settings, double speed,
                                                const PartsOf& parts);

}  // namespace hb
