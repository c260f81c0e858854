// A stability map as it was asked for on the command line.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/map_task.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/scene_input.hpp"

namespace hb::tools {

// As written; an empty text is a flag that was not given.
struct MapFlags {
  std::string x, y, damping_range;
  std::string boundary_tolerance;  // --boundary-tol
  std::vector<std::string> bands;  // --band, of which damping alone goes over maps
  bool no_boundaries = false, stress = false;
};

// Throws UsageError, RequestError or SceneError.
[[nodiscard]] MapRequest asked_map(const CommonFlags& flags, const MapFlags& map, const SceneInput& input);

}  // namespace hb::tools
