#include "hb/analysis/bench_rod.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>

#include "hb/analysis/rod_steady.hpp"
#include "hb/engine/time/fixed_step.hpp"
#include "hb/engine/time/marching.hpp"
#include "lib/constants.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

using Clock = std::chrono::steady_clock;

// Of q, the first rows, at the reference's angles, from N samples of which N is a multiple or a divisor.
double error_of(const Eigen::MatrixXd& q, const Eigen::MatrixXd& reference) {
  const Eigen::Index n = std::min(q.cols(), reference.cols());
  double difference = 0;
  for (Eigen::Index j = 0; j < n; ++j)
    difference = std::max(difference,
                          (q.col(j * (q.cols() / n)).head(reference.rows()) - reference.col(j * (reference.cols() / n)))
                              .cwiseAbs()
                              .maxCoeff());
  const double error = difference / reference.cwiseAbs().maxCoeff();
  return std::isfinite(error) ? error : INFINITY;
}

Eigen::MatrixXd at_angles(const FourierSeries& series, Eigen::Index N) {
  Eigen::MatrixXd values(series.num_components(), N);
  for (Eigen::Index j = 0; j < N; ++j)
    values.col(j) = fourier::evaluate(series, two_pi * static_cast<double>(j) / static_cast<double>(N));
  return values;
}

// Repeats until 50 ms or 200 runs have passed, at least once; shortest and median time of one run.
void time_row(BenchRow& row, const std::function<void()>& work) {
  std::vector<double> times;
  const auto start = Clock::now();
  do {
    const auto begin = Clock::now();
    work();
    times.push_back(seconds_since(begin));
  } while (seconds_since(start) < 0.05 && times.size() < 200);
  std::sort(times.begin(), times.end());
  row.seconds = times.front();
  row.median_seconds = times[times.size() / 2];
}

constexpr int given_harmonics[] = {1, 2, 4, 6, 8, 12, 16, 24, 32, 48, 64};
constexpr double asked_tolerances[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
constexpr double shooting_tolerances[] = {1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13};
constexpr double marching_tolerances[] = {1e-3, 1e-5, 1e-7, 1e-9, 1e-11};
constexpr int steps_a_turn[] = {128, 512, 2048, 8192, 32768, 131072, 524288};
// The error is measured against a reference that errs itself.
const BenchRow* quickest(const RodBench& bench, double error, bool harmonic_balance) {
  const BenchRow* best = nullptr;
  for (const BenchRow& row : bench.rows)
    if (row.harmonic_balance == harmonic_balance && row.error + bench.reference_error <= error &&
        (best == nullptr || row.seconds < best->seconds))
      best = &row;
  return best;
}

// The rows of one rod, method by method, against orbits of the reference at its crank angles.
class RodRows {
 public:
  RodRows(const RodModel& rod, const TimeDomainSystem& system, const BenchOptions& with,
          const ShootingResult& reference, RodBench& bench)
      : rod_(rod),
        system_(system),
        with_(with),
        growth_rate_(reference.growth_rate),
        exact_(reference.orbit.q.topRows(rod.num_modes)),
        bench_(bench) {}

  void harmonic_balance(const char* method, const SteadyOptions& options, double asked) {
    BenchRow row{rod_.name, method, asked, 0, 0, 0, 0, true};
    SteadyState state;
    time_row(row, [&] { state = solve_rod(rod_.system, rod_.num_modes, system_.speed, options); });
    with_.done();
    if (state.status == SteadyStatus::singular) return;
    add(row, state.num_harmonics, at_angles(state.q, exact_.cols()));
  }

  void shooting(Integrator integrator, double tolerance) {
    BenchRow row{rod_.name, std::string("shooting, ") + to_string(integrator), tolerance};
    ShootingResult result;
    time_row(row, [&] {
      result = solve_by_shooting(system_,
                                 {.integrator = integrator, .time_limit = with_.time_limit, .single_run = tolerance});
    });
    with_.done();
    if (result.orbit.q.size() == 0) return note(fmt::format("{} at {:.0e}: {}", row.method, tolerance, result.message));
    add(row, result.steps, result.orbit.q);
  }

  void marching(Integrator integrator, double tolerance) {
    BenchRow row{rod_.name, std::string("marching, ") + to_string(integrator), tolerance};
    MarchingResult result;
    time_row(row, [&] {
      result = march_from_rest(system_, {.tolerance = tolerance,
                                         .integrator_tolerance = tolerance / 10,
                                         .integrator = integrator,
                                         .time_limit = with_.time_limit,
                                         .growth_rate = growth_rate_});
    });
    with_.done();
    if (result.status != ShootingStatus::converged)
      return note(fmt::format("{} at {:.0e}: {}", row.method, tolerance,
                              result.message.empty() ? to_string(result.status) : result.message));
    add(row, result.steps, result.orbit.q);
  }

  // With more and more steps, as long as the time allows.
  void fixed_steps(FixedStep method) {
    const char* name = method == FixedStep::newmark ? "marching, Newmark" : "marching, Runge-Kutta 4";
    const int order = method == FixedStep::newmark ? 2 : 4;
    double seconds_before = 0;
    for (const int steps : steps_a_turn) {
      with_.done();
      if (4 * seconds_before > with_.time_limit)
        return note(fmt::format("{} with {} steps a turn: would take about {:.0f} s, more than the limit for a case",
                                name, steps, 4 * seconds_before));
      // The transient is followed well below the error of such steps, h^order or more.
      const double h = two_pi / steps;
      const double settled = std::max(0.1 * std::pow(h, order), 1e-12);
      BenchRow row{rod_.name, name};
      MarchingResult result;
      time_row(row, [&] { result = march_fixed_step(system_, method, steps, settled, 100000, with_.time_limit); });
      if (result.status != ShootingStatus::converged) {
        note(fmt::format("{} with {} steps a turn: {}", name, steps, result.message));
        if (result.status == ShootingStatus::time_limit) return;
        continue;
      }
      seconds_before = row.seconds;
      add(row, result.steps, result.orbit.q);
    }
  }

  void note(const std::string& sentence) { bench_.notes.push_back(sentence); }

 private:
  template <class Size>
  void add(BenchRow& row, Size size, const Eigen::MatrixXd& q) {
    row.size = size;
    row.error = error_of(q, exact_);
    bench_.rows.push_back(row);
  }

  const RodModel& rod_;
  const TimeDomainSystem& system_;
  const BenchOptions& with_;
  double growth_rate_;
  Eigen::MatrixXd exact_;
  RodBench& bench_;
};

}  // namespace

