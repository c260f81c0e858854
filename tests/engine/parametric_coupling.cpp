// The estimate from above of what excites two exponents, hb/engine/README.md (B4), against growth rates of the whole
// system.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hb/engine/boundaries/boundary.hpp"
#include "hb/engine/boundaries/mean_exponents.hpp"

namespace {

using namespace hb;

// Largest growth per radian over the speeds, and the decay of the two that meet added.
double excitement(const HillSystem& system, double from, double to, double decay) {
  constexpr int looks = 400;
  double most = -HUGE_VAL;
  for (int k = 0; k <= looks; ++k) {
    const double speed = from + (to - from) * k / looks;
    most = std::max(most, analyse_stability(system, speed).growth_rate / speed);
  }
  return most + decay;
}

HillSystem one_mode(double mean, double damping, int harmonic, double amplitude) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Ones(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, damping);
  system.stiffness[0] = FourierSeries(1, harmonic);
  system.stiffness[0].c(0, 0) = mean;
  system.stiffness[0].c(0, 1) = 1e-6;
  system.stiffness[0].c(0, harmonic) = amplitude;
  return system;
}

TEST(ParametricCoupling, CoversATongueOfHighOrder) {
  // By the harmonic of that order itself, as far as orders are looked at and not beyond.
  for (const int order : {40, 150, 400}) {
    const HillSystem system = one_mode(1, 1e-5, order, 0.05);
    const double centre = 2.0 / order;
    const double truth = excitement(system, 0.99 * centre, 1.01 * centre, 0.5e-5 / centre);
    EXPECT_GT(truth, 0.25) << order;
    const double told = ParametricCoupling(scale_system(system, centre), order)(0, 1, order);
    EXPECT_GE(told, truth) << order;
    EXPECT_LE(told, 10 * truth) << order;
    EXPECT_EQ(ParametricCoupling(scale_system(system, centre), order - 1)(0, 1, order), 0) << order;
  }
}

// No harmonic has the order itself: two of them add up to it.
TEST(ParametricCoupling, CoversATongueOfHighOrderWhereHarmonicsAddUpToIt) {
  for (const int order : {40, 120, 300}) {
    const HillSystem system = one_mode(1, 1e-6, order / 2, 0.1);
    const double centre = 2.0 / order;
    const double truth = excitement(system, 0.97 * centre, 1.01 * centre, 0.5e-6 / centre);
    EXPECT_GT(truth, 0.02) << order;
    const double told = ParametricCoupling(scale_system(system, centre), order)(0, 1, order);
    EXPECT_GE(told, truth) << order;
    EXPECT_LE(told, 30 * truth) << order;
  }
}

// Modes 1 and 2 meet by order 4; neither harmonic couples them, but each is coupled to mode 3, with which mode 2 is
// nearly in resonance itself.
TEST(ParametricCoupling, CoversAWayThroughANearlyResonantExponent) {
  constexpr double w1 = 3.354, w2 = 0.646, w3 = 1.35, damping = 1e-7;
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(3, 3);
  system.damping = damping * Eigen::MatrixXd::Identity(3, 3);
  FourierSeries& K = system.stiffness[0] = FourierSeries(9, 2);
  K.c.col(0) << w1 * w1, 0, 0, 0, w2 * w2, 0, 0, 0, w3 * w3;
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  second(0, 2) = second(2, 0) = second(1, 2) = second(2, 1) = 2.5e-4;
  K.c.col(2) = second.reshaped().cast<std::complex<double>>();
  const double centre = (w1 + w2) / 4;
  const double truth = excitement(system, 0.99999 * centre, 1.00001 * centre, damping / 2);
  EXPECT_GT(truth, 1e-6);
  const ParametricCoupling coupling(scale_system(system, centre), SweepOptions().max_order);
  // Imaginary parts ascending: -w1, -w3, -w2, w2, w3, w1.
  EXPECT_GE(coupling(0, 3, 4), truth);
}

}  // namespace
