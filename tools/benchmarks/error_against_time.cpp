// Error against run time of every method on the project's own systems and on synthetic ones, as CSV on standard output:
// one row per system, method and asked tolerance. Errors against a reference made by another method, outside the timed
// runs; a dense Hill solve and shooting with SUNDIALS stand beside as yardsticks.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "cases.hpp"
#include "dense_hill.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "hb/engine/time/shooting.hpp"
#include "lib/time_domain.hpp"
#include "timing.hpp"

namespace hb::benchmarks {

namespace {

void row(const Case& c, const char* quantity, const char* method, double asked, long size, double error, double claimed,
         const Timing& timing) {
  std::printf("%s,%ld,%s,%s,%.0e,%ld,%.3e,%.3e,%.4e,%.4e\n", c.name.c_str(), static_cast<long>(c.system.num_modes()),
              quantity, method, asked, size, error, claimed, timing.best, timing.median);
  std::fflush(stdout);
}

constexpr double tolerances[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};

void steady_rows(const Case& c) {
  const SteadyState finest = solve_steady_state(c.system, c.speed, {.tolerance = 1e-13});
  const ScaledSystem scaled = scale_system(c.system, c.speed);
  const int most = static_cast<int>(3000 / c.system.num_modes() / 2);
  const FourierSeries exact = dense_hill_solution(scaled, std::min(most, finest.num_harmonics + 12), 3);
  const auto method_rows = [&](const char* name, SteadyMethod method) {
    for (const double asked : tolerances) {
      const SteadyOptions options{.tolerance = asked, .method = method};
      const SteadyState state = solve_steady_state(c.system, c.speed, options);
      if (state.status != SteadyStatus::converged) continue;
      row(c, "steady", name, asked, state.num_harmonics, relative_error(state.q, exact), state.error_bound,
          timed([&] { (void)solve_steady_state(c.system, c.speed, options); }));
      if (method == SteadyMethod::automatic && c.system.num_modes() <= 10)
        row(c, "steady", "dense_hill", asked, state.num_harmonics,
            relative_error(dense_hill_solution(scaled, state.num_harmonics), exact), 0,
            timed([&] { (void)dense_hill_solution(scaled, state.num_harmonics); }));
    }
  };
  method_rows("automatic", SteadyMethod::automatic);
  method_rows("direct", SteadyMethod::direct);
  method_rows("iterative", SteadyMethod::iterative);
  if (!c.integrate) return;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    const ShootingOptions options{.integrator = Integrator::adams, .time_limit = 5, .single_run = tolerance};
    const ShootingResult result = solve_by_shooting(time_domain_system(c.system, c.speed), options);
    if (result.orbit.q.cols() == 0) continue;
    row(c, "steady", "cvode_shooting", tolerance, result.steps, relative_error(result.orbit.q, exact), 0,
        timed([&] { (void)solve_by_shooting(time_domain_system(c.system, c.speed), options); }));
  }
}

void growth_rows(const Case& c) {
  // The most accurate answer of the other methods.
  const auto reference = [&](StabilityMethod without) {
    Stability best;
    best.growth_error = HUGE_VAL;
    for (const StabilityMethod method : {StabilityMethod::propagation, StabilityMethod::slaving}) {
      if (method == without) continue;
      const Stability here = analyse_stability(c.system, c.speed, {.tolerance = 1e-12, .method = method});
      if (here.growth_error < best.growth_error) best = here;
    }
    return best.growth_rate;
  };
  const auto rows = [&](const char* name, StabilityMethod method, bool leading_only) {
    const double exact = reference(method == StabilityMethod::automatic ? StabilityMethod::slaving : method);
    for (const double asked : {1e-3, 1e-6, 1e-9, 1e-11}) {
      if (c.system.num_modes() > 10 && asked != 1e-9) continue;  // seconds each
      const StabilityOptions options{.tolerance = asked, .method = method, .leading_only = leading_only};
      const Stability result = analyse_stability(c.system, c.speed, options);
      if (!std::isfinite(result.growth_error)) continue;
      const double scale = std::max(std::abs(exact), c.speed);
      row(c, "growth", name, asked, static_cast<long>(result.exponents.size()),
          std::abs(result.growth_rate - exact) / scale, result.growth_error / scale,
          timed([&] { (void)analyse_stability(c.system, c.speed, options); }));
    }
  };
  rows("automatic_leading", StabilityMethod::automatic, true);
  rows("automatic_all", StabilityMethod::automatic, false);
  if (c.system.num_modes() > 10) return;
  rows("slaving", StabilityMethod::slaving, false);
  rows("propagation", StabilityMethod::propagation, false);
  rows("bound", StabilityMethod::bound, false);
  if (c.system.num_modes() > 2) return;
  rows("hill", StabilityMethod::hill, false);
  rows("determinant", StabilityMethod::determinant, false);
}

}  // namespace

}  // namespace hb::benchmarks

int main() {
  using namespace hb::benchmarks;
  std::printf("%s\n", header().c_str());
  std::printf("system,modes,quantity,method,asked,size,error,claimed,seconds_min,seconds_median\n");
  for (const Case& c : all_cases()) {
    steady_rows(c);
    growth_rows(c);
  }
}
