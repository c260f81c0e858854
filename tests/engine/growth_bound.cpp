// The closed-form sufficient test never proves too much, and proves what damping dominates.
#include "hb/engine/exponents/growth_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hb/engine/exponents/stability.hpp"
#include "lib/rod/rod.hpp"
#include "tests/support/random_hill_system.hpp"
#include "tests/support/six_link.hpp"

namespace hb {
namespace {

TEST(GrowthBound, IsNeverBelowTheGrowthRate) {
  int finite = 0, proved = 0;
  for (int family = 0; family < stress::num_families; ++family)
    for (int trial = 0; trial < stress::multiplied(12); ++trial) {
      stress::Random random(std::uint64_t(trial * 100 + family) + stress::seed() * 7919);
      const stress::Trial t = stress::random_trial(static_cast<stress::Family>(family), random, 5);
      const double bound = t.speed * growth_bound(scale_system(t.system, t.speed));
      if (!std::isfinite(bound)) continue;
      ++finite;
      proved += bound < 0;
      const Stability truth = analyse_stability(t.system, t.speed);
      EXPECT_GE(bound, truth.growth_rate - truth.growth_error) << "family " << family << ", trial " << trial;
      if (bound < 0) {
        EXPECT_NE(truth.verdict, Verdict::unstable) << "family " << family << ", trial " << trial;
      }
    }
  EXPECT_GE(finite, stress::multiplied(30));
  EXPECT_GE(proved, stress::multiplied(10));
}

// Without coupling and with constant stiffness the bound is the growth rate.
TEST(GrowthBound, IsSharpForConstantCoefficients) {
  HillSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.damping = Eigen::Vector2d(0.1, 5).asDiagonal();
  system.stiffness[0] = FourierSeries(4, 0);
  system.stiffness[0].c << 1, 0, 0, 4;
  const double slow = -2.5 + std::sqrt(6.25 - 4);
  EXPECT_NEAR(growth_bound(scale_system(system, 1)), std::max(-0.05, slow), 1e-8);
}

// Share of the stable speeds of the six-link mechanism's rods, 5 modes, that is proved.
TEST(GrowthBound, ProvesMostStableSpeedsOfTheSixLinkMechanism) {
  for (const double J : {45.0, 4500.0}) {
    const Linkage linkage = six_link::linkage({.J = J});
    const LinkageCoefficients coefficients = linkage_coefficients(linkage);
    for (const std::size_t rod : {0u, 1u}) {
      const HillSystem system = ritz_system(*body_at(linkage, coefficients.links[rod]), coefficients.rods[rod], 5);
      int stable = 0, proved = 0;
      for (double rpm = 200; rpm <= 6000; rpm += 40) {
        const double Omega = rpm * std::numbers::pi / 30;
        const Stability truth = analyse_stability(system, Omega, {.leading_only = true});
        const Stability bound = analyse_stability(system, Omega, {.method = StabilityMethod::bound});
        EXPECT_LE(std::abs(bound.growth_rate - truth.growth_rate), bound.growth_error + truth.growth_error) << rpm;
        EXPECT_NE(bound.verdict, Verdict::unstable);
        if (truth.verdict != Verdict::stable) {
          EXPECT_EQ(bound.verdict, Verdict::undecided) << rpm;
          continue;
        }
        ++stable;
        proved += bound.verdict == Verdict::stable;
      }
      EXPECT_GE(proved, (J > 1000 ? 1.0 : 0.75) * stable) << "J " << J << ", rod " << rod;
    }
  }
}

TEST(GrowthBound, VerdictAloneTakesItWhereItProvesAndExponentsElsewhere) {
  const Linkage linkage = six_link::linkage({.J = 45});
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const HillSystem system = ritz_system(*body_at(linkage, coefficients.links[0]), coefficients.rods[0], 5);
  for (const auto& [rpm, method_is_bound] : {std::pair{300.0, true}, std::pair{2400.0, false}}) {
    const double Omega = rpm * std::numbers::pi / 30;
    const Stability verdict = analyse_stability(system, Omega, {.verdict_only = true});
    const Stability full = analyse_stability(system, Omega);
    EXPECT_EQ(verdict.verdict, full.verdict);
    EXPECT_EQ(verdict.method == StabilityMethod::bound, method_is_bound) << rpm;
    EXPECT_EQ(verdict.exponents.empty(), method_is_bound);
  }
}

}  // namespace
}  // namespace hb
