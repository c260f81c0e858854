#include "hb/analysis/steady.hpp"

namespace hb {

SteadyResult steady(const Scene& scene, const Request& request) {
  const Settings settings = settings_of(request, scene);
  const Speed speed = speed_of(request, scene);
  auto model = std::make_shared<const SceneModel>(make_model(scene, settings));
  return {analyse(*model, speed.omega, settings), speed, settings, std::move(model)};
}

}  // namespace hb
