#include "hb/analysis/analyses.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "hb/analysis/expected_memory.hpp"

namespace hb {

std::shared_ptr<const SweepScene> sweep_scene(const SceneFamily& family, const SweepRequest& request) {
  const Along& x = request.x;
  if (x.values.empty()) throw RequestError("x", "no values", "at least two");
  const Scene scene = some_scene(family, {&x});
  require_values("x", x, scene.units);
  Speed fixed;
  if (is_speed(x.path)) {
    require_no_speed(request, "x", x);
  } else {
    fixed = speed_of(request, scene);
  }
  Axis axis;
  axis.kind = in_rpm(x.path) ? Axis::Kind::rpm : is_speed(x.path) ? Axis::Kind::omega : Axis::Kind::parameter;
  axis.path = x.path;
  axis.values = x.values;
  return std::make_shared<const SweepScene>(family, settings_of(request, scene), std::move(axis), fixed.omega,
                                            fixed.rpm);
}

Sweep sweep(const SceneFamily& family, const SweepRequest& request, Work& work) {
  const std::shared_ptr<const SweepScene> scene = sweep_scene(family, request);
  return {run_sweep(*scene, work), scene};
}

Sweep sweep(const SceneFamily& family, const SweepRequest& request) {
  Work work;
  return sweep(family, request, work);
}

Map map(const SceneFamily& family, const MapRequest& request, Work& work) {
  return MapTask(family, request, work).compute(work);
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
  result.over_range = speeds.size() > 1;
  if (!(request.case_limit > 0)) throw RequestError("case_limit", fmt::format("{}", request.case_limit), "seconds > 0");
  result.model = std::make_shared<const SceneModel>(make_model(scene, result.settings));
  if (request.expected) request.expected(expected_bytes(*result.model, result.settings));
  std::vector<std::optional<SpeedCheck>> found(speeds.size());
  work.for_each(speeds.size(), [&](std::size_t k) {
    if (work.ends_early()) return;
    CheckOptions options;
    options.integrator = request.integrator;
    options.time_limit = request.case_limit;
    options.march = request.march;
    if (request.begin)
      options.begin = [&](const std::string& rod, Integrator integrator, double seconds) {
        request.begin(rod, speeds[k], integrator, seconds);
      };
    found[k] = cross_check(*result.model, speeds[k], result.settings, options);
    if (request.done) request.done(speeds[k]);
  });
  for (std::optional<SpeedCheck>& one : found)
    if (one) result.speeds.push_back(std::move(*one));
  if (const std::size_t missing = speeds.size() - result.speeds.size(); missing > 0 && !result.speeds.empty())
    result.speeds.front().shortfalls.push_back(
        fmt::format("ended before the answer was complete: {} of {} speeds were not computed", missing, speeds.size()));
  return result;
}

Check check(const Scene& scene, const CheckRequest& request) { return check(scene, request, Work()); }

}  // namespace hb
