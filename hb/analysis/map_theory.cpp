#include "hb/analysis/map_theory.hpp"

#include <algorithm>
#include <cmath>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/map_lines.hpp"
#include "hb/analysis/rod_steady.hpp"
#include "hb/analysis/theory_growth.hpp"

namespace hb {
namespace {

// Empty where there is nothing to judge.
std::optional<TheoryPlace> judged(const SweepScene& scene, double value) {
  ScenePlace place;
  try {
    place = scene.at(value);
  } catch (const SceneError&) {  // no possible scene
    return std::nullopt;
  }
  if (!place.model || !place.model->exact) return std::nullopt;
  const std::vector<RodModel>& rods = place.model->rods;
  std::vector<FourierSeries> solved(rods.size());
  std::vector<LinearRod> linear;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    SteadyState state = solve_rod(rods[r].system, rods[r].num_modes, place.speed, response_options(scene.settings()));
    if (state.status != SteadyStatus::singular) solved[r] = std::move(state.q);
    linear.push_back({&rods[r].system, &solved[r]});
  }
  const TheoryErrors errors = theory_errors(*place.model->exact, place.speed, linear);
  TheoryPlace result;
  for (std::size_t r = 0; r < rods.size(); ++r)
    if (rods[r].reported) result.rods.push_back(errors.rods[r].q);
  result.growth = growth_theory_error(*place.model->linkage(), place.speed, linear, errors);
  result.reason = errors.reason;
  return result;
}

template <class Visit>
void visit_places(Visit& visit, std::vector<TheoryPlace>& line) {
  visit_elements(visit, line, [&](TheoryPlace& place) {
    visit_as_number(visit, place.x);
    visit_as_number(visit, place.y);
    visit_elements(visit, place.rods, [&](std::optional<double>& error) { visit_if_there(visit, error, visit); });
    visit_if_there(visit, place.growth, visit);
    visit_elements(visit, place.reason, [&](char& c) { visit_as_number(visit, c); });
  });
}

std::vector<double> at(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  std::vector<double> some;
  for (const std::size_t k : indices) some.push_back(values[k]);
  return some;
}

}  // namespace

bool TheoryPlace::beyond() const { return std::ranges::any_of(rods, beyond_theory); }

std::vector<std::size_t> theory_indices(std::size_t values, std::size_t points_of_the_grid) {
  constexpr double points_for_each = 80;
  const auto wanted = static_cast<std::size_t>(
      std::clamp(std::round(std::sqrt(static_cast<double>(points_of_the_grid) / points_for_each)), 2.0, 5.0));
  const std::size_t count = std::min(wanted, values);
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < count; ++k) indices.push_back(count == 1 ? 0 : (k * (values - 1)) / (count - 1));
  return indices;
}

std::vector<TheoryPlace> map_theory(const SceneFamily& family, const PlaneAxis& x_axis, const std::vector<double>& x,
                                    const PlaneAxis& y_axis, const std::vector<double>& y, Settings settings,
                                    double speed, const PartsOf& parts) {
  settings.only = {.steady = true, .stability = false, .reactions = false, .shape = false};
  const std::vector<std::size_t> columns = theory_indices(x.size(), x.size() * y.size()),
                                 rows = theory_indices(y.size(), x.size() * y.size());
  const std::vector<double> some_x = at(x, columns), some_y = at(y, rows);
  const MapLines lines(family, x_axis, some_x, y_axis, some_y, std::move(settings), speed);
  const auto line = [&](std::size_t k) {
    std::vector<TheoryPlace> found;
    try {
      const SweepScene scene = lines.scene(k);
      for (std::size_t i = 0; i < lines.values().size(); ++i) {
        std::optional<TheoryPlace> place = judged(scene, lines.values()[i]);
        if (!place) continue;
        place->x = columns[lines.x_index(k, i)];
        place->y = rows[lines.y_index(k, i)];
        found.push_back(std::move(*place));
      }
    } catch (const SceneError&) {  // none along this line
    }
    return found;
  };
  const auto found = computed_parts<std::vector<TheoryPlace>>(
      parts, lines.count(), line, [](auto& visit, std::vector<TheoryPlace>& places) { visit_places(visit, places); });
  std::vector<TheoryPlace> all;
  for (const std::vector<TheoryPlace>& places : found) all.insert(all.end(), places.begin(), places.end());
  return all;
}

}  // namespace hb
