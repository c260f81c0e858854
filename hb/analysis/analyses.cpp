#include "hb/analysis/analyses.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hb/analysis/accuracy.hpp"

namespace hb {
namespace {

bool in_rpm(const std::string& path) { return path == "rpm" || path == "analysis.rpm"; }

bool is_speed(const Along& along) { return hb::is_speed(along.path); }

// Numbers that a map or a sweep can go along: of the model, or the speed.
void require_axis(const char* field, const Along& along) {
  if (!is_speed(along) && along.path.starts_with("analysis."))
    throw RequestError(field, along.path, "rpm, omega or a number of the model");
}

void require_values(const char* field, const Along& along, const Units& units) {
  const std::vector<double>& values = along.values;
  if (values.size() < 2) throw RequestError(field, fmt::format("{} values", values.size()), "at least two");
  for (std::size_t k = 0; k + 1 < values.size(); ++k)
    if (!(values[k] < values[k + 1]))
      throw RequestError(field, fmt::format("{} before {}", values[k], values[k + 1]), "values in ascending order");
  if (!is_speed(along)) return;
  const double lowest = in_rpm(along.path) ? speed_from_rpm(values.front(), units) : values.front();
  if (!(lowest >= std::numeric_limits<double>::min()))
    throw RequestError(field, fmt::format("a range from {}", values.front()), "positive speeds");
}

// Some scene of the family with these numbers at one of their values, for what does not depend on them.
Scene some_scene(const SceneFamily& family, const std::vector<const Along*>& axes) {
  std::size_t longest = 1;
  for (const Along* axis : axes)
    if (!is_speed(*axis)) longest = std::max(longest, axis->values.size());
  std::optional<ObstructedLinkage> obstructed;
  for (std::size_t k = 0; k < longest; ++k) {
    Numbers numbers;
    for (const Along* axis : axes)
      if (!is_speed(*axis)) numbers.push_back({axis->path, axis->values[std::min(k, axis->values.size() - 1)]});
    try {
      return family.scene(numbers);
    } catch (const ObstructedLinkage& error) {
      if (!obstructed) obstructed = error;
    }
  }
  throw ObstructedLinkage(*obstructed);
}

void require_no_speed(const Request& request, const char* field, const Along& axis) {
  if (!request.rpm && !request.omega) return;
  const double value = request.rpm ? *request.rpm : *request.omega;
  throw RequestError(request.rpm ? "rpm" : "omega", fmt::format("{}", value), "one of the two",
                     fmt::format("found {} beside @{} {}, allowed: one of the two", value, field, axis.path));
}

}  // namespace

bool is_speed(const std::string& path) { return in_rpm(path) || path == "omega" || path == "analysis.omega"; }

bool same_number(const SceneFamily& family, const std::string& a, const std::string& b) {
  if (a == b) return true;
  const std::string& all = a.starts_with("*.") ? a : b;
  const std::string& one = a.starts_with("*.") ? b : a;
  const std::size_t dot = one.rfind('.');
  if (!all.starts_with("*.") || dot == std::string::npos || one.substr(dot + 1) != all.substr(2)) return false;
  const std::vector<std::string> paths = family.paths();
  return std::ranges::find(paths, one.substr(0, dot) + ".E") != paths.end();
}

Along along(std::string path, double from, double to, std::size_t count) {
  Along result{std::move(path), std::vector<double>(std::max<std::size_t>(2, count))};
  const auto steps = static_cast<double>(result.values.size() - 1);
  for (std::size_t k = 0; k < result.values.size(); ++k)
    result.values[k] = from + static_cast<double>(k) / steps * (to - from);
  result.values.back() = to;
  return result;
}

Sweep sweep(const SceneFamily& family, const SweepRequest& request, Work& work) {
  if (request.x.values.empty()) throw RequestError("x", "no values", "at least two");
  const Scene scene = some_scene(family, {&request.x});
  require_values("x", request.x, scene.units);
  Speed fixed;
  if (is_speed(request.x)) {
    require_no_speed(request, "x", request.x);
  } else {
    fixed = speed_of(request, scene);
  }
  Axis axis;
  axis.kind = in_rpm(request.x.path) ? Axis::Kind::rpm
              : is_speed(request.x)  ? Axis::Kind::omega
                                     : Axis::Kind::parameter;
  axis.path = request.x.path;
  axis.values = request.x.values;
  const auto along =
      std::make_shared<const SweepScene>(family, settings_of(request, scene), std::move(axis), fixed.omega, fixed.rpm);
  return {run_sweep(*along, work), along};
}

Sweep sweep(const SceneFamily& family, const SweepRequest& request) {
  Work work;
  return sweep(family, request, work);
}

Map map(const SceneFamily& family, const MapRequest& request, Work& work) {
  if (request.x.values.empty()) throw RequestError("x", "no values", "at least two");
  if (request.y.values.empty()) throw RequestError("y", "no values", "at least two");
  if ((is_speed(request.x) && is_speed(request.y)) || same_number(family, request.x.path, request.y.path))
    throw RequestError(
        "y", request.y.path, "two different parameters",
        fmt::format("found {} beside @x {}, allowed: two different parameters", request.y.path, request.x.path));
  require_axis("x", request.x);
  require_axis("y", request.y);
  if (is_speed(request.x)) require_no_speed(request, "x", request.x);
  if (is_speed(request.y)) require_no_speed(request, "y", request.y);
  if (!request.only.stability) throw RequestError("only", "no stability", "stability");
  const Scene scene = some_scene(family, {&request.x, &request.y});
  require_values("x", request.x, scene.units);
  require_values("y", request.y, scene.units);
  const Settings settings = settings_of(request, scene);
  PlaneOptions options;
  options.rods = settings.rods;
  options.work = &work;
  if (!is_speed(request.x) && !is_speed(request.y)) options.speed = speed_of(request, scene).omega;
  const auto axis = [](const Along& along) {
    const PlaneAxis::Role role = in_rpm(along.path) ? PlaneAxis::Role::rpm
                                 : is_speed(along)  ? PlaneAxis::Role::omega
                                                    : PlaneAxis::Role::scene_number;
    return PlaneAxis{role, along.path, along.values.front(), along.values.back()};
  };
  options.num_modes = plane_modes(family, axis(request.x), axis(request.y), options.speed, settings);
  MapOptions search = map_options(settings);
  search.parts = work.of("stability map, this step");
  const ScenePlane plane(family, axis(request.x), axis(request.y), options);
  Map result{compute_map(plane, axis(request.x), request.x.values, axis(request.y), request.y.values, search),
             plane.scene(),
             settings,
             static_cast<int>(options.num_modes),
             search.search.tolerance,
             {}};
  std::size_t samples = 0;
  for (const StabilityMap& rod : result.maps) samples += rod.samples;
  result.evidence = fmt::format("{}; exponents at {} places", plane.evidence(), samples);
  return result;
}

Map map(const SceneFamily& family, const MapRequest& request) {
  Work work;
  return map(family, request, work);
}

bool Check::agrees() const {
  return std::ranges::all_of(speeds, [](const SpeedCheck& check) { return check.agrees(); });
}

bool Check::reached() const {
  return std::ranges::all_of(speeds, [](const SpeedCheck& check) { return check.shortfalls.empty(); });
}

std::vector<double> speeds_of(const CheckRequest& request, const Scene& scene) {
  std::vector<double> speeds;
  const auto add = [&](const char* field, double given, double speed) {
    if (!(speed >= std::numeric_limits<double>::min() && std::isfinite(speed)))
      throw RequestError(field, fmt::format("{}", given), "positive speeds");
    speeds.push_back(speed);
  };
  for (const double rpm : request.rpms) add("rpms", rpm, speed_from_rpm(rpm, scene.units));
  for (const double omega : request.omegas) add("omegas", omega, omega);
  if (speeds.empty()) speeds.push_back(speed_of(request, scene).omega);
  return speeds;
}

Check check(const Scene& scene, const CheckRequest& request, const Work& work) {
  Check result;
  result.settings = settings_of(request, scene);
  if (result.settings.only.growth || result.settings.only.verdict)
    throw RequestError("only", result.settings.only.growth ? "\"growth\"" : "\"verdict\"",
                       "steady, stability, reactions, shape: the paths are compared in what both compute");
  const std::vector<double> speeds = speeds_of(request, scene);
  if (!(request.case_limit > 0)) throw RequestError("case_limit", fmt::format("{}", request.case_limit), "seconds > 0");
  result.model = std::make_shared<const SceneModel>(make_model(scene, result.settings));
  result.speeds.resize(speeds.size());
  CheckOptions options;
  options.integrator = request.integrator;
  options.time_limit = request.case_limit;
  options.march = request.march;
  work.for_each(speeds.size(), [&](std::size_t k) {
    result.speeds[k] = cross_check(*result.model, speeds[k], result.settings, options);
  });
  return result;
}

Check check(const Scene& scene, const CheckRequest& request) { return check(scene, request, Work()); }

}  // namespace hb
