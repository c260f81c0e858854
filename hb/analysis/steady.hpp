// A scene at one speed, with everything that the answer was computed from.
#pragma once

#include <functional>
#include <memory>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/request.hpp"

namespace hb {

struct SteadyResult : SpeedResult {
  Speed given;  // the speed as it was asked for
  Settings settings;
  std::shared_ptr<const SceneModel> model;  // the scene, its units, the rods' systems
};

// Periodic steady state, stability, shape and joint forces, as far as asked for. Throws RequestError, and
// UnresolvedLinkage where the linkage comes too near a dead centre. `expected` is called once the model is there, with
// the seconds and the bytes that the rest will take, about.
[[nodiscard]] SteadyResult steady(const Scene& scene, const Request& request = {},
                                  const std::function<void(double seconds, double bytes)>& expected = {});

}  // namespace hb
