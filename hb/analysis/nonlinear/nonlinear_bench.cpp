#include "hb/analysis/nonlinear/nonlinear_bench.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/engine/nonlinear/motion_shooting.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr int given_harmonics[] = {4, 8, 12, 16, 24, 32, 48, 64, 96};
constexpr double asked_tolerances[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10};
constexpr double shooting_tolerances[] = {1e-2, 1e-4, 1e-6, 1e-8};
constexpr double reference_tolerance = 1e-10;
// Of the motion that every method starts from, in harmonics of the crank's speed.
constexpr Index start_harmonics = 6;

MatrixXd at_samples(const FourierSeries& series, Index N) {
  Index factor = 1;
  while (factor * N < 2 * series.num_harmonics() + 2) factor *= 2;
  return fourier::synthesise(series, factor * N)(Eigen::all, Eigen::seqN(0, N, factor));
}

double error_of(const MatrixXd& q, const MatrixXd& reference) {
  const double error = (q - reference).cwiseAbs().maxCoeff() / reference.cwiseAbs().maxCoeff();
  return std::isfinite(error) ? error : INFINITY;
}

// Until 0.2 s or 50 runs have passed, at least once.
template <class Run>
void time_row(BenchRow& row, const Run& run) {
  std::vector<double> times;
  const auto start = Clock::now();
  do {
    const auto begin = Clock::now();
    run();
    times.push_back(seconds_since(begin));
  } while (seconds_since(start) < 0.2 && times.size() < 50);
  std::ranges::sort(times);
  row.seconds = times.front();
  row.median_seconds = times[times.size() / 2];
}

std::function<bool()> limit(double seconds, const std::function<bool()>& stop) {
  const auto start = Clock::now();
  return [=] { return seconds_since(start) > seconds || (stop && stop()); };
}

}  // namespace

std::size_t motion_bench_cases() {
  return 1 + std::size(given_harmonics) + std::size(asked_tolerances) + 2 * std::size(shooting_tolerances);
}

RodBench bench_motion(const SceneModel& model, double speed, const Settings& settings, const BenchOptions& options,
                      const NonlinearOptions& asked) {
  RodBench bench;
  bench.name = "system";
  bench.reference = Integrator::adams;
  Settings rough = settings;
  rough.only = {true, false, false, false};
  rough.tolerance = 1e-6;
  const NonlinearResult found = nonlinear_steady(model, speed, rough, asked);
  if (found.search != MotionSearch::found) {
    bench.notes.push_back("no motion: " + found.why);
    return bench;
  }
  std::vector<ExactModel::Rod> rods;
  for (const NonlinearRod& rod : found.rods) rods.push_back({rod.link, rod.q.num_components()});
  const NonlinearSystem system = exact_system(std::make_shared<const ExactModel>(*model.linkage(), rods));
  const int turns = found.turns;
  const FourierSeries start =
      fourier::resized(found.motion.q, std::min(found.motion.q.num_harmonics(), start_harmonics * turns));
  constexpr Index num_starts = 128;
  const StartingOrbit starting{at_samples(start, num_starts),
                               at_samples(fourier::derivative(start), num_starts) / turns};
  const StartingOrbit near{at_samples(found.motion.q, num_starts),
                           at_samples(fourier::derivative(found.motion.q), num_starts) / turns};
  const auto shoot = [&](Integrator integrator, double tolerance, double seconds, const StartingOrbit& from) {
    return shoot_motion(
        system, speed, from,
        {.tolerance = tolerance, .turns = turns, .integrator = integrator, .stop = limit(seconds, asked.stop)});
  };
  const ShootingResult reference = shoot(Integrator::adams, reference_tolerance, 10 * options.time_limit, near);
  options.done();
  if (reference.orbit.q.size() == 0) {
    bench.notes.push_back("no reference: " + reference.message);
    return bench;
  }
  bench.reference_error = reference.q_error;
  bench.verdict = reference.verdict;
  const MatrixXd& exact = reference.orbit.q;

  const auto series_row = [&](const char* method, MotionOptions with, double tolerance) {
    with.turns = turns;
    with.stop = limit(options.time_limit, asked.stop);
    BenchRow row{bench.name, method, tolerance, 0, 0, 0, 0, true};
    PeriodicMotion motion;
    time_row(row, [&] { motion = solve_periodic_motion(system, speed, start, with); });
    options.done();
    if (motion.status != MotionStatus::converged && motion.status != MotionStatus::not_reached) {
      bench.notes.push_back(fmt::format(
          "{}{}: {}", method,
          tolerance > 0 ? fmt::format(" at {:.0e}", tolerance) : fmt::format(" with {}", with.num_harmonics),
          to_string(motion.status)));
      return;
    }
    row.size = motion.num_harmonics;
    row.error = error_of(at_samples(motion.q, exact.cols()), exact);
    bench.rows.push_back(row);
  };
  for (const int H : given_harmonics)
    series_row("harmonic balance, given harmonics", {.tolerance = 1e-10, .num_harmonics = H * turns}, 0);
  for (const double tolerance : asked_tolerances)
    series_row("harmonic balance, automatic", {.tolerance = tolerance}, tolerance);

  for (const Integrator integrator : {Integrator::adams, Integrator::bdf})
    for (const double tolerance : shooting_tolerances) {
      BenchRow row{bench.name, std::string("shooting, ") + to_string(integrator), tolerance};
      ShootingResult result;
      time_row(row, [&] { result = shoot(integrator, tolerance, options.time_limit, starting); });
      options.done();
      if (result.orbit.q.size() == 0) {
        bench.notes.push_back(fmt::format("{} at {:.0e}: {}", row.method, tolerance, result.message));
        continue;
      }
      row.size = result.steps;
      row.error = error_of(result.orbit.q, exact);
      bench.rows.push_back(row);
    }
  bench.notes.push_back("marching: the transients of the motion without linearisation take hundreds of turns");
  return bench;
}

}  // namespace hb
