#include "hb/analysis/map_loads.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "hb/analysis/map_lines.hpp"
#include "hb/analysis/sweep/sweep_parts.hpp"

namespace hb {
namespace {

PlaceLoads loads_of(const SweepScene& scene, double x) {
  SweepPoint point;
  try {
    point = analyse_point(scene, x, scene.settings().only);
  } catch (const SceneError&) {  // no possible scene
    return {};
  }
  PlaceLoads loads;
  if (!point.problem.empty()) return loads;
  const std::vector<RodModel>& rods = scene.first().rods;
  for (std::size_t r = 0; r < point.rods.size(); ++r)
    if (rods[r].reported) loads.push_back({point.rods[r].deflection, point.rods[r].theory_error, point.rods[r].stress});
  return loads;
}

template <class Visit>
void visit_line(Visit& visit, std::vector<PlaceLoads>& line) {
  visit_elements(visit, line, [&](PlaceLoads& place) {
    visit_elements(visit, place, [&](RodLoads& rod) {
      visit_if_there(visit, rod.deflection, visit);
      visit_if_there(visit, rod.theory_error, visit);
      visit_if_there(visit, rod.stress, [&](StressPoint& stress) { visit_stress(visit, stress); });
    });
  });
}

}  // namespace

void require_sections(const Scene& scene, const Settings& settings) {
  const auto* linkage = std::get_if<Linkage>(&scene.model);
  if (!linkage) throw RequestError("stress", "a [hill] scene, which has no links", "a mechanism");
  for (const int link : elastic_links(*linkage)) {
    const Body& body = *body_at(*linkage, link);
    const bool asked = settings.rods.empty() || std::ranges::find(settings.rods, body.name) != settings.rods.end();
    if (asked && !(body.elastic->section_height > 0))
      throw RequestError("stress", "no section of " + body.name,
                         fmt::format("{0}.section, as in section = {{ shape = \"rectangle\", width, height }} of its "
                                     "elastic table, or @rods without {0}",
                                     body.name));
  }
}

std::vector<PlaceLoads> map_loads(const SceneFamily& family, const PlaneAxis& x_axis, const std::vector<double>& x,
                                  const PlaneAxis& y_axis, const std::vector<double>& y, Settings settings,
                                  double speed, const PartsOf& parts) {
  settings.only = {.steady = false, .stability = false, .reactions = false, .shape = true};
  const MapLines lines(family, x_axis, x, y_axis, y, std::move(settings), speed);
  const auto line = [&](std::size_t k) {
    const std::vector<double>& values = lines.values();
    std::vector<PlaceLoads> found(values.size());
    try {
      const SweepScene scene = lines.scene(k);
      for (std::size_t i = 0; i < values.size(); ++i) found[i] = loads_of(scene, values[i]);
    } catch (const SceneError&) {  // none along this line
    }
    return found;
  };
  const auto found = computed_parts<std::vector<PlaceLoads>>(
      parts, lines.count(), line, [](auto& visit, std::vector<PlaceLoads>& places) { visit_line(visit, places); });
  std::vector<PlaceLoads> places(x.size() * y.size());
  for (std::size_t k = 0; k < found.size(); ++k)
    for (std::size_t i = 0; i < found[k].size(); ++i)
      places[lines.x_index(k, i) + x.size() * lines.y_index(k, i)] = found[k][i];
  return places;
}

}  // namespace hb
