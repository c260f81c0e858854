// How a mechanism moves, for a page that draws it.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "hb/analysis/nonlinear/nonlinear_steady.hpp"
#include "lib/linkage/linkage.hpp"
#include "tools/report/byte_block.hpp"

namespace hb::tools {

// Bodies with the motion of their frames over the crank angle (series of x, y of joint 0, then of the unit vector
// toward joint 1) and their points in these frames; guides of sliders.
[[nodiscard]] nlohmann::ordered_json motion_json(const Linkage& linkage, ByteBlock& block);
// The same series, one entry for each body in that order, of the mechanism with its bent links: the unit vector of one
// points along its chord. Harmonic n is n/T of the crank's. Null where the motion is none.
[[nodiscard]] nlohmann::ordered_json bent_frames_json(const SceneModel& model, const NonlinearResult& motion,
                                                      ByteBlock& block);

}  // namespace hb::tools
