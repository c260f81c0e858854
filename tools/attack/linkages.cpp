// Random linkages: steady states and joint forces against the Newton-Euler model of the tests, and the growth rate
// three ways: default method, Hill's determinant, shooting in time.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "hb/engine/time/shooting.hpp"
#include "hb/hb.hpp"
#include "lib/constants.hpp"
#include "lib/fourier/fourier.hpp"
#include "lib/rod/time_domain_rod.hpp"
#include "lib/stopwatch.hpp"
#include "tests/support/newton_euler.hpp"
#include "tests/support/random_hill_system.hpp"
#include "tests/support/random_linkage.hpp"
#include "tools/attack/case_flags.hpp"

namespace hb::attack {
namespace {

struct Options {
  int cases = 10;
  double seconds = HUGE_VAL;
  std::uint64_t seed = 1;
  bool verbose = false;
};

struct Tally {
  int linkages = 0, rods = 0, steady = 0, wrong_steady = 0, beyond_reference = 0, forces = 0, wrong_forces = 0,
      determinant = 0, shooting = 0, disagreements = 0, opposite = 0, undecided = 0;
  double worst_steady = 0, worst_force = 0, slowest = 0, slowest_determinant = 0;

  void add(const Tally& t) {
    linkages += t.linkages;
    rods += t.rods;
    steady += t.steady;
    wrong_steady += t.wrong_steady;
    beyond_reference += t.beyond_reference;
    forces += t.forces;
    wrong_forces += t.wrong_forces;
    determinant += t.determinant;
    shooting += t.shooting;
    disagreements += t.disagreements;
    opposite += t.opposite;
    undecided += t.undecided;
    worst_steady = std::max(worst_steady, t.worst_steady);
    worst_force = std::max(worst_force, t.worst_force);
    slowest = std::max(slowest, t.slowest);
    slowest_determinant = std::max(slowest_determinant, t.slowest_determinant);
  }
};

// Largest difference over the turn, relative to the largest of b.
double difference(const FourierSeries& a, const FourierSeries& b) {
  constexpr int angles = 64;
  double apart = 0, size = 0;
  for (int k = 0; k < angles; ++k) {
    const double tau = 2 * pi * k / angles;
    const Eigen::VectorXd p = fourier::evaluate(a, tau), q = fourier::evaluate(b, tau);
    apart = std::max(apart, (p - q).cwiseAbs().maxCoeff());
    size = std::max(size, q.cwiseAbs().maxCoeff());
  }
  return size > 0 ? apart / size : apart;
}

// q by Fourier collocation on positions alone; how far that is from itself with fewer harmonics is its doubt.
void check_steady(const Linkage& linkage, double speed, const RodResult& rod, const std::string& what, Tally& tally) {
  constexpr Eigen::Index most_unknowns = 400;
  const SteadyState& state = *rod.steady;
  if (!std::isfinite(state.error_bound) || state.q.c.cols() == 0) return;
  const Eigen::Index most = (most_unknowns / rod.num_modes - 1) / 2;
  const Eigen::Index H = std::min<Eigen::Index>(most, state.num_harmonics + 6);
  const FourierSeries fine = newton_euler::steady_state(linkage, rod.link, speed, rod.num_modes, H),
                      coarse = newton_euler::steady_state(linkage, rod.link, speed, rod.num_modes, H - H / 5);
  const double doubt = 2 * difference(coarse, fine) + 1e-10 / std::max(state.resonance_distance, 1e-12);
  constexpr double useful = 1e-6;
  if (!(doubt <= useful)) {
    ++tally.beyond_reference;
    return;
  }
  ++tally.steady;
  const double apart = difference(state.q, fine);
  tally.worst_steady = std::max(tally.worst_steady, apart);
  if (apart <= state.error_bound + doubt) return;
  ++tally.wrong_steady;
  fmt::print("  STEADY {}: q differs by {:.2e}, bound {:.2e}, reference to {:.1e}\n", what, apart, state.error_bound,
             doubt);
}

// Forces of hb's own deflections by one Newton-Euler system of all bodies at once.
void check_forces(const Linkage& linkage, double speed, const SteadyResult& result, const std::string& what,
                  Tally& tally) {
  if (!result.forces || !result.force_errors) return;
  std::vector<LinkResponse> responses;
  for (const RodResult& rod : result.rods) {
    if (!rod.steady || rod.steady->q.c.cols() == 0) return;
    responses.push_back({rod.link, rod.steady->q});
  }
  double apart = 0, size = 0;
  for (const JointForce& joint : result.forces->joints)
    for (Eigen::Index k = 0; k < joint.elastic.num_components(); ++k)
      size = std::max(size, fourier::max_abs(joint.elastic, k).value);
  for (const double tau : {0.3, 1.7, 2.9, 5.1}) {
    const auto components =
        newton_euler::joint_components(linkage, tau, newton_euler::forces(linkage, tau, speed, responses));
    for (const JointForce& joint : result.forces->joints) {
      const Eigen::VectorXd here = fourier::evaluate(joint.elastic, tau);
      const std::vector<double>& there = components.at(joint.name);
      for (std::size_t k = 0; k < there.size(); ++k)
        apart = std::max(apart, std::abs(here(Eigen::Index(k)) - there[k]));
    }
  }
  ++tally.forces;
  constexpr double reference = 1e-10;  // of the independent model
  const double relative = size > 0 ? apart / size : apart;
  tally.worst_force = std::max(tally.worst_force, relative);
  if (relative <= result.force_errors->force + reference) return;
  ++tally.wrong_forces;
  fmt::print("  FORCES {}: differ by {:.2e} of the largest, error {:.2e}\n", what, relative,
             result.force_errors->force);
}

struct Growth {
  std::string name;
  double low = 0, high = 0;
  Verdict verdict = Verdict::undecided;
};

void check_growth(const Linkage& linkage, double speed, const RodResult& rod, const HillSystem& system,
                  const std::string& what, const Options& options, Tally& tally) {
  std::vector<Growth> ways = {
      {"default", rod.stability->growth_low, rod.stability->growth_high, rod.stability->verdict}};
  tally.undecided += rod.stability->verdict == Verdict::undecided;
  const Stopwatch watch;
  const Stability determinant = analyse_stability(system, speed, {.method = StabilityMethod::determinant});
  tally.slowest_determinant = std::max(tally.slowest_determinant, watch.seconds());
  if (std::isfinite(determinant.growth_error)) {
    ++tally.determinant;
    ways.push_back({"determinant", determinant.growth_low, determinant.growth_high, determinant.verdict});
  }
  const ShootingResult shot =
      solve_by_shooting(time_domain_rod(linkage, rod.link, rod.num_modes, speed), {.tolerance = 1e-8, .time_limit = 5});
  if ((shot.status == ShootingStatus::converged || shot.status == ShootingStatus::not_reached) &&
      std::isfinite(shot.growth_error)) {
    ++tally.shooting;
    ways.push_back(
        {"shooting", shot.growth_rate - shot.growth_error, shot.growth_rate + shot.growth_error, shot.verdict});
  }
  for (const Growth& a : ways) {
    if (options.verbose)
      fmt::print("    {} {}: {} in [{:.12g}, {:.12g}]\n", what, a.name, to_string(a.verdict), a.low, a.high);
    for (const Growth& b : ways) {
      if (!(a.high < b.low)) continue;
      ++tally.disagreements;
      fmt::print("  GROWTH {}: {} [{:.12g}, {:.12g}], {} [{:.12g}, {:.12g}]\n", what, a.name, a.low, a.high, b.name,
                 b.low, b.high);
    }
    if (a.verdict != Verdict::stable ||
        std::ranges::none_of(ways, [](const Growth& g) { return g.verdict == Verdict::unstable; }))
      continue;
    ++tally.opposite;
    fmt::print("  VERDICT {}: {} says stable, another way unstable\n", what, a.name);
  }
}

Tally run_linkage(std::uint64_t number, const Options& options) {
  constexpr double slow = 10;  // seconds
  Tally tally;
  stress::Random random(number * 1000003 + 6);
  const Margins margins = random.chance(0.2) ? Margins{0.05, 0.2} : Margins{0.2, 1};
  const RandomLinkage given = random_linkages(1, 7919 * number + 11, margins).front();
  const double speed = given.speed * random.power(-0.7, 0.3);
  Request request;
  request.omega = speed;
  request.modes = int(random.integer(1, 3));
  request.only.shape = false;
  const std::string what = fmt::format("{} ({}) at {:.6g}", number, given.kind, speed);
  const Stopwatch watch;
  const SteadyResult result = steady(scene_of(given.linkage), request);
  tally.slowest = watch.seconds();
  if (tally.slowest > slow) fmt::print("  SLOW {}: {:.0f} s\n", what, tally.slowest);
  ++tally.linkages;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const RodResult& rod = result.rods[r];
    ++tally.rods;
    if (rod.steady) check_steady(given.linkage, speed, rod, what + " " + rod.name, tally);
    if (rod.stability)
      check_growth(given.linkage, speed, rod, result.model->rods[r].system, what + " " + rod.name, options, tally);
  }
  check_forces(given.linkage, speed, result, what, tally);
  return tally;
}

int run(const Options& options) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // what was found is not lost with the rest
  const Stopwatch watch;
  Tally all;
  for (int k = 0; k < options.cases && watch.seconds() < options.seconds; ++k)
    all.add(run_linkage(options.seed * 1000000 + std::uint64_t(k), options));
  fmt::print("linkages, seed {}\n", options.seed);
  fmt::print("  {} linkages, {} rods; slowest {:.2f} s\n", all.linkages, all.rods, all.slowest);
  fmt::print("  steady states: {} compared, {} outside bound and doubt, {} beyond the reference, farthest {:.1e}\n",
             all.steady, all.wrong_steady, all.beyond_reference, all.worst_steady);
  fmt::print("  joint forces: {} linkages compared, {} outside their errors, farthest {:.1e}\n", all.forces,
             all.wrong_forces, all.worst_force);
  fmt::print(
      "  growth: {} by default, {} by Hill's determinant (slowest {:.2f} s), {} by shooting: {} intervals apart, {} "
      "opposite "
      "verdicts, {} undecided\n",
      all.rods, all.determinant, all.slowest_determinant, all.shooting, all.disagreements, all.opposite, all.undecided);
  return all.wrong_steady + all.wrong_forces + all.disagreements + all.opposite == 0 ? 0 : 1;
}

}  // namespace
}  // namespace hb::attack

int main(int argc, char** argv) {
  using namespace hb::attack;
  CLI::App app{"Random linkages against the Newton-Euler model of the tests, growth rates three ways"};
  Options options;
  add_case_flags(app, options, "linkages", "every growth rate");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
