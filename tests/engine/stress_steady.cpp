// Steady states of random systems against dense harmonic balance refined in long double: no bound below the true error.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "hb/engine/steady/steady_state.hpp"
#include "tests/support/dense_harmonic_balance.hpp"
#include "tests/support/random_hill_system.hpp"

namespace hb {
namespace {

using Eigen::Index;

constexpr Index most_unknowns = 420;

struct SteadyTally {
  int solved = 0, reached = 0, singular = 0, uncovered = 0, unsettled = 0, proved = 0;
  double closest = 0;  // largest true error / bound
};

Index stiffness_harmonics(const HillSystem& system) {
  Index P = 0;
  for (const FourierSeries& part : system.stiffness) P = std::max(P, part.num_harmonics());
  return P;
}

void add_load(HillSystem& system, stress::Random& random) {
  const Index I = system.num_modes(), F = random.chance(0.15) ? random.integer(10, 40) : random.integer(0, 6);
  const double amplitude = random.chance(0.2) ? random.power(-200, 200) : 1;
  system.load[0] = FourierSeries(I, F);
  for (Index k = 0; k <= F; ++k)
    for (Index i = 0; i < I; ++i) {
      if (random.chance(0.2)) continue;
      const double size = amplitude * std::sqrt(system.mass(i, i)) / (1 + 0.1 * double(k * k));
      system.load[0].c(i, k) = {size * random(-1, 1), k > 0 ? size * random(-1, 1) : 0.0};
    }
}

// One mode moved next to a harmonic, undamped or nearly so.
void bring_to_resonance(stress::Trial& trial, stress::Random& random) {
  HillSystem& s = trial.system;
  const Index i = random.integer(0, s.num_modes() - 1);
  const double w = trial.speed * (double(random.integer(1, 4)) + random.power(-13, -1));
  s.stiffness[0].c(i + s.num_modes() * i, 0) = w * w * s.mass(i, i);
  s.damping(i, i) = random.chance(0.5) ? 0 : s.damping(i, i) * random.power(-12, 0);
}

void compare(const SteadyState& state, const HillSystem& system, double speed, const SteadyOptions& options,
             const std::string& what, bool may_be_singular, SteadyTally& tally) {
  if (state.status == SteadyStatus::singular) {
    ++tally.singular;
    EXPECT_TRUE(may_be_singular) << what;
    return;
  }
  if (!std::isfinite(state.error_bound)) return;
  const Index most = (most_unknowns / system.num_modes() - 1) / 2;
  const Index H =
      std::min<Index>(most, std::max<Index>(state.num_harmonics + std::min<Index>(stiffness_harmonics(system), 40) + 12,
                                            system.load[0].num_harmonics() + 12));
  if (H < state.num_harmonics) return;
  const reference::Response exact = reference::dense_harmonic_balance(system, speed, H);
  const long double largest = exact.cosine.cwiseAbs().maxCoeff() + exact.sine.cwiseAbs().maxCoeff();
  const long double tail = (exact.cosine.rightCols(6).cwiseAbs() + exact.sine.rightCols(6).cwiseAbs()).maxCoeff();
  const auto doubt = static_cast<double>(20 * tail / largest + exact.change * 10);
  ++tally.solved;
  if (!(doubt <= 0.1 * state.error_bound)) {
    ++tally.unsettled;
    return;
  }
  const double error = reference::true_error(state.q, exact);
  if (state.status == SteadyStatus::converged) ++tally.reached;
  if (state.bound == SteadyBound::proved) ++tally.proved;
  tally.closest = std::max(tally.closest, (error - doubt) / state.error_bound);
  if (!(error <= state.error_bound + doubt)) ++tally.uncovered;
  EXPECT_LE(error, state.error_bound + doubt)
      << what << ", asked " << options.tolerance << ", H " << state.num_harmonics << ", resonance "
      << state.resonance_distance << ", " << (state.method == SteadyMethod::direct ? "direct" : "iterative");
  if (state.status == SteadyStatus::converged) {
    EXPECT_LE(state.error_bound, options.tolerance) << what;
  }
}

void run(stress::Family family, int trials, bool resonant) {
  SteadyTally tally;
  for (int trial = 0; trial < stress::multiplied(trials); ++trial) {
    stress::Random random(stress::seed() * 1000003 + std::uint64_t(trial) * 101 + std::uint64_t(family) +
                          (resonant ? 50 : 0));
    stress::Trial t = stress::random_trial(family, random, random.chance(0.1) ? 8 : 4);
    add_load(t.system, random);
    if (t.system.load[0].c.isZero(0)) continue;
    if (resonant) bring_to_resonance(t, random);
    SteadyOptions options;
    options.tolerance = random.power(-13.5, -2);
    for (const SteadyMethod method : {SteadyMethod::automatic, SteadyMethod::direct, SteadyMethod::iterative}) {
      options.method = method;
      compare(solve_steady_state(t.system, t.speed, options), t.system, t.speed, options,
              "family " + std::to_string(int(family)) + " trial " + std::to_string(trial) + " I " +
                  std::to_string(t.system.num_modes()) + " method " + std::to_string(int(method)),
              resonant || family == stress::Family::undamped, tally);
    }
    if (trial % 3 == 0 && t.system.num_modes() <= 3) {
      options.method = SteadyMethod::automatic;
      options.bound = SteadyBound::proved;
      compare(solve_steady_state(t.system, t.speed, options), t.system, t.speed, options,
              "family " + std::to_string(int(family)) + " trial " + std::to_string(trial) + " with a proof",
              resonant || family == stress::Family::undamped, tally);
    }
  }
  std::printf(
      "family %2d%s: %d solved, %d reached the tolerance, %d with a proved bound, %d singular, %d bounds below the "
      "error, %d beyond the "
      "reference, largest error/bound %.2g\n",
      int(family), resonant ? " at resonance" : "", tally.solved, tally.reached, tally.proved, tally.singular,
      tally.uncovered, tally.unsettled, tally.closest);
}

// One or two modes of which the last is within 0.3 of harmonic n = 2..8 with damping down to 1e-7, coupled within a
// harmonic too, by gyroscopic terms or a constant part; loads of the first harmonics, faint ones up to beyond n.
HillSystem resonant_at(Index n, stress::Random& random) {
  const Index I = random.integer(1, 2), P = random.integer(1, 3), F = random.chance(0.3) ? n + 2 : random.integer(0, 3);
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = Eigen::MatrixXd::Zero(I, I);
  system.stiffness[0] = FourierSeries(I * I, P);
  system.load[0] = FourierSeries(I, F);
  const double coupling = random.power(-3, 0.3);
  for (Index i = 0; i < I; ++i) {
    const double off = random.power(-6, -0.5) * (random.chance(0.5) ? 1 : -1);
    const double w = i == I - 1 ? double(n) + off : random(0.3, double(n) + 2);
    system.stiffness[0].c(i + I * i, 0) = w * w;
    system.damping(i, i) = random.power(-7, -2);
    for (Index k = 1; k <= P; ++k)
      for (Index j = 0; j <= i; ++j)
        if (random.chance(0.7))
          system.stiffness[0].c(i + I * j, k) = system.stiffness[0].c(j + I * i, k) = coupling * random(-1, 1);
    for (Index k = 0; k <= F; ++k) system.load[0].c(i, k) = random(-1, 1) * random.power(k > 3 ? -12 : -3, 0);
  }
  if (I == 2 && random.chance(0.3)) {
    const double gyroscopic = random.power(-3, 0.3);
    system.damping(0, 1) += gyroscopic;
    system.damping(1, 0) -= gyroscopic;
  }
  if (I == 2 && random.chance(0.3))
    system.stiffness[0].c(1, 0) = system.stiffness[0].c(2, 0) =
        random(-0.9, 0.9) * std::sqrt(std::abs(system.stiffness[0].c(0, 0) * system.stiffness[0].c(3, 0)));
  return system;
}

// Tolerances that fewer harmonics than n serve, and windows of fewer or few more that were asked for.
TEST(SteadyWindow, BoundsCoverResonancesBeyond) {
  SteadyTally tally;
  for (int trial = 0; trial < stress::multiplied(300); ++trial) {
    stress::Random random(stress::seed() * 1000003 + std::uint64_t(trial) * 101 + 77);
    const Index n = random.integer(2, 8);
    const HillSystem system = resonant_at(n, random);
    SteadyOptions options;
    options.tolerance = random.power(-7, -2);
    const std::string what = "trial " + std::to_string(trial) + " n " + std::to_string(n);
    compare(solve_steady_state(system, 1, options), system, 1, options, what, false, tally);
    options.num_harmonics = int(n + random.integer(-1, 2));
    compare(solve_steady_state(system, 1, options), system, 1, options, what + " asked for harmonics", false, tally);
  }
  EXPECT_GT(tally.reached, stress::multiplied(300));
  std::printf("%d solved, %d reached the tolerance, %d beyond the reference, largest error/bound %.2g\n", tally.solved,
              tally.reached, tally.unsettled, tally.closest);
}

class SteadyStress : public testing::TestWithParam<int> {};

TEST_P(SteadyStress, EveryBoundCovers) { run(static_cast<stress::Family>(GetParam()), 4, false); }

TEST_P(SteadyStress, EveryBoundCoversAtResonance) { run(static_cast<stress::Family>(GetParam()), 3, true); }

INSTANTIATE_TEST_SUITE_P(Families, SteadyStress, testing::Range(0, stress::num_families));

}  // namespace
}  // namespace hb
