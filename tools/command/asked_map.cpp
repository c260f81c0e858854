#include "tools/command/asked_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/analyses.hpp"
#include "tools/command/command.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/work/checkpoint.hpp"

namespace hb::tools {
namespace {

constexpr std::size_t max_points = 4000000;

AxisRange axis_range(const std::string& flag, const std::string& text) {
  if (text.empty())
    throw UsageError(fmt::format("{}: not given, allowed: PATH=FROM:TO:N, as in rpm=200:6000:100 (100 points)", flag));
  const NamedRange named = named_range(flag, text);
  AxisRange range;
  range.axis.path = named.path;
  range.values = range_by_count(flag, named.range);
  range.axis.from = range.values.front();
  range.axis.to = range.values.back();
  for (std::size_t k = 0; k + 1 < range.values.size(); ++k) {
    if (!(range.values[k] < range.values[k + 1])) {
      throw UsageError(
          fmt::format("{}: found \"{}\", whose points are too close to be told apart; allowed: a wider range "
                      "or fewer points",
                      flag, text));
    }
  }
  if (named.path == "rpm" || named.path == "analysis.rpm") {
    range.axis.role = PlaneAxis::Role::rpm;
  } else if (named.path == "omega" || named.path == "analysis.omega") {
    range.axis.role = PlaneAxis::Role::omega;
  } else if (named.path.starts_with("analysis.")) {
    throw UsageError(fmt::format("{}: found {}, allowed: rpm, omega or a number of the model", flag, named.path));
  }
  if (range.axis.role != PlaneAxis::Role::scene_number && !(range.axis.from > 0)) {
    throw UsageError(fmt::format("{}: found \"{}\", allowed: positive speeds", flag, text));
  }
  return range;
}

bool is_speed(const AxisRange& range) { return range.axis.role != PlaneAxis::Role::scene_number; }

void require_different(const CommonFlags& flags, const SceneSource& source, const AxisRange& x, const AxisRange& y) {
  if ((is_speed(x) && is_speed(y)) || same_number(source, x.axis.path, y.axis.path)) {
    throw UsageError(
        fmt::format("--y: found {} beside --x {}, allowed: two different parameters", y.axis.path, x.axis.path));
  }
  for (const AxisRange* range : {&x, &y}) {
    const char* flag = range == &x ? "--x" : "--y";
    for (const Override& set : overrides(flags)) {
      if (same_number(source, set.path, range->axis.path)) {
        throw UsageError(
            fmt::format("--set: found {} beside {} {}, allowed: one of the two", set.path, flag, range->axis.path));
      }
    }
    if (is_speed(*range) && (!flags.rpm.empty() || !flags.omega.empty())) {
      throw UsageError(fmt::format("--{}: found {} beside {} {}, allowed: one of the two",
                                   flags.rpm.empty() ? "omega" : "rpm", flags.rpm.empty() ? flags.omega : flags.rpm,
                                   flag, range->axis.path));
    }
  }
}

// Some scene of the map, for what does not depend on the place: the one as written, or one of a corner.
Scene readable_scene(const SceneSource& source, const std::vector<Override>& set, const AxisRange& x,
                     const AxisRange& y) {
  std::optional<ObstructedLinkage> obstructed;
  for (int corner = 0; corner <= 4; ++corner) {
    std::vector<Override> all = set;
    if (corner > 0 && !is_speed(x)) all.push_back(number_override(x.axis.path, corner % 2 ? x.axis.from : x.axis.to));
    if (corner > 0 && !is_speed(y)) all.push_back(number_override(y.axis.path, corner <= 2 ? y.axis.from : y.axis.to));
    try {
      return source.with(all);
    } catch (const ObstructedLinkage& error) {
      obstructed = error;
    }
  }
  throw ObstructedLinkage(*obstructed);
}

std::optional<DampingFactors> damping_factors(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::string allowed = "LOW:HIGH with 0 <= LOW < HIGH, factors on the damping";
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw UsageError(fmt::format("--damping-range: found \"{}\", allowed: {}", text, allowed));
  }
  const double most = std::numeric_limits<double>::max();
  const DampingFactors factors{number_flag("--damping-range", text.substr(0, colon), 0, most, allowed),
                               number_flag("--damping-range", text.substr(colon + 1), 0, most, allowed)};
  if (!(factors.low < factors.high)) {
    throw UsageError(fmt::format("--damping-range: found \"{}\", allowed: {}", text, allowed));
  }
  return factors;
}

// Internal damping of the elastic links, or the whole damping matrix of a [hill] scene, times a factor.
std::vector<Override> damping_overrides(const SceneSource& source, const Scene& scene, const AxisRange& x,
                                        const AxisRange& y, double factor) {
  std::vector<Override> result;
  std::vector<std::string> paths = source.damping_paths();
  if (std::holds_alternative<HillSystem>(scene.model)) {
    paths = source.numeric_paths();
    std::erase_if(paths, [](const std::string& path) { return !path.starts_with("hill.damping."); });
  }
  for (const std::string& path : paths) {
    for (const AxisRange* range : {&x, &y}) {
      if (same_number(source, path, range->axis.path)) {
        throw UsageError(fmt::format("--damping-range: found beside {}, allowed: parameters other than the damping",
                                     range->axis.path));
      }
    }
    result.push_back(number_override(path, factor * source.value(path)));
  }
  if (result.empty()) throw UsageError("--damping-range: the scene gives no damping to multiply");
  return result;
}

// Of everything that the map depends on; numbers of the scene by what they lead to, at the corners and inside.
std::uint64_t map_key(const ScenePlane& plane, const AxisRange& x, const AxisRange& y, const Settings& settings,
                      const std::optional<DampingFactors>& factors) {
  TaskKey key;
  key.add("map");
  for (const AxisRange* range : {&x, &y}) {
    key.add(range->axis.path);
    for (const double value : range->values) key.add(value);
  }
  key.add(settings.tolerance)
      .add(settings.boundary_tolerance)
      .add(settings.boundaries)
      .add(settings.only.growth)
      .add(settings.only.verdict)
      .add(static_cast<double>(settings.stability_method));
  key.add(factors ? factors->low : -1).add(factors ? factors->high : -1);
  for (const double s : {0.0, 0.37, 1.0}) {
    for (const double t : {0.0, 0.61, 1.0}) {
      for (std::size_t r = 0; r < plane.rods().size(); ++r) {
        key.add(plane.rods()[r]);
        const std::optional<ScaledSystem> system =
            plane.system(r, x.axis.from + s * (x.axis.to - x.axis.from), y.axis.from + t * (y.axis.to - y.axis.from));
        key.add(system ? static_cast<double>(system->num_modes()) : -1);
        if (!system) continue;
        key.add(system->speed);
        for (const double value : system->G.reshaped()) key.add(value);
        for (const std::complex<double> value : system->K.c.reshaped()) key.add(value.real()).add(value.imag());
      }
    }
  }
  return key.value();
}

}  // namespace

