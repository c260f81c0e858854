#include "hb/analysis/theory_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lib/constants.hpp"
#include "lib/scene/scene.hpp"
#include "tests/support/linear_answer.hpp"
#include "tests/support/six_link.hpp"
#include "tests/support/slider_crank.hpp"

namespace hb {
namespace {

using Eigen::Index;

// The first correction by an independent formulation: action of the whole mechanism from positions.
TEST(TheoryError, OfTheSixLinkMechanismIsTheReferences) {
  const Linkage linkage = six_link::linkage();
  const struct {
    double rpm;
    Index modes;
    double AB, CD, digits;
  } cases[] = {
      {300, 1, 2.2873e-5, 9.843e-6, 1e-4},  {600, 2, 1.8152e-4, 2.9200e-4, 1e-4}, {900, 1, 2.663e-3, 5.670e-3, 3e-4},
      {1200, 1, 9.593e-3, 1.3307e-2, 1e-4}, {1500, 1, 0.17, 0.037, 0.03},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.rpm);
    const double speed = c.rpm * pi / 30;
    const LinearAnswer answer = linear_answer(linkage, speed, c.modes);
    const TheoryErrors errors = theory_errors(answer.model, speed, answer.rods());
    ASSERT_TRUE(errors.rods[0].q && errors.rods[1].q);
    const double own_error = 2e-8;  // of the reference, which keeps few harmonics
    EXPECT_NEAR(*errors.rods[0].q, c.AB, c.digits * c.AB + own_error);
    EXPECT_NEAR(*errors.rods[1].q, c.CD, c.digits * c.CD + own_error);
    EXPECT_EQ(beyond_theory(errors.rods[0].q), c.rpm == 1500);
  }
}

TEST(TheoryError, OfTheSliderCrankIsTheReferences) {
  const Linkage linkage = slider_crank::linkage();
  for (const auto& [speed, expected] : {std::pair{150.0, 1.109e-3}, std::pair{212.8, 1.99e-2}}) {
    const LinearAnswer answer = linear_answer(linkage, speed, 2);
    const TheoryErrors errors = theory_errors(answer.model, speed, answer.rods());
    ASSERT_TRUE(errors.rods[0].q);
    EXPECT_NEAR(*errors.rods[0].q, expected, 5e-4 * expected + 4e-5);
  }
}

TEST(TheoryError, OfScaledSystemsAtHandIsThatOfTheirOwn) {
  const double speed = 1000 * pi / 30;
  const LinearAnswer answer = linear_answer(six_link::linkage(), speed, 3);
  std::vector<LinearRod> rods = answer.rods();
  const TheoryErrors alone = theory_errors(answer.model, speed, rods);
  std::vector<ScaledSystem> scaled;
  for (const HillSystem& system : answer.systems) scaled.push_back(scale_system(system, speed));
  for (std::size_t r = 0; r < rods.size(); ++r) rods[r].scaled = &scaled[r];
  const TheoryErrors handed = theory_errors(answer.model, speed, rods);
  for (std::size_t r = 0; r < rods.size(); ++r) {
    EXPECT_NEAR(*handed.rods[r].q, *alone.rods[r].q, 1e-9 * *alone.rods[r].q);
    EXPECT_NEAR(*handed.rods[r].deflection, *alone.rods[r].deflection, 1e-9 * *alone.rods[r].deflection);
  }
}

// Too few points along the rods show as an error of the theory that is not there.
TEST(TheoryError, OfSmallVibrationIsNotThatOfItsPointsAlongTheRod) {
  const Scene scene = read_scene(HB_SOURCE_DIR "/results/first_steps/scene.toml");
  const auto& linkage = std::get<Linkage>(scene.model);
  const double speed = 300 * pi / 30;
  for (const Index modes : {1, 2, 5, 8}) {
    SCOPED_TRACE(modes);
    const LinearAnswer answer = linear_answer(linkage, speed, modes);
    const ExactModel fine(linkage, {{elastic_links(linkage).front(), modes}}, modes + 24);
    const TheoryErrors errors = theory_errors(theory_model(linkage, {modes}), speed, answer.rods());
    const TheoryErrors finer = theory_errors(fine, speed, answer.rods());
    ASSERT_TRUE(errors.rods[0].q && finer.rods[0].q);
    EXPECT_LE(*finer.rods[0].q, 2e-7);
    EXPECT_NEAR(*errors.rods[0].q, *finer.rods[0].q, 2e-8);
  }
}

// Beyond 1604 rpm the linear answer of AB grows past its own length.
TEST(TheoryError, HasNoValueWhereTheLinearAnswerFoldsARod) {
  const Linkage linkage = six_link::linkage();
  LinearAnswer answer = linear_answer(linkage, 1500 * pi / 30, 1);
  answer.q[0].c *= 12;
  const TheoryErrors errors = theory_errors(answer.model, 1500 * pi / 30, answer.rods());
  EXPECT_FALSE(errors.rods[0].q);
  EXPECT_FALSE(errors.rods[1].q);
  EXPECT_TRUE(beyond_theory(errors.rods[0].q));
  EXPECT_EQ(errors.reason.substr(0, 2), "AB");
}

TEST(TheoryError, OfARodWithoutPeriodicSolutionIsNotThere) {
  const Linkage linkage = six_link::linkage();
  LinearAnswer answer = linear_answer(linkage, 30, 2);
  answer.q[1] = FourierSeries();
  const TheoryErrors errors = theory_errors(answer.model, 30, answer.rods());
  EXPECT_FALSE(errors.rods[0].q);
  EXPECT_EQ(errors.reason.substr(0, 2), "CD");
}

// The correction shrinks with the square of the deflection at least: small vibration, small error everywhere.
TEST(TheoryError, OfForcesAndTorqueVanishesWithTheSpeed) {
  const Linkage linkage = six_link::linkage();
  double previous = 1;
  for (const double rpm : {1200.0, 900.0, 600.0, 300.0}) {
    const double speed = rpm * pi / 30;
    const LinearAnswer answer = linear_answer(linkage, speed, 2);
    const JointForces forces = joint_forces(linkage, speed, answer.responses);
    const TheoryErrors errors = theory_errors(answer.model, speed, answer.rods(), &forces);
    ASSERT_TRUE(errors.force && errors.torque);
    EXPECT_LT(*errors.force, previous / 1.5);
    EXPECT_GT(*errors.force, 1e-8);
    EXPECT_LE(*errors.torque, 5 * *errors.force);
    previous = *errors.force;
  }
}

// EA/l = 4.267e7 N/m against a third of the rod, and the slider with the rod's turning inertia, seen along the rod at
// up to 30 degrees from the guide: m_s/cos^2 + m/3 tan^2.
TEST(TheoryError, AxialShareIsThatOfASpringAndItsMass) {
  const ExactModel model(slider_crank::linkage(), {{1, 1}});
  const double omega1_squared = std::pow(pi / 0.3, 4) * 2e11 * std::pow(0.008, 4) / 12 / (0.151104 / 0.3);
  const double mass = 0.151104 / 3 * (1 + 0.25 / 0.75) + 0.075552 / 0.75;
  EXPECT_NEAR(axial_shares(model)[0], 4 * omega1_squared * mass * 0.3 / (2e11 * 64e-6), 1e-6);
}

}  // namespace
}  // namespace hb
