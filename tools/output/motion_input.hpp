// A motion that hb steady --theory nonlinear wrote, read back as the start of a branch.
#pragma once

#include <string>

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"

namespace hb::tools {

// `text` is a steady.json, `name` what it is called. Throws RequestError("start", ..) unless it holds a motion of all
// elastic links of the scene, and where the scene's axis is not the speed.
[[nodiscard]] BranchStart motion_from_json(const std::string& text, const std::string& name, const SweepScene& scene);

}  // namespace hb::tools
