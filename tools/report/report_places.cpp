#include "tools/report/report_places.hpp"

#include <algorithm>

namespace hb::tools {

std::vector<std::size_t> kept_points(std::size_t count) {
  const std::size_t every = std::max<std::size_t>(1, (count + most_places - 1) / most_places);
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < count; k += every) kept.push_back(k);
  if (count > 0 && kept.back() != count - 1) kept.push_back(count - 1);
  return kept;
}

std::vector<ReportPlace> places_along(const SweepScene& scene, const Work& work) {
  const std::vector<double>& values = scene.axis().values;
  const std::vector<std::size_t> kept = kept_points(values.size());
  std::vector<ReportPlace> places(kept.size());
  work.for_each(kept.size(), [&](std::size_t k) {
    const ScenePlace at = scene.at(values[kept[k]]);
    places[k].model = at.model;
    places[k].problem = at.problem;
    if (at.model) places[k].result = analyse(*at.model, at.speed, scene.settings());
  });
  return places;
}

}  // namespace hb::tools
