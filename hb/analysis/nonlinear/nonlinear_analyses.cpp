#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace hb {
namespace {

// The motion is that of all rods, whatever is asked of it.
std::shared_ptr<const SceneModel> model_for(const Scene& scene, Settings settings) {
  settings.only.steady = true;
  return std::make_shared<const SceneModel>(make_model(scene, settings, false));
}

}  // namespace

NonlinearSteady nonlinear_steady(const Scene& scene, const Request& request, const NonlinearOptions& options) {
  const Speed speed = speed_of(request, scene);
  const Settings settings = settings_of(request, scene);
  const std::shared_ptr<const SceneModel> model = model_for(scene, settings);
  return {nonlinear_steady(*model, speed.omega, settings, options), speed, settings, model};
}

std::vector<NonlinearBand> nonlinear_bands(const Scene& scene, const Request& request, const NonlinearOptions& options,
                                           const std::vector<BandRequest>& bands) {
  std::vector<NonlinearBand> found;
  for (const BandRequest& band : bands) {
    const auto at = [&](double factor) {
      return nonlinear_steady(scaled_scene(scene, band.parameter, factor), request, options);
    };
    found.push_back({band, at(band.from), at(band.to)});
  }
  return found;
}

NonlinearAlong nonlinear_sweep(const SceneFamily& family, const SweepRequest& request,
                               const NonlinearSweepOptions& options, Work& work) {
  Sweep linear = sweep(family, request, work);
  NonlinearSweep branches = nonlinear_sweep(*linear.scene, options);
  return {std::move(linear), std::move(branches)};
}

NonlinearAlong nonlinear_sweep(const SceneFamily& family, const SweepRequest& request,
                               const NonlinearSweepOptions& options) {
  Work work;
  return nonlinear_sweep(family, request, options, work);
}

bool NonlinearChecks::agrees() const { return std::ranges::all_of(speeds, &NonlinearCheck::agrees); }

bool NonlinearChecks::reached() const {
  return std::ranges::all_of(speeds, [](const NonlinearCheck& check) { return check.shortfalls.empty(); });
}

NonlinearChecks nonlinear_check(const Scene& scene, const CheckRequest& request, const NonlinearOptions& options,
                                const Work& work) {
  if (request.march) throw RequestError("march", "with the nonlinear theory", "with the linear one");
  if (request.integrator == Integrator::collocation)
    throw RequestError("integrator", "collocation with the nonlinear theory", "automatic, adams, bdf");
  if (!(request.case_limit > 0)) throw RequestError("case_limit", fmt::format("{}", request.case_limit), "seconds > 0");
  NonlinearChecks result;
  result.settings = settings_of(request, scene);
  const std::vector<double> speeds = speeds_of(request, scene);
  result.model = model_for(scene, result.settings);
  result.speeds.resize(speeds.size());
  CheckOptions with;
  with.integrator = request.integrator;
  with.time_limit = request.case_limit;
  work.for_each(speeds.size(), [&](std::size_t k) {
    result.speeds[k] = nonlinear_check(*result.model, speeds[k], result.settings, with, options);
  });
  return result;
}

NonlinearChecks nonlinear_check(const Scene& scene, const CheckRequest& request, const NonlinearOptions& options) {
  return nonlinear_check(scene, request, options, Work());
}

}  // namespace hb
