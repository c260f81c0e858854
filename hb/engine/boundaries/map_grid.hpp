// Values of a stability map at the places that the caller gave.
#pragma once

#include <optional>
#include <vector>

#include "hb/engine/boundaries/map_mesh.hpp"
#include "hb/engine/boundaries/stability_map.hpp"

namespace hb {

// As evaluated there.
[[nodiscard]] MapPoint map_point(const StabilitySample& sample);

// Those of the nodes (`samples`, by node), and inside larger cells between the corners; x fastest.
[[nodiscard]] std::vector<MapPoint> map_grid(const MapMesh& mesh,
                                             const std::vector<std::optional<StabilitySample>>& samples);

}  // namespace hb
