// Verdicts and exponents of random systems against a long double reference: no wrong verdict, no uncovered bar.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "hb/engine/exponents/stability.hpp"
#include "tests/support/long_double_floquet.hpp"
#include "tests/support/random_hill_system.hpp"

namespace hb {
namespace {

using reference::FloquetExponent;

double distance(std::complex<double> a, reference::Complex b, double Omega) {
  reference::Real turn = std::fmod(std::abs(reference::Real(a.imag()) - b.imag()), reference::Real(Omega));
  turn = std::min(turn, reference::Real(Omega) - turn);
  return double(std::hypot(reference::Real(a.real()) - b.real(), turn));
}

struct Tally {
  int verdicts = 0, undecided = 0, wrong = 0, uncovered = 0, unsettled = 0;
  double clearance = 0;  // largest error/bar
};

// Compares one result with the reference; `leading_only` results list fewer exponents.
void compare(const Stability& result, const std::vector<FloquetExponent>& exact, double Omega, const std::string& what,
             Tally& tally) {
  ++tally.verdicts;
  const double growth = double(exact.front().value.real()), known = double(exact.front().error);
  if (!(known <= 1e-7 * Omega)) {
    ++tally.unsettled;
    return;
  }
  if (result.verdict == Verdict::undecided) ++tally.undecided;
  const bool wrong =
      (result.verdict == Verdict::stable && growth > known) || (result.verdict == Verdict::unstable && growth < -known);
  if (wrong) ++tally.wrong;
  EXPECT_FALSE(wrong) << what << ": " << to_string(result.verdict) << ", growth is " << growth << " +- " << known
                      << ", said " << result.growth_rate << " +- " << result.growth_error << "; " << result.evidence;
  const double error = std::abs(double(reference::Real(result.growth_rate) - exact.front().value.real()));
  if (std::isfinite(result.growth_error))
    tally.clearance = std::max(tally.clearance, (error - known) / result.growth_error);
  const bool covered = error <= result.growth_error + known;
  if (!covered) ++tally.uncovered;
  EXPECT_TRUE(covered) << what << ": growth is " << growth << " +- " << known << ", said " << result.growth_rate
                       << " +- " << result.growth_error << ", off by " << error << "; " << result.evidence;
  for (const Exponent& e : result.exponents) {
    if (e.value.real() + e.error < double(exact.back().value.real()) + 0.1 * Omega) continue;  // lost in the reference
    double nearest = HUGE_VAL;
    for (const FloquetExponent& x : exact)
      nearest = std::min(nearest, distance(e.value, x.value, Omega) - double(x.error));
    if (!(nearest <= e.error)) ++tally.uncovered;
    EXPECT_LE(nearest, e.error) << what << ": exponent " << e.value << " of mode " << e.mode << "; " << result.evidence;
  }
}

void run_trial(stress::Family family, std::uint64_t seed, int trial, Tally& tally) {
  stress::Random random(seed * 1000003 + std::uint64_t(trial) * 101 + std::uint64_t(family));
  const stress::Trial t = stress::random_trial(family, random, trial % 20 == 19 ? 20 : 4);
  const std::vector<FloquetExponent> exact = reference::floquet_exponents(t.system, t.speed);
  for (const bool leading_only : {false, true}) {
    const Stability result = analyse_stability(t.system, t.speed, {.leading_only = leading_only});
    compare(result, exact, t.speed,
            "family " + std::to_string(int(family)) + " trial " + std::to_string(trial) + " I " +
                std::to_string(t.system.num_modes()) + (leading_only ? " leading" : ""),
            tally);
  }
}

void run(stress::Family family, int trials) {
  Tally tally;
  for (int trial = 0; trial < stress::multiplied(trials); ++trial) run_trial(family, stress::seed(), trial, tally);
  std::printf(
      "family %2d: %d verdicts, %d undecided, %d wrong, %d bars uncovered, %d beyond the reference, "
      "largest error/bar %.2g\n",
      int(family), tally.verdicts, tally.undecided, tally.wrong, tally.uncovered, tally.unsettled, tally.clearance);
}

// The frequency domain against the same reference; its windows limit it to moderate frequencies.
void run_hill_trial(stress::Family family, std::uint64_t seed, int trial, Tally& tally) {
  stress::Random random(seed * 1000003 + std::uint64_t(trial) * 101 + std::uint64_t(family) + 60);
  const stress::Trial t = stress::random_trial(family, random, 2);
  compare(analyse_stability(t.system, t.speed, {.method = StabilityMethod::hill}),
          reference::floquet_exponents(t.system, t.speed), t.speed,
          "family " + std::to_string(int(family)) + " trial " + std::to_string(trial) + " by Hill", tally);
}

void run_hill(stress::Family family, int trials) {
  Tally tally;
  for (int trial = 0; trial < stress::multiplied(trials); ++trial) run_hill_trial(family, stress::seed(), trial, tally);
  std::printf("family %2d by Hill: %d verdicts, %d undecided, %d wrong, %d bars uncovered, largest error/bar %.2g\n",
              int(family), tally.verdicts, tally.undecided, tally.wrong, tally.uncovered, tally.clearance);
}

// Begun with what slaving came to at a neighbouring speed, with that of other modes, and with noise on it: that may
// take more time or less, and never leads elsewhere.
void run_begun_trial(stress::Family family, std::uint64_t seed, int trial, Tally& tally) {
  stress::Random random(seed * 1000003 + std::uint64_t(trial) * 101 + std::uint64_t(family) + 30);
  const stress::Trial t = stress::random_trial(family, random, 4);
  const std::vector<FloquetExponent> exact = reference::floquet_exponents(t.system, t.speed);
  const double beside = t.speed * (1 + random.power(-5, -1));
  std::vector<SlavingStart> starts = analyse_stability(t.system, beside, {.keeps_solved = true}).solved;
  const auto look = [&](const char* what) {
    compare(analyse_stability(t.system, t.speed, {.starts = starts}), exact, t.speed,
            "family " + std::to_string(int(family)) + " trial " + std::to_string(trial) + " begun " + what, tally);
  };
  look("beside");
  if (starts.empty()) return;
  std::ranges::rotate(starts, starts.begin() + 1);
  look("with other modes");
  for (SlavingStart& start : starts)
    for (double& number : start.solution) number += random(-0.1, 0.1);
  look("with noise");
  for (SlavingStart& start : starts) start.rough = true;
  look("roughly");
}

void run_begun(stress::Family family, int trials) {
  Tally tally;
  for (int trial = 0; trial < stress::multiplied(trials); ++trial)
    run_begun_trial(family, stress::seed(), trial, tally);
  std::printf("family %2d begun: %d verdicts, %d undecided, %d wrong, %d bars uncovered, largest error/bar %.2g\n",
              int(family), tally.verdicts, tally.undecided, tally.wrong, tally.uncovered, tally.clearance);
}

class StabilityStress : public testing::TestWithParam<int> {};

TEST_P(StabilityStress, NoVerdictIsWrongAndEveryBarCovers) {
  const auto family = static_cast<stress::Family>(GetParam());
  run(family, family == stress::Family::fast ? 1 : 4);
}

INSTANTIATE_TEST_SUITE_P(Families, StabilityStress, testing::Range(0, stress::num_families));

class BegunStress : public testing::TestWithParam<int> {};

TEST_P(BegunStress, NoVerdictIsWrongAndEveryBarCovers) { run_begun(static_cast<stress::Family>(GetParam()), 2); }

INSTANTIATE_TEST_SUITE_P(Families, BegunStress, testing::Range(0, stress::num_families));

class HillStress : public testing::TestWithParam<int> {};

TEST_P(HillStress, NoVerdictIsWrongAndEveryBarCovers) { run_hill(static_cast<stress::Family>(GetParam()), 3); }

// A reduction that goes on with more samples while the damping couples: the equations it is tested by are implicit.
TEST(StabilityBars, CoupledDampingWithMoreSamples) {
  Tally tally;
  run_trial(stress::Family::unsymmetric, 5020, 4, tally);
  run_trial(stress::Family::unsymmetric, 5002, 7, tally);
  EXPECT_EQ(tally.uncovered, 0);
  EXPECT_EQ(tally.unsettled, 0);
}

// Modulation beyond the mean: rows just outside a window are not dominated by their diagonal.
TEST(StabilityBars, HillWindowUnderStrongModulation) {
  Tally tally;
  run_hill_trial(stress::Family::strong, 3032, 5, tally);
  EXPECT_EQ(tally.uncovered, 0);
  EXPECT_EQ(tally.unsettled, 0);
}

// A hundredth of the coupling in harmonic 42, whose square, harmonic 84, would fold back onto a resonance of 128
// samples.
TEST(StabilityBars, WeakHighHarmonicFoldsBack) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(2, 2);
  system.damping = 1e-9 * system.mass;
  system.stiffness[0] = FourierSeries(4, 42);
  const double w1 = 22.0604193408155, w2 = 2.13 * 42;
  system.stiffness[0].c.col(0) << w1 * w1, 0, 0, w2 * w2;
  system.stiffness[0].c.col(1) << 0, 100, 100, 0;
  system.stiffness[0].c.col(42) << 0, 0.99, 0.99, 0;
  const std::vector<FloquetExponent> exact = reference::floquet_exponents(system, 1);
  Tally tally;
  for (const StabilityMethod method : {StabilityMethod::automatic, StabilityMethod::slaving})
    for (const double tolerance : {1e-5, 1e-6, 1e-9})
      compare(analyse_stability(system, 1, {.tolerance = tolerance, .method = method}), exact, 1, to_string(method),
              tally);
  EXPECT_EQ(tally.wrong + tally.uncovered, 0);
  EXPECT_EQ(tally.unsettled, 0);
}

// A harmonic that is a multiple of two numbers of cells leaves nearly the same error with both.
TEST(StabilityBars, HarmonicThatIsAMultipleOfTheCells) {
  for (const int P : {16, 32}) {
    HillSystem system;
    system.mass = Eigen::MatrixXd::Ones(1, 1);
    system.damping = Eigen::MatrixXd::Constant(1, 1, 0.062752404990364871);
    system.stiffness[0] = FourierSeries(1, P);
    system.stiffness[0].c(0) = -0.89110830343395819;
    system.stiffness[0].c(1) = 1e-9;
    system.stiffness[0].c(P) = std::polar(0.014436744560169476, 4.1247034418087773);
    Tally tally;
    compare(analyse_stability(system, 1), reference::floquet_exponents(system, 1), 1, "P " + std::to_string(P), tally);
    EXPECT_EQ(tally.uncovered, 0);
    EXPECT_EQ(tally.unsettled, 0);
  }
}

// Newton's method from two modes goes to one exponent, another one is missed: what was found is not all.
TEST(StabilityBars, HillIterationsThatMeet) {
  Tally tally;
  run_hill_trial(stress::Family::strong, 8033, 5, tally);
  EXPECT_EQ(tally.uncovered, 0);
  EXPECT_EQ(tally.undecided, 1);
}

// Not those of hundreds of harmonics, whose dense windows are slow.
std::vector<int> families_of_few_harmonics() {
  std::vector<int> families;
  for (int k = 0; k < stress::num_families; ++k) {
    const auto family = static_cast<stress::Family>(k);
    if (family != stress::Family::many_harmonics && family != stress::Family::discontinuous &&
        family != stress::Family::fast)
      families.push_back(k);
  }
  return families;
}

INSTANTIATE_TEST_SUITE_P(Families, HillStress, testing::ValuesIn(families_of_few_harmonics()));

}  // namespace
}  // namespace hb
