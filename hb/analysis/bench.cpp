#include "hb/analysis/bench.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "hb/analysis/nonlinear/nonlinear_bench.hpp"
#include "lib/rod/time_domain_rod.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

// All but the rods.
Bench prepared(const Scene& scene, const BenchRequest& request) {
  if (!(request.case_limit > 0 && std::isfinite(request.case_limit)))
    throw RequestError("case_limit", fmt::format("{}", request.case_limit), "seconds > 0");
  Bench bench;
  bench.given = speed_of(request, scene);
  bench.settings = settings_of(request, scene);
  bench.settings.only = {.steady = true, .stability = false, .reactions = false, .shape = false};
  const Stopwatch watch;
  bench.model = std::make_shared<const SceneModel>(make_model(scene, bench.settings));
  bench.geometry_seconds = watch.seconds();
  return bench;
}

BenchOptions options_of(const BenchRequest& request, SteadyMethod method, std::size_t cases) {
  std::function<void()> done = [] {};
  if (request.told) done = [&request, cases, k = std::size_t{0}]() mutable { request.told(++k, cases); };
  return {method, request.case_limit, std::move(done)};
}

}  // namespace

bool Bench::complete() const {
  return std::ranges::none_of(rods, [](const RodBench& rod) { return rod.rows.empty(); });
}

Bench bench(const Scene& scene, const BenchRequest& request) {
  Bench result = prepared(scene, request);
  const SceneModel& model = *result.model;
  const double speed = result.given.omega;
  const auto count = static_cast<std::size_t>(std::ranges::count_if(model.rods, &RodModel::reported));
  const BenchOptions options = options_of(request, result.settings.steady_method, count * bench_cases());
  for (const RodModel& rod : model.rods) {
    if (!rod.reported) continue;
    const TimeDomainSystem system = model.linkage() != nullptr
                                        ? time_domain_rod(*model.linkage(), rod.link, rod.num_modes, speed)
                                        : time_domain_system(rod.system, speed);
    result.rods.push_back(bench_rod(rod, system, options));
  }
  Settings judged = result.settings;
  judged.only = {.steady = true, .stability = true, .reactions = false, .shape = false, .verdict = true};
  const SpeedResult answer = analyse(model, speed, judged);
  result.theory = answer.theory;
  for (const RodResult& rod : answer.rods)
    result.verdicts.emplace_back(rod.name, rod.stability ? std::optional(rod.stability->verdict) : std::nullopt);
  return result;
}

Bench nonlinear_bench(const Scene& scene, const BenchRequest& request, const NonlinearOptions& motion) {
  Bench result = prepared(scene, request);
  result.nonlinear = true;
  const BenchOptions options = options_of(request, result.settings.steady_method, motion_bench_cases());
  const RodBench& rod =
      result.rods.emplace_back(bench_motion(*result.model, result.given.omega, result.settings, options, motion));
  if (!rod.rows.empty()) result.verdicts = {{rod.name, rod.verdict}};
  return result;
}

}  // namespace hb
