#include "tools/command/sweep_forecast.hpp"

#include <algorithm>
#include <cmath>

#include "hb/analysis/expected_memory.hpp"
#include "hb/analysis/expected_time.hpp"
#include "tools/work/forecast.hpp"

namespace hb::tools {
namespace {

// All points, and those under way; models of their own where the axis is not the speed.
void say_memory_of(const SweepScene& swept, const Output& out) {
  const SceneModel& model = swept.first();
  const std::size_t points = swept.axis().values.size();
  const double each =
      expected_bytes(model, swept.settings()) + (swept.axis().kind == Axis::Kind::parameter ? bytes_of(model) : 0);
  const bool documents = out.json || out.folder || out.html;
  say_memory("the sweep", expected_bytes_of_points(model, swept.settings(), points, documents) +
                              each * static_cast<double>(std::min(points, static_cast<std::size_t>(out.threads))));
}

// Shorter points are known by the first of them.
void say_expected_of(const SweepScene& swept, int threads) {
  constexpr double long_point = 1;
  const double each = expected_seconds(swept.first(), swept.settings());
  if (each < long_point) return;
  say_expected("the sweep", each * std::ceil(static_cast<double>(swept.axis().values.size()) / threads),
               "--modes, --only, --threads and --time-limit",
               swept.settings().stability_method == StabilityMethod::determinant);
}

}  // namespace

void say_forecast_of(const SweepScene& swept, const Output& out) {
  say_memory_of(swept, out);
  say_expected_of(swept, out.threads);
}

NonlinearSweep announced_branches(const SweepScene& swept, NonlinearSweepOptions options) {
  Forecast forecast("the branch from the first value", 0);
  forecast.begin(swept.axis().values.size(), 1);
  options.advanced = [&](std::size_t values) { forecast.advance(values); };
  return nonlinear_sweep(swept, options);
}

}  // namespace hb::tools