AskedMap::AskedMap(const CommonFlags& flags, const std::string& x, const std::string& y,
                   const std::string& damping_range, const BoundaryFlags& boundaries, const SceneInput& input,
                   const Work& work)
    : input_(input),
      x_(axis_range("--x", x)),
      y_(axis_range("--y", y)),
      factors_(damping_factors(damping_range)),
      set_(overrides(flags)) {
  if (static_cast<double>(x_.values.size()) * static_cast<double>(y_.values.size()) > max_points) {
    throw UsageError(fmt::format("--x, --y: found {} x {} points, allowed: at most {} in all", x_.values.size(),
                                 y_.values.size(), max_points));
  }
  require_different(flags, input.source, x_, y_);
  scene_ = readable_scene(input.source, set_, x_, y_);
  settings_ = settings(flags, scene_);
  if (!settings_.only.stability) throw UsageError(fmt::format("--only: found \"{}\", allowed: stability", flags.only));
  if (!is_speed(x_) && !is_speed(y_)) plane_options_.speed = single_speed(flags, scene_);
  plane_options_.num_modes =
      plane_modes(SceneFamily(input.source, set_), x_.axis, y_.axis, plane_options_.speed, settings_);
  plane_options_.rods = settings_.rods;
  plane_options_.work = &work;
  settings_.boundaries = !boundaries.none;
  settings_.boundary_tolerance = default_boundary_tolerance(settings_.tolerance);
  if (!boundaries.tolerance.empty())
    settings_.boundary_tolerance =
        number_flag("--boundary-tol", boundaries.tolerance, 1e-14, 0.01, "a number from 1e-14 to 0.01");
  if (boundaries.none && (factors_ || !boundaries.tolerance.empty()))
    throw UsageError(fmt::format("--no-boundaries: found beside {}, allowed: one of the two",
                                 factors_ ? "--damping-range" : "--boundary-tol"));
  search_ = map_options(settings_);
  plane_.emplace(plane_with({}));
}

ScenePlane AskedMap::plane_with(const std::vector<Override>& further) const {
  std::vector<Override> all = set_;
  all.insert(all.end(), further.begin(), further.end());
  return ScenePlane(input_.source, all, x_.axis, y_.axis, plane_options_);
}

std::uint64_t AskedMap::key() const { return map_key(*plane_, x_, y_, settings_, factors_); }

void AskedMap::compute(Work& work) {
  compute_all(work);
  complete_ = !work.ends_early();
}

void AskedMap::compute_all(Work& work) {
  search_.parts = work.of("stability map, this step");
  result_ = compute_map(*plane_, x_.axis, x_.values, y_.axis, y_.values, search_);
  if (!factors_) return;
  const SceneSource as_set(input_.source.text_with(set_), input_.name, input_.folder);
  for (const double factor : {factors_->low, factors_->high}) {
    const ScenePlane damped = plane_with(damping_overrides(as_set, scene_, x_, y_, factor));
    MapOptions curves = search_;
    curves.curves_only = true;
    std::vector<StabilityMap> maps;
    for (std::size_t r = 0; r < damped.rods().size(); ++r)
      maps.push_back(rod_map(damped, r, x_.values, y_.values, curves));
    result_.damping.push_back({factor, worst_boundaries(damped, maps, search_)});
  }
}

MapDocument AskedMap::document() const {
  return {result_, plane_->scene(), plane_options_.num_modes, search_.search.tolerance, search_.boundaries, complete_};
}

std::string AskedMap::evidence() const { return plane_->evidence(); }

}  // namespace hb::tools
