#include "tools/report/report_places.hpp"

#include <algorithm>

namespace hb::tools {

ReportPlace nonlinear_place(const std::shared_ptr<const SceneModel>& model, const NonlinearResult& motion,
                            const Settings& settings) {
  ReportPlace place{model, analyse(*model, motion.speed, settings), "", {}};
  if (motion.search == MotionSearch::found)
    place.motion = motion;
  else
    place.problem = "No motion without linearisation was found at this speed" +
                    (motion.shortfalls.empty() ? std::string() : ": " + motion.shortfalls.front()) +
                    ". What is shown is by the linear theory.";
  return place;
}

std::vector<std::size_t> kept_points(std::size_t count) {
  const std::size_t every = std::max<std::size_t>(1, (count + most_places - 1) / most_places);
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < count; k += every) kept.push_back(k);
  if (count > 0 && kept.back() != count - 1) kept.push_back(count - 1);
  return kept;
}

std::vector<ReportPlace> places_along(const SweepScene& scene, const Work& work, const NonlinearSweep* branches) {
  const std::vector<double>& values = scene.axis().values;
  const std::vector<std::size_t> kept = kept_points(values.size());
  std::vector<ReportPlace> places(kept.size());
  work.for_each(kept.size(), [&](std::size_t k) {
    if (work.ends_early()) {
      places[k] = {nullptr, {}, "not computed before the end", {}};
      return;
    }
    const ScenePlace at = scene.at(values[kept[k]]);
    places[k].model = at.model;
    places[k].problem = at.problem;
    if (!at.model) return;
    places[k].result = analyse(*at.model, at.speed, scene.settings());
    if (branches == nullptr) return;
    if (const std::optional<BranchPlace>& passage = branches->followed[kept[k]]) {
      const NonlinearPoint& point = branches->branches[passage->branch].points[passage->point];
      places[k].motion =
          nonlinear_answer(*at.model, *point.motion, point.stability, branches->tolerance, scene.settings());
    } else {
      places[k].problem =
          "The branch of motions followed from the first value does not come here. What is shown is by the linear "
          "theory.";
    }
  });
  return places;
}

}  // namespace hb::tools
