#include "hb/analysis/nonlinear/exact_system.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "hb/engine/nonlinear/periodic_motion.hpp"
#include "lib/constants.hpp"
#include "tests/support/six_link.hpp"
#include "tests/support/slider_crank.hpp"

namespace hb {
namespace {

using Eigen::Index;
NonlinearSystem system_of(const Linkage& linkage, Index num_modes) {
  std::vector<ExactModel::Rod> rods;
  for (const int link : elastic_links(linkage)) rods.push_back({link, num_modes});
  return exact_system(std::make_shared<const ExactModel>(linkage, rods));
}

// Independent values: action of the whole mechanism from positions, its gradient by automatic differentiation.
TEST(ExactSystem, MotionOfTheSixLinkMechanismIsTheReferences) {
  const struct {
    double rpm;
    std::vector<double> max_abs;
  } cases[] = {
      {300, {0.1510894034, 0.0050581327, 0.1267065791, 0.0009852141}},
      {600, {0.5419715853, 0.0205708550, 0.4121555418, 0.0037625432}},
      {900, {1.3632967558, 0.0477219970, 0.9390832626, 0.0077317919}},
      {1200, {2.7971543378, 1.8347540197}},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.rpm);
    const std::size_t n = c.max_abs.size();
    const NonlinearSystem system = system_of(six_link::linkage(), static_cast<Index>(n / 2));
    const PeriodicMotion motion = solve_periodic_motion(system, c.rpm * pi / 30, {});
    ASSERT_EQ(motion.status, MotionStatus::converged);
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(fourier::max_abs(motion.q, static_cast<Index>(i)).value, c.max_abs[i],
                  3e-7 * c.max_abs[i < n / 2 ? 0 : n / 2]);
  }
}

TEST(ExactSystem, MotionOfTheSliderCrankIsTheReferences) {
  const NonlinearSystem system = system_of(slider_crank::linkage(), 2);
  const struct {
    double speed, q1, q2;
  } cases[] = {
      {60, 2.489224424e-4, 7.64312403e-6}, {150, 1.552226356e-3, 4.88545926e-5}, {212.8, 3.40767475e-3, 1.01601433e-4}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.speed);
    const PeriodicMotion motion = solve_periodic_motion(system, c.speed, {});
    ASSERT_EQ(motion.status, MotionStatus::converged);
    EXPECT_NEAR(fourier::max_abs(motion.q, 0).value, c.q1, 3e-7 * c.q1);
    EXPECT_NEAR(fourier::max_abs(motion.q, 1).value, c.q2, 3e-7 * c.q1);
  }
}

// Angles were compared over the length of the longer list: those of an earlier call served for a single one that was
// the first of them.
TEST(ExactSystem, OneAngleAfterManyIsThatAngleAlone) {
  const NonlinearSystem system = system_of(six_link::linkage(), 1);
  const auto at_rest = [](Index N) {
    const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(2, N);
    return MotionSamples{Eigen::VectorXd::LinSpaced(N, 0, double(N - 1)), none, none, none};
  };
  ResidualSamples many, one;
  ASSERT_FALSE(system.evaluate(10, at_rest(4), Derivatives::none, many));
  ASSERT_FALSE(system.evaluate(10, at_rest(1), Derivatives::none, one));
  ASSERT_EQ(one.r.cols(), 1);
  // Lanes and tail of an array may differ by a unit in the last place; another angle's answer by its first digit.
  EXPECT_TRUE(one.r.col(0).isApprox(many.r.col(0), 4 * std::numeric_limits<double>::epsilon()))
      << (one.r.col(0) - many.r.col(0)).transpose();
}

TEST(ExactSystem, FoldedRodsAreSaidWithTheirAngle) {
  const Linkage linkage = six_link::linkage();
  const NonlinearSystem system = system_of(linkage, 1);
  MotionSamples motion{Eigen::Vector2d(0, 1), Eigen::MatrixXd::Zero(2, 2), Eigen::MatrixXd::Zero(2, 2),
                       Eigen::MatrixXd::Zero(2, 2)};
  ResidualSamples residual;
  EXPECT_FALSE(system.evaluate(10, motion, Derivatives::none, residual));
  motion.q(1, 1) = 100;
  const std::optional<EvaluationFailure> failure = system.evaluate(10, motion, Derivatives::none, residual);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->angle, 1);
  EXPECT_EQ(failure->reason.substr(0, 2), "CD");
}

}  // namespace
}  // namespace hb
