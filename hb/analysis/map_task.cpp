#include "hb/analysis/map_task.hpp"

#include <fmt/core.h>

#include <cmath>

#include "hb/analysis/range_warnings.hpp"

namespace hb {
namespace {

PlaneAxis plane_axis(const Along& along) {
  const PlaneAxis::Role role = in_rpm(along.path)     ? PlaneAxis::Role::rpm
                               : is_speed(along.path) ? PlaneAxis::Role::omega
                                                      : PlaneAxis::Role::scene_number;
  return {role, along.path, along.values.front(), along.values.back()};
}

void require_axes(const SceneFamily& family, const MapRequest& request) {
  const Along &x = request.x, &y = request.y;
  if (x.values.empty()) throw RequestError("x", "no values", "at least two");
  if (y.values.empty()) throw RequestError("y", "no values", "at least two");
  if ((is_speed(x.path) && is_speed(y.path)) || same_number(family, x.path, y.path))
    throw RequestError("y", y.path, "two different parameters",
                       fmt::format("found {} beside @x {}, allowed: two different parameters", y.path, x.path));
  for (const Along* axis : {&x, &y}) {
    const char* field = axis == &x ? "x" : "y";
    if (is_speed(axis->path)) {
      require_no_speed(request, field, *axis);
    } else if (axis->path.starts_with("analysis.")) {
      throw RequestError(field, axis->path, "rpm, omega or a number of the model");
    }
  }
}

// All damping times a factor.
SceneFamily with_damping(const SceneFamily& family, const MapRequest& request, double factor) {
  Numbers numbers;
  for (const std::string& path : family.damping_paths()) {
    for (const Along* axis : {&request.x, &request.y})
      if (same_number(family, path, axis->path))
        throw RequestError("damping_range", "beside " + axis->path, "parameters other than the damping");
    numbers.push_back({path, factor * family.value(path)});
  }
  if (numbers.empty())
    throw RequestError("damping_range", "no damping in the scene", "a scene that gives damping",
                       "the scene gives no damping to multiply");
  return family.with(numbers);
}

}  // namespace

MapTask::MapTask(const SceneFamily& family, const MapRequest& request, const Work& geometry)
    : request_(request), family_(family) {
  require_axes(family, request);
  if (!request.only.stability) throw RequestError("only", "no stability", "stability");
  const Scene scene = some_scene(family, {&request.x, &request.y});
  require_values("x", request.x, scene.units);
  require_values("y", request.y, scene.units);
  settings_ = settings_of(request, scene);
  if (request.stress) require_sections(scene, settings_);
  if (const auto& range = request.damping_range) {
    const auto [low, high] = *range;
    if (!(low >= 0 && low < high && high < HUGE_VAL))
      throw RequestError("damping_range", fmt::format("\"{}:{}\"", low, high),
                         "LOW:HIGH with 0 <= LOW < HIGH, factors on the damping");
    if (!request.boundaries) throw RequestError("damping_range", "a map without boundaries", "a map with boundaries");
    factors_ = *range;
    for (const double factor : factors_) ends_.push_back(with_damping(family, request, factor));
  }
  if (const auto& band = request.band) {
    if (request.damping_range) throw RequestError("band", "beside damping_range", "one of the two");
    if (!request.boundaries) throw RequestError("band", "a map without boundaries", "a map with boundaries");
    factors_ = {band->from, band->to};
    for (const double factor : factors_)
      ends_.push_back(scaled_family(family, {&request.x, &request.y}, band->parameter, factor));
  }
  x_axis_ = plane_axis(request.x);
  y_axis_ = plane_axis(request.y);
  options_.rods = settings_.rods;
  options_.work = &geometry;
  if (!is_speed(request.x.path) && !is_speed(request.y.path)) options_.speed = speed_of(request, scene).omega;
  options_.num_modes = plane_modes(family, x_axis_, y_axis_, options_.speed, settings_);
  plane_.emplace(family, x_axis_, y_axis_, options_);
}

Map MapTask::compute(Work& work) const {
  const std::vector<double>&x = request_.x.values, &y = request_.y.values;
  MapOptions search = map_options(settings_);
  MapOptions curves = search;
  curves.curves_only = true;
  PartsAhead of_an_end, later;
  if (!ends_.empty()) of_an_end = parts_of_maps(*plane_, x, y, curves);
  constexpr double longer = 2;  // measured of half and twice the damping: 1.5 to 2 for each edge, and what follows
  for (auto& [kind, count] : of_an_end) count *= longer;
  for (std::size_t end = 0; end < ends_.size(); ++end) later.insert(later.end(), of_an_end.begin(), of_an_end.end());
  int steps = 0;  // how many there will be shows as the cells are halved
  search.parts = [&](const Parts& parts) {
    Parts all = parts;
    all.ahead.insert(all.ahead.end(), later.begin(), later.end());
    work.step(fmt::format("stability map, step {}", ++steps), all);
  };
  curves.parts = search.parts;
  search.for_each = [&](std::size_t count, const std::function<void(std::size_t)>& task) {
    work.for_each(count, task);
  };
  Map map{compute_map(*plane_, x_axis_, x, y_axis_, y, search),
          plane_->scene(),
          settings_,
          static_cast<int>(options_.num_modes),
          search.search.tolerance,
          {},
          range_warnings(family_, {&request_.x, &request_.y}),
          true};
  if (request_.band) map.band_of = request_.band->parameter;
  for (std::size_t end = 0; end < ends_.size(); ++end) {
    const ScenePlane plane(ends_[end], x_axis_, y_axis_, options_);
    const std::size_t num_rods = plane.rods().size();
    std::vector<StabilityMap> maps;
    for (std::size_t r = 0; r < num_rods; ++r) {
      later.erase(later.begin(), later.begin() + static_cast<std::ptrdiff_t>(of_an_end.size() / num_rods));
      maps.push_back(rod_map(plane, r, x, y, curves));
    }
    map.band.push_back({factors_[end], worst_boundaries(plane, maps, search)});
  }
  Settings settings = settings_;
  settings.modes = static_cast<int>(options_.num_modes);
  if (settings_.only.steady && std::holds_alternative<Linkage>(map.scene.model)) {
    map.theory_judged = true;
    map.theory = map_theory(family_, x_axis_, x, y_axis_, y, settings, options_.speed, work.of("theory error"));
  }
  if (request_.stress) {
    map.loads = map_loads(family_, x_axis_, x, y_axis_, y, settings, options_.speed, work.of("stress"));
  }
  std::size_t samples = 0;
  for (const StabilityMap& rod : map.maps) samples += rod.samples;
  map.evidence = fmt::format("{}; exponents at {} places", plane_->evidence(), samples);
  map.complete = !work.ends_early();
  return map;
}

}  // namespace hb
