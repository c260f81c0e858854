#include "lib/hill_system.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

using namespace hb;

namespace {

// Two modes; C = C0 + Omega C1 + Omega^2 C2 with 0, 2 and 1 harmonics, h with powers 0 and 2.
HillSystem example() {
  HillSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.damping = Eigen::Matrix2d::Zero();
  system.stiffness[0] = FourierSeries(4, 0);
  system.stiffness[0].c.col(0) << 4, 1, 1, 9;
  system.stiffness[1] = FourierSeries(4, 2);
  system.stiffness[1].c.col(2) << 0, std::complex<double>(0, 3), 0, 0;
  system.stiffness[2] = FourierSeries(4, 1);
  system.stiffness[2].c.col(1) << 0.5, 0, 0, 0.25;
  system.load[0] = FourierSeries(2, 0);
  system.load[0].c.col(0) << 1, 2;
  system.load[2] = FourierSeries(2, 1);
  system.load[2].c.col(1) << std::complex<double>(0, 1), 0;
  return system;
}

}  // namespace

TEST(HillSystem, PowersOfTheSpeedAddUpHarmonicByHarmonic) {
  const double Omega = 3;
  const FourierSeries C = stiffness_at(example(), Omega), h = load_at(example(), Omega);
  ASSERT_EQ(C.num_harmonics(), 2);
  EXPECT_EQ(C.c(0, 0), 4.0);
  EXPECT_EQ(C.c(3, 0), 9.0);
  EXPECT_EQ(C.c(0, 1), 4.5);
  EXPECT_EQ(C.c(3, 1), 2.25);
  EXPECT_EQ(C.c(1, 2), std::complex<double>(0, 9));
  ASSERT_EQ(h.num_harmonics(), 1);
  EXPECT_EQ(h.c(1, 0), 2.0);
  EXPECT_EQ(h.c(0, 1), std::complex<double>(0, 9));
}

TEST(HillSystem, MissingSeriesAreZero) {
  HillSystem system = example();
  system.stiffness = {};
  system.load = {};
  EXPECT_EQ(stiffness_at(system, 2).c.norm(), 0);
  EXPECT_EQ(stiffness_at(system, 2).num_components(), 4);
  EXPECT_EQ(load_at(system, 2).num_components(), 2);
}

TEST(HillSystem, ValidateNamesWhatIsWrong) {
  EXPECT_NO_THROW(validate(example()));
  const auto message = [](const HillSystem& system) -> std::string {
    try {
      validate(system);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  HillSystem singular = example();
  singular.mass.setOnes();
  EXPECT_NE(message(singular).find("singular"), std::string::npos);
  HillSystem shape = example();
  shape.damping = Eigen::Matrix3d::Zero();
  EXPECT_NE(message(shape).find("damping"), std::string::npos);
  HillSystem components = example();
  components.load[2] = FourierSeries(3, 1);
  EXPECT_NE(message(components).find("load (power 2)"), std::string::npos);
  HillSystem infinite = example();
  infinite.stiffness[1].c(0, 1) = std::numeric_limits<double>::infinity();
  EXPECT_NE(message(infinite).find("stiffness (power 1)"), std::string::npos);
  HillSystem nan = example();
  nan.mass(0, 0) = std::nan("");
  EXPECT_NE(message(nan).find("mass"), std::string::npos);
}
