#include "hb/analysis/steady.hpp"

#include "hb/analysis/expected_memory.hpp"
#include "hb/analysis/expected_time.hpp"

namespace hb {

SteadyResult steady(const Scene& scene, const Request& request, const std::function<void(double, double)>& expected) {
  const Settings settings = settings_of(request, scene);
  const Speed speed = speed_of(request, scene);
  auto model = std::make_shared<const SceneModel>(make_model(scene, settings));
  if (expected) expected(expected_seconds(*model, settings), expected_bytes(*model, settings));
  return {analyse(*model, speed.omega, settings), speed, settings, std::move(model)};
}

}  // namespace hb
