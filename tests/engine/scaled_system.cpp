#include "hb/engine/system/scaled_system.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
