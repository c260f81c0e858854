// Verdicts: the order of their badness, what decides `bounded`, lower and upper errors apart.
#include "hb/engine/exponents/verdict.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "hb/engine/exponents/imaginary_axis.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "lib/rod/rod.hpp"
#include "tests/support/random_hill_system.hpp"
#include "tests/support/six_link.hpp"

namespace hb {
namespace {

using cplx = std::complex<double>;

HillSystem oscillators(const Eigen::MatrixXd& damping, const Eigen::MatrixXd& mean, const Eigen::MatrixXcd& first) {
  HillSystem system;
  const Eigen::Index I = mean.rows();
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = damping;
  system.stiffness[0] = FourierSeries(I * I, 1);
  system.stiffness[0].c.col(0) = mean.reshaped().cast<cplx>();
  system.stiffness[0].c.col(1) = first.reshaped();
  return system;
}

const Eigen::Matrix2d mean_stiffness = (Eigen::Matrix2d() << 1.3, 0.1, 0.1, 5.1).finished();
const Eigen::Matrix2cd modulation = (Eigen::Matrix2cd() << 0.1, 0.05, 0.05, cplx(0.2, 0.1)).finished();

// At the edge of an undamped tongue one growing exponent was found from both modes, its mirror image from neither, and
// the verdict was `bounded`.
TEST(Verdict, AnExponentFoundTwiceDoesNotLieOnTheImaginaryAxis) {
  const std::array<cplx, 2> twice = {cplx(3e-7, 0.3), cplx(3.1e-7, 0.3)}, apart = {cplx(0, 0.3), cplx(1e-9, 0.4)};
  const std::array<double, 2> error = {1.6e-7, 2e-9};
  EXPECT_FALSE(images_apart(twice, error, 1));
  EXPECT_TRUE(images_apart(apart, error, 1));
}

TEST(Verdict, TheWorstIsUnstableThenUndecidedThenBoundedThenStable) {
  using enum Verdict;
  EXPECT_EQ(worst(std::array{stable, bounded, undecided, unstable}), unstable);
  EXPECT_EQ(worst(std::array{undecided, bounded, stable}), undecided);
  EXPECT_EQ(worst(std::array{stable, bounded, stable}), bounded);
  EXPECT_EQ(worst(std::array{stable, stable}), stable);
  EXPECT_EQ(worst(unstable, undecided), unstable);
  EXPECT_EQ(verdict_of(NAN, NAN), undecided);
}

TEST(Verdict, CoupledModesWithoutDampingAreBoundedGyroscopicOnesToo) {
  for (const double gyroscopic : {0.0, 0.4}) {
    const Eigen::Matrix2d B = (Eigen::Matrix2d() << 0, gyroscopic, -gyroscopic, 0).finished();
    for (const bool leading_only : {false, true}) {
      const Stability result =
          analyse_stability(oscillators(B, mean_stiffness, modulation), 0.83, {.leading_only = leading_only});
      EXPECT_EQ(result.verdict, Verdict::bounded) << gyroscopic;
      EXPECT_EQ(result.growth_rate, 0);
      EXPECT_EQ(result.exponents.size(), 4u);
      for (const Exponent& e : result.exponents) EXPECT_LE(e.error, 1e-11);
    }
  }
}

// 1e-13 of damping is damping, 1e-13 of asymmetry is none of Hamilton's systems.
TEST(Verdict, TheSlightestDampingOrAsymmetryIsNotBounded) {
  Eigen::Matrix2d B = Eigen::Matrix2d::Zero();
  B(0, 0) = 1e-13;
  EXPECT_NE(analyse_stability(oscillators(B, mean_stiffness, modulation), 0.83).verdict, Verdict::bounded);
  B(0, 0) = 0;
  B(0, 1) = 1e-13;
  EXPECT_NE(analyse_stability(oscillators(B, mean_stiffness, modulation), 0.83).verdict, Verdict::bounded);
  Eigen::Matrix2cd unsymmetric = modulation;
  unsymmetric(0, 1) += 1e-15;
  EXPECT_NE(analyse_stability(oscillators(Eigen::Matrix2d::Zero(), mean_stiffness, unsymmetric), 0.83).verdict,
            Verdict::bounded);
}

TEST(Verdict, ExponentsThatMeetAreNotBounded) {
  // Equal modes coupled one way: exponents on the axis, motion that grows like t.
  HillSystem system = oscillators(Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Identity() * 1.3, Eigen::Matrix2cd::Zero());
  system.stiffness[0].c(2, 0) = 0.5;
  EXPECT_EQ(analyse_stability(system, 0.83).verdict, Verdict::undecided);
  // The same in symmetric matrices of an indefinite mass.
  system.mass << 0, 1, 1, 0;
  system.stiffness[0].c.col(0) << 0.5, 1.3, 1.3, 0;
  EXPECT_EQ(analyse_stability(system, 0.83).verdict, Verdict::undecided);
  // Free in one direction: a double exponent at zero.
  HillSystem free;
  free.mass = Eigen::MatrixXd::Ones(1, 1);
  free.damping = Eigen::MatrixXd::Zero(1, 1);
  free.stiffness[0] = FourierSeries(1, 0);
  EXPECT_EQ(analyse_stability(free, 1).verdict, Verdict::undecided);
}

TEST(Verdict, EqualModesThatDoNotFeelEachOtherAreBounded) {
  const Eigen::Matrix2d twice = Eigen::Matrix2d::Identity() * 1.3;
  EXPECT_EQ(
      analyse_stability(oscillators(Eigen::Matrix2d::Zero(), twice, Eigen::Matrix2cd::Identity() * 0.1), 0.83).verdict,
      Verdict::bounded);
  EXPECT_EQ(analyse_stability(oscillators(Eigen::Matrix2d::Zero(), twice, Eigen::Matrix2cd::Zero()), 0.83).verdict,
            Verdict::bounded);
}

TEST(Verdict, InsideATongueWithoutDampingIsUnstable) {
  const HillSystem system = oscillators(Eigen::Matrix2d::Zero(), mean_stiffness, modulation);
  EXPECT_EQ(analyse_stability(system, 2 * std::sqrt(1.3)).verdict, Verdict::unstable);
}

TEST(Verdict, RodsWithoutDampingAreBoundedAtMostSpeeds) {
  const Linkage linkage = six_link::linkage({.J = 45});
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  int bounded = 0;
  for (double rpm = 310; rpm < 1500; rpm += 100) {
    HillSystem system = ritz_system(*body_at(linkage, coefficients.links[0]), coefficients.rods[0], 5);
    system.damping.setZero();
    const Stability result = analyse_stability(system, rpm * std::numbers::pi / 30);
    EXPECT_NE(result.verdict, Verdict::stable);
    bounded += result.verdict == Verdict::bounded;
  }
  EXPECT_GE(bounded, 10);
}

TEST(Verdict, RestsOnTheIntervalThatTheGrowthRateLiesIn) {
  stress::Random random(5);
  for (int trial = 0; trial < 40; ++trial) {
    const stress::Trial t = stress::random_trial(stress::Family(trial % 8), random, 3);
    const Stability s = analyse_stability(t.system, t.speed);
    EXPECT_LE(s.growth_low, s.growth_rate);
    EXPECT_LE(s.growth_rate, s.growth_high);
    if (std::isfinite(s.growth_error)) {
      EXPECT_EQ(s.growth_error, std::max(s.growth_high - s.growth_rate, s.growth_rate - s.growth_low));
    }
    if (s.verdict != Verdict::bounded) {
      EXPECT_EQ(s.verdict, verdict_of(s.growth_low, s.growth_high));
    }
  }
}

TEST(Verdict, MultipliersAreThoseOfATurn) {
  const Exponent e{.value = {std::log(2.0) / (2 * std::numbers::pi), 0.25}};
  EXPECT_NEAR(std::abs(e.multiplier(1) - cplx(0, 2)), 0, 1e-14);
}

}  // namespace
}  // namespace hb
