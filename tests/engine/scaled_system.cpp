#include "hb/engine/system/scaled_system.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hb/engine/boundaries/mean_exponents.hpp"
#include "hb/engine/exponents/stability.hpp"

namespace hb {
namespace {

HillSystem full_system() {
  HillSystem s;
  s.mass.resize(2, 2);
  s.mass << 2, 0.3, 0.3, 1;
  s.damping.resize(2, 2);
  s.damping << 0.2, 0.01, -0.02, 0.1;
  s.stiffness[0] = FourierSeries(4, 1);
  s.stiffness[0].c.col(0) << 5, 0.4, 0.4, 9;
  s.stiffness[0].c.col(1) << std::complex<double>(0.2, 0.1), 0.1, 0.1, std::complex<double>(0, -0.3);
  s.stiffness[2] = FourierSeries(4, 0);
  s.stiffness[2].c.col(0) << -0.1, 0, 0, 0.2;
  s.load[1] = FourierSeries(2, 2);
  s.load[1].c.col(2) << 3, std::complex<double>(0, 1);
  return s;
}

// What the coefficients are given wrong by is in the errors of constant ones, too.
TEST(ScaledSystem, ErrorsOfGivenCoefficientsAreInThoseOfExponents) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Constant(1, 1, 4);
  system.damping = Eigen::MatrixXd::Constant(1, 1, 0.4);
  system.stiffness[0] = FourierSeries(1, 0);
  system.stiffness[0].c(0, 0) = 9;
  const double speed = 0.7, wrong_b = 1e-6, wrong_c = 1e-5;
  const GivenErrors given{Eigen::MatrixXd::Constant(1, 1, wrong_b), Eigen::MatrixXd::Constant(1, 1, wrong_c)};
  const Stability exact = analyse_stability(scale_system(system, speed), {});
  const Stability found = analyse_stability(scale_system(system, speed, given), {});
  EXPECT_EQ(found.growth_rate, exact.growth_rate);
  system.damping(0, 0) += wrong_b;
  system.stiffness[0].c(0, 0) += wrong_c;
  const Stability moved = analyse_stability(scale_system(system, speed), {});
  ASSERT_EQ(found.exponents.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const double change = std::abs(moved.exponents[i].value - exact.exponents[i].value);
    EXPECT_LT(exact.exponents[i].error, 0.1 * change);
    EXPECT_GE(found.exponents[i].error, change);
    EXPECT_LT(found.exponents[i].error, 3 * change);
  }
}

struct Mode {
  double modulation, stiffness = 3.3, damping = 0.31, mass = 2.7, load = 1;
};

// `count` times the same mode, none coupled to another.
HillSystem equal_modes(Eigen::Index count, const Mode& mode) {
  const auto [modulation, stiffness, damping, mass, load] = mode;
  HillSystem s;
  s.mass = mass * Eigen::MatrixXd::Identity(count, count);
  s.damping = damping * Eigen::MatrixXd::Identity(count, count);
  s.stiffness[0] = FourierSeries(count * count, 4);
  s.stiffness[1] = FourierSeries(count * count, 1);
  s.load[1] = FourierSeries(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index own = i * (count + 1);
    s.stiffness[0].c(own, 0) = stiffness;
    s.stiffness[0].c(own, 2) = {0.1 * modulation, 0.7 * modulation};
    s.stiffness[0].c(own, 4) = 1e-18 * std::abs(stiffness);  // below rounding
    s.stiffness[1].c(own, 1) = {0.3 * modulation, 0};
    s.load[1].c.row(i) << 0.2 * load, load * std::complex<double>(3, 1), std::complex<double>(0, 1e-3 * load);
  }
  return s;
}

// One mode alone is scaled by formulas of its own.
TEST(ScaledSystem, OneModeIsScaledAsBesideAnother) {
  const GivenErrors given{Eigen::MatrixXd::Constant(1, 1, 1e-9), Eigen::MatrixXd::Constant(1, 1, 1e-8)};
  const GivenErrors given_both{1e-9 * Eigen::Matrix2d::Identity(), 1e-8 * Eigen::Matrix2d::Identity()};
  for (const Mode& mode : {Mode{1}, Mode{0}, Mode{1, -3.3}, Mode{0.3, 0, -0.2}, Mode{1, 3.3, 0.31, 1},
                           Mode{1e200, 3.3e200, 0.31e200, 2.7e200}, Mode{1e-200, 3.3e-200, 0.31e-200, 2.7e-200},
                           Mode{1, 3.3, 0.31, 2.7, 1e200}, Mode{1, 3.3, 0.31, 2.7, 1e-200}})
    for (const double speed : {1.3, 2.0}) {
      SCOPED_TRACE(testing::Message() << mode.modulation << " " << mode.stiffness << " " << mode.load << " " << speed);
      const ScaledSystem one = scale_system(equal_modes(1, mode), speed, given);
      const ScaledSystem two = scale_system(equal_modes(2, mode), speed, given_both);
      EXPECT_EQ(one.speed, two.speed);
      EXPECT_DOUBLE_EQ(one.T(0, 0), two.T(0, 0));
      EXPECT_DOUBLE_EQ(one.T_inverse(0, 0), two.T_inverse(0, 0));
      EXPECT_DOUBLE_EQ(one.G(0, 0), two.G(0, 0));
      EXPECT_DOUBLE_EQ(one.K_rounding(0, 0), two.K_rounding(0, 0));
      EXPECT_DOUBLE_EQ(one.f_rounding(0), two.f_rounding(0));
      EXPECT_DOUBLE_EQ(one.G_error(0, 0), two.G_error(0, 0));
      EXPECT_DOUBLE_EQ(one.load_scale, two.load_scale);
      EXPECT_EQ(one.diagonal_damping, two.diagonal_damping);
      EXPECT_EQ(one.conservative(0), two.conservative(0));
      ASSERT_EQ(one.K.c.cols(), two.K.c.cols());
      EXPECT_LE((one.K.c.row(0) - two.K.c.row(0)).norm(), 1e-15 * one.K.c.norm());
      ASSERT_EQ(one.f.c.cols(), two.f.c.cols());
      EXPECT_LE((one.f.c.row(0) - two.f.c.row(0)).norm(), 1e-15 * one.f.c.norm());
    }
}

TEST(ScaledSystem, OneModeHasItsMeanExponentsBesideAnother) {
  // Critical damping last.
  for (const Mode& mode :
       {Mode{0}, Mode{0.01}, Mode{0.1}, Mode{10}, Mode{0.1, -3.3}, Mode{0.1, 0.04, 3}, Mode{0.01, 1, 2, 1}}) {
    SCOPED_TRACE(testing::Message() << mode.modulation << " " << mode.stiffness);
    const auto one = mean_exponents(scale_system(equal_modes(1, mode), 1.3));
    const auto two = mean_exponents(scale_system(equal_modes(2, mode), 1.3));
    ASSERT_EQ(one.size(), 2u);
    ASSERT_EQ(two.size(), 4u);
    for (std::size_t i = 0; i < one.size(); ++i) {
      const MeanExponent &a = one[i], &b = two[2 * i];
      EXPECT_LT(std::abs(a.value - b.value), 1e-15);
      EXPECT_NEAR(a.modulation, b.modulation, 1e-14 * b.modulation);
      EXPECT_EQ(a.drift, 0);
      if (std::isinf(b.coupling))
        EXPECT_EQ(a.coupling, b.coupling);
      else
        EXPECT_NEAR(a.coupling, b.coupling, 1e-14 * b.coupling);
    }
  }
}

// M q'' + B q' + C q - h with q = load_scale T x must be Omega^2 load_scale M T (x'' + G x' + K x - f) for any x.
TEST(ScaledSystem, IsTheSystemInOtherCoordinates) {
  const HillSystem system = full_system();
  const double Omega = 1.7, tau = 0.6;
  const ScaledSystem scaled = scale_system(system, Omega);
  const Eigen::Vector2d x(0.4, -1.1), x1(0.3, 0.8), x2(-0.7, 0.2);
  const Eigen::VectorXd K = fourier::evaluate(scaled.K, tau), C = fourier::evaluate(stiffness_at(system, Omega), tau);
  const Eigen::VectorXd r =
      x2 + scaled.G * x1 + Eigen::Map<const Eigen::MatrixXd>(K.data(), 2, 2) * x - fourier::evaluate(scaled.f, tau);
  const Eigen::MatrixXd T = scaled.load_scale * scaled.T;
  const Eigen::VectorXd given = Omega * Omega * system.mass * T * x2 + Omega * system.damping * T * x1 +
                                Eigen::Map<const Eigen::MatrixXd>(C.data(), 2, 2) * T * x -
                                fourier::evaluate(load_at(system, Omega), tau);
  const Eigen::VectorXd expected = Omega * Omega * system.mass * T * r;
  EXPECT_LE((given - expected).norm(), 1e-13 * given.norm());
}

TEST(ScaledSystem, DiagonalMassKeepsCoordinates) {
  HillSystem system = full_system();
  system.mass(0, 1) = system.mass(1, 0) = 0;
  system.damping(0, 1) = system.damping(1, 0) = 0;
  system.stiffness[0].c(1, 0) = system.stiffness[0].c(2, 0) = 0;
  const ScaledSystem scaled = scale_system(system, 2);
  EXPECT_TRUE(scaled.diagonal_damping);
  EXPECT_EQ(scaled.T(0, 1), 0);
  EXPECT_DOUBLE_EQ(scaled.T(0, 0), 1 / std::sqrt(2.0));
}

TEST(ScaledSystem, RoundingAllowanceSeesCancellationBetweenPowersOfSpeed) {
  HillSystem system = full_system();
  const double before = scale_system(system, 1).K_rounding(0, 0);
  system.stiffness[0].c(0, 0) += 1e8;
  system.stiffness[2].c(0, 0) -= 1e8;
  EXPECT_GE(scale_system(system, 1).K_rounding(0, 0), 1e6 * before);
}

// A mode 1e16 times as stiff as the others cut their harmonics off at 1e-9 of themselves, with an error bound of 1e-14.
TEST(ScaledSystem, AStiffModeDoesNotCutTheHarmonicsOfTheOthers) {
  HillSystem system = full_system();
  system.mass = Eigen::Matrix2d::Identity();
  system.stiffness[0] = FourierSeries(4, 3);
  system.stiffness[0].c.col(0) << 2, 0, 0, 1e16;
  system.stiffness[0].c.col(3) << 1e-12, 0, 0, 0;
  EXPECT_EQ(scale_system(system, 1).K.num_harmonics(), 3);
  system.stiffness[0].c.col(3) << 1e-18, 0, 0, 1e-3;
  EXPECT_EQ(scale_system(system, 1).K.num_harmonics(), 0);
}

TEST(ScaledSystem, NoLoadHasScaleZero) {
  HillSystem system = full_system();
  system.load[1] = FourierSeries();
  EXPECT_EQ(scale_system(system, 1).load_scale, 0);
}

TEST(ScaledSystem, SpeedMustBePositiveAndFinite) {
  for (const double speed : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW((void)scale_system(full_system(), speed), std::invalid_argument);
}

}  // namespace
}  // namespace hb
