// The six-link mechanism without linearisation, both rods together, two Ritz terms each: one motion from that of a
// neighbouring speed, and a branch. Counters beside the time: the true error of the answer (against the motion at a
// tolerance of 1e-11), the error bound it came with, and its harmonics.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/engine/nonlinear/continuation.hpp"
#include "lib/scene/scene.hpp"

namespace hb::benchmarks {

namespace {

constexpr Eigen::Index num_modes = 2;

struct Mechanism {
  Units units;
  NonlinearSystem system;
  double speed(double rpm) const { return speed_from_rpm(rpm, units); }
};

Mechanism six_link() {
  const Scene scene = read_scene(HB_SOURCE_DIR "/results/six_link/scene.toml");
  const auto& linkage = std::get<Linkage>(scene.model);
  std::vector<ExactModel::Rod> rods;
  for (const int link : elastic_links(linkage)) rods.push_back({link, num_modes});
  return {scene.units, exact_system(std::make_shared<const ExactModel>(linkage, rods))};
}

double error_of(const NonlinearSystem& system, const PeriodicMotion& motion) {
  const PeriodicMotion exact = solve_periodic_motion(system, motion.parameter, motion.q, {.tolerance = 1e-11});
  const FourierSeries difference = fourier::difference(exact.q, motion.q);
  double error = 0, size = 0;
  for (Eigen::Index i = 0; i < difference.num_components(); ++i) {
    error = std::max(error, fourier::max_abs(difference, i).value);
    size = std::max(size, fourier::max_abs(exact.q, i).value);
  }
  return error / size;
}

// From the motion at a speed that is 1 % lower.
void nonlinear_point(benchmark::State& state) {
  const Mechanism mechanism = six_link();
  const double speed = mechanism.speed(static_cast<double>(state.range(0)));
  const MotionOptions options{.tolerance = 1e-8};
  const PeriodicMotion neighbour = solve_periodic_motion(mechanism.system, 0.99 * speed, {}, options);
  PeriodicMotion motion;
  for (auto _ : state) motion = solve_periodic_motion(mechanism.system, speed, neighbour.q, options);
  if (motion.status != MotionStatus::converged) throw std::runtime_error("nonlinear_point: no motion");
  state.counters["error"] = error_of(mechanism.system, motion);
  state.counters["bound"] = motion.error_bound;
  state.counters["harmonics"] = motion.num_harmonics;
}

// 300 rpm upward, points every few rpm, with or without exponents at each.
void nonlinear_branch(benchmark::State& state) {
  const Mechanism mechanism = six_link();
  ContinuationOptions options;
  options.low = mechanism.speed(300);
  options.high = mechanism.speed(1300);
  options.most_parameter_step = (options.high - options.low) / 500;
  options.stability = state.range(0) != 0;
  const PeriodicMotion start = solve_periodic_motion(mechanism.system, options.low, {}, options.motion);
  Branch branch;
  for (auto _ : state) branch = follow_branch(mechanism.system, start, options);
  if (branch.end != BranchEnd::range) throw std::runtime_error("nonlinear_branch: it ended early");
  state.counters["points"] = static_cast<double>(branch.points.size());
  const PeriodicMotion& last = branch.points.back().motion;
  state.counters["error"] = error_of(mechanism.system, last);
  state.counters["bound"] = last.error_bound;
  state.counters["harmonics"] = last.num_harmonics;
}

BENCHMARK(nonlinear_point)->ArgName("rpm")->Arg(300)->Arg(600)->Arg(900)->Arg(1200)->Unit(benchmark::kMillisecond);
BENCHMARK(nonlinear_branch)->ArgName("exponents")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace

}  // namespace hb::benchmarks
