// How long one speed of a model takes, before it is begun.
#pragma once

#include "hb/analysis/linkage_analysis.hpp"

namespace hb {

// Seconds of one processor, about: near a dead centre, where it takes long, by fits to measured times. Below a second
// it says no more than that. With Hill's determinant an upper estimate.
[[nodiscard]] double expected_seconds(const SceneModel& model, const Settings& settings);

}  // namespace hb