// The reference, then every method (harmonic balance in two ways, the others in two kinds each).
std::size_t bench_cases() {
  return 1 + std::size(given_harmonics) + std::size(asked_tolerances) +
         2 * (std::size(shooting_tolerances) + std::size(marching_tolerances) + std::size(steps_a_turn));
}

RodBench bench_rod(const RodModel& rod, const TimeDomainSystem& system, const BenchOptions& with) {
  RodBench bench;
  bench.name = rod.name;
  ShootingOptions tight;
  tight.integrator = Integrator::collocation;
  tight.tolerance = 1e-13;
  tight.time_limit = 10 * with.time_limit;
  const ShootingResult reference = solve_by_shooting(system, tight);
  with.done();
  if (reference.orbit.q.size() == 0 || !(reference.orbit.q.cwiseAbs().maxCoeff() > 0)) {
    bench.notes.push_back("no reference: " +
                          (reference.message.empty() ? "the rod carries no load" : reference.message));
    return bench;
  }
  bench.reference_error = reference.q_error;
  bench.verdict = reference.verdict;

  RodRows rows(rod, system, with, reference, bench);
  for (const int H : given_harmonics)
    rows.harmonic_balance("harmonic balance, given harmonics",
                          {.tolerance = 1e-14, .num_harmonics = H, .method = with.method}, 0);
  for (const double tolerance : asked_tolerances)
    rows.harmonic_balance("harmonic balance, automatic", {.tolerance = tolerance, .method = with.method}, tolerance);
  for (const Integrator integrator : {Integrator::adams, Integrator::bdf})
    for (const double tolerance : shooting_tolerances) rows.shooting(integrator, tolerance);
  if (bench.verdict == Verdict::unstable) {
    rows.note("marching: the motion is unstable, no integration from rest settles on the periodic state");
    return bench;
  }
  for (const Integrator integrator : {Integrator::adams, Integrator::bdf})
    for (const double tolerance : marching_tolerances) rows.marching(integrator, tolerance);
  for (const FixedStep method : {FixedStep::newmark, FixedStep::runge_kutta}) rows.fixed_steps(method);
  return bench;
}

namespace {

// Times of one run differ from those of the next by more: "17", "120".
std::string in_two_digits(double ratio) {
  if (!(ratio >= 100)) return fmt::format("{:.2g}", ratio);
  const double unit = std::pow(10, std::floor(std::log10(ratio)) - 1);
  return fmt::format("{:.0f}", unit * std::round(ratio / unit));
}

}  // namespace

std::string ratio_sentence(const RodBench& bench, double error) {
  if (!(bench.reference_error < error))
    return fmt::format("at {:.0e}: not known, the reference itself has an error of {:.1e}", error,
                       bench.reference_error);
  const BenchRow* series = quickest(bench, error, true);
  const BenchRow* integration = quickest(bench, error, false);
  if (series == nullptr && integration == nullptr) return fmt::format("at {:.0e}: no method reaches it", error);
  if (series == nullptr)
    return fmt::format("at {:.0e}: only {} reaches it, in {:.2g} s", error, integration->method, integration->seconds);
  if (integration == nullptr)
    return fmt::format("at {:.0e}: only harmonic balance reaches it, in {:.2g} s", error, series->seconds);
  const double ratio = integration->seconds / series->seconds;
  const std::string how = ratio >= 1 ? fmt::format("{} times as long", in_two_digits(ratio))
                                     : fmt::format("shorter by a factor of {}", in_two_digits(1 / ratio));
  return fmt::format("at {:.0e}: harmonic balance {:.2g} s, the fastest integration ({}) {:.2g} s, {}", error,
                     series->seconds, integration->method, integration->seconds, how);
}

}  // namespace hb
