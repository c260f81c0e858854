// Names of exponents under strong slow modulation: frequencies at each angle in turn, hb/engine/README.md (B13).
#include <gtest/gtest.h>

#include <cmath>

#include "hb/engine/boundaries/mean_exponents.hpp"
#include "hb/engine/boundaries/strands.hpp"

namespace {

using namespace hb;

// Three undamped modes of 12, 36 and 85 oscillations a turn at speed 1, their stiffness a series with the harmonics
// r^k.
HillSystem slowly_modulated(double depth, double r) {
  constexpr int harmonics = 20;
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(3, 3);
  system.damping = Eigen::MatrixXd::Zero(3, 3);
  FourierSeries& K = system.stiffness[0] = FourierSeries(9, harmonics);
  Eigen::Matrix3d mean = Eigen::Vector3d(144, 1296, 7225).asDiagonal(), shape;
  shape << 40, 25, 15, 25, 60, 30, 15, 30, 80;
  K.c.col(0) = mean.reshaped().cast<std::complex<double>>();
  for (int k = 1; k <= harmonics; ++k)
    K.c.col(k) = (depth * std::pow(r, k) * std::polar(1.0, 0.7 * k) * shape.reshaped()).eval();
  return system;
}

SystemAt along_speed(const HillSystem& system) {
  return [&system](double x) { return scale_system(system, x); };
}

TEST(FrozenFrequencies, NameEveryExponentOfStrongSlowModulation) {
  const HillSystem system = slowly_modulated(0.4, 0.7);
  for (const double speed : {1.0, 1.07, 1.13, 1.21}) {
    const std::optional<StabilitySample> sample = stability_sample(along_speed(system), speed, {.tolerance = 1e-10});
    ASSERT_EQ(sample->stability.exponents.size(), 6U) << speed;
    const Strands strands = strands_of(*sample, sample->mean);
    std::vector<bool> taken(6, false);
    for (const Strand& strand : strands.all) {
      ASSERT_FALSE(strand.mean.empty());
      const MeanExponent& name = sample->mean[strand.mean.front()];
      EXPECT_LT(std::abs(folded({0, strand.s.imag() - name.frozen}).imag()), 1e-3) << speed;
      EXPECT_FALSE(taken[strand.mean.front()]) << speed;
      taken[strand.mean.front()] = true;
    }
  }
}

TEST(FrozenFrequencies, AreUnknownWhereAnAngleHasNone) {
  HillSystem system = slowly_modulated(0.4, 0.7);
  system.stiffness[0].c.col(1) *= 10;
  for (const MeanExponent& mean : mean_exponents(scale_system(system, 1))) EXPECT_EQ(mean.frozen, 0);
}

// Frequencies of 12, 14 and 85: the first two turn into each other within a turn.
TEST(FrozenFrequencies, AreUnknownWhereModesPassEachOther) {
  HillSystem system = slowly_modulated(0.4, 0.7);
  system.stiffness[0].c(4, 0) = 196;
  for (const MeanExponent& mean : mean_exponents(scale_system(system, 1))) EXPECT_EQ(mean.frozen, 0);
}

TEST(FrozenFrequencies, AreUnknownUnderFastModulation) {
  HillSystem system = slowly_modulated(0.4, 0.7);
  FourierSeries& K = system.stiffness[0];
  K = fourier::resized(K, 40);
  K.c(8, 40) = 500;
  for (const MeanExponent& mean : mean_exponents(scale_system(system, 1))) EXPECT_EQ(mean.frozen, 0);
}

}  // namespace
