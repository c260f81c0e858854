#include "hb/analysis/nonlinear/nonlinear_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/engine/nonlinear/motion_shooting.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Of automatic modes: both paths take the same, and the highest ones, which decide neither, cost both the most time.
constexpr double compared_cut = 1e-5;

// Samples at N angles of a series with any number of harmonics.
MatrixXd samples(const FourierSeries& series, Index N) {
  Index factor = 1;
  while (factor * N < 2 * series.num_harmonics() + 2) factor *= 2;
  return fourier::synthesise(series, factor * N)(Eigen::all, Eigen::seqN(0, N, factor));
}

// Both states at the shooting path's angles, with what the errors of both allow.
void compare_rods(const SceneModel& model, const ExactModel& exact, NonlinearCheck& check) {
  const PeriodicOrbit& orbit = check.shooting.orbit;
  const PeriodicMotion& motion = check.series.motion;
  const Index N = orbit.q.cols();
  const MatrixXd q = samples(motion.q, N), q1 = samples(fourier::derivative(motion.q), N) / double(motion.turns);
  const double all = q.cwiseAbs().maxCoeff(), all1 = q1.cwiseAbs().maxCoeff();
  // What the errors of the series do to q': its harmonics, of which the highest counts most.
  const MatrixXd finer = samples(fourier::derivative(motion.q_finer), N) / double(motion.turns);
  for (std::size_t r = 0; r < model.rods.size(); ++r) {
    if (!model.rods[r].reported) continue;
    const Index first = exact.first_mode(r), I = exact.rods()[r].num_modes;
    const auto rows = [&](const MatrixXd& values) { return values.middleRows(first, I); };
    const double size = rows(q).cwiseAbs().maxCoeff(), size1 = rows(q1).cwiseAbs().maxCoeff();
    NonlinearRodCheck rod{model.rods[r].name, {}, {}};
    // The integration's errors are relative to the largest of all rods.
    rod.q = {"q / max |q|", (rows(orbit.q) - rows(q)).cwiseAbs().maxCoeff() / size,
             motion.error.segment(first, I).maxCoeff() / size + check.shooting.q_error * all / size};
    rod.q1 = {"q' / max |q'|", (rows(orbit.q1) - rows(q1)).cwiseAbs().maxCoeff() / size1,
              3 * (rows(finer) - rows(q1)).cwiseAbs().maxCoeff() / size1 + check.shooting.q1_error * all1 / size1 +
                  motion.error_bound};
    check.rods.push_back(std::move(rod));
  }
}

void compare_exponents(NonlinearCheck& check) {
  if (!check.series.stability) return;
  const double omega = check.speed / check.series.turns;
  const auto apart = [omega](std::complex<double> a, std::complex<double> b) {
    return std::hypot(a.real() - b.real(), std::remainder(a.imag() - b.imag(), omega));
  };
  double worst = -1;
  for (const Exponent& shot : check.shooting.exponents) {
    const Exponent* nearest = nullptr;
    for (const auto* list : {&check.series.stability->exponents, &check.series.stability->uncertain})
      for (const Exponent& e : *list)
        if (!nearest || apart(e.value, shot.value) < apart(nearest->value, shot.value)) nearest = &e;
    if (!nearest) return;
    const Comparison pair{"exponents", apart(nearest->value, shot.value), nearest->error + shot.error};
    const double used = pair.allowed > 0 ? pair.difference / pair.allowed : HUGE_VAL;
    if (!(used > worst)) continue;
    worst = used;
    check.exponents = pair;
  }
}

}  // namespace

bool NonlinearCheck::opposite_verdicts() const {
  if (!series.stability || !not_compared.empty()) return false;
  const auto opposite = [](Verdict a, Verdict b) { return a == Verdict::stable && b == Verdict::unstable; };
  return opposite(series.stability->verdict, shooting.verdict) || opposite(shooting.verdict, series.stability->verdict);
}

bool NonlinearCheck::agrees() const {
  return std::ranges::all_of(rods, &NonlinearRodCheck::agrees) && (!exponents || exponents->agrees()) &&
         !opposite_verdicts();
}

NonlinearCheck nonlinear_check(const SceneModel& model, double speed, const Settings& settings,
                               const CheckOptions& asked, const NonlinearOptions& options) {
  NonlinearCheck check;
  check.speed = speed;
  Settings series = settings;
  series.only = {true, settings.only.stability, false, false};
  Stopwatch watch;
  NonlinearOptions with_modes = options;
  with_modes.least_cut = compared_cut;
  check.series = nonlinear_steady(model, speed, series, with_modes);
  check.seconds_harmonic_balance = watch.seconds();
  check.shortfalls = check.series.shortfalls;
  if (check.series.search != MotionSearch::found) {
    check.not_compared = check.series.why;
    return check;
  }
  std::vector<ExactModel::Rod> rods;
  for (const NonlinearRod& rod : check.series.rods) rods.push_back({rod.link, rod.q.num_components()});
  const auto exact = std::make_shared<const ExactModel>(*model.linkage(), rods);
  const PeriodicMotion& motion = check.series.motion;
  constexpr Index start_samples = 128;
  const StartingOrbit start{samples(motion.q, start_samples),
                            samples(fourier::derivative(motion.q), start_samples) / double(motion.turns)};
  MotionShootingOptions shooting;
  shooting.tolerance = std::max(integration_tolerance(settings), 1e-8);
  shooting.turns = motion.turns;
  shooting.integrator = asked.integrator;
  const auto began = std::chrono::steady_clock::now();
  const double limit = asked.time_limit;
  bool late = false;
  shooting.stop = [&options, &late, began, limit] {
    late = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > limit;
    return late || (options.stop && options.stop());
  };
  check.shooting = shoot_motion(exact_system(exact), speed, start, shooting);
  check.seconds_shooting = check.shooting.seconds;
  if (late && check.shooting.status != ShootingStatus::converged)
    check.shooting.message +=
        fmt::format(" by the limit of {:g} s for each speed; {} modes take long, fewer or a longer limit would do",
                    limit, exact->num_modes());
  if (check.shooting.status != ShootingStatus::converged)
    check.shortfalls.push_back("time integration: " + check.shooting.message);
  if (check.shooting.orbit.q.size() == 0) {
    check.not_compared = "time integration: " + check.shooting.message;
    return check;
  }
  compare_rods(model, *exact, check);
  compare_exponents(check);
  return check;
}

}  // namespace hb
