// How well a boundary between two places is known.
#include "hb/engine/boundaries/boundary.hpp"

#include <gtest/gtest.h>

namespace {

using namespace hb;

// A place whose growth is not told from none is no end of a bracket: the boundary may be on either side of it.
TEST(Boundary, BesideAPlaceWithoutVerdictIsKnownNoBetterThanTheWholeInterval) {
  HillSystem system;  // the band about 2 is 1.894 .. 2.095
  system.mass = Eigen::MatrixXd::Ones(1, 1);
  system.damping = Eigen::MatrixXd::Zero(1, 1);
  system.stiffness[0] = FourierSeries(1, 1);
  system.stiffness[0].c(0, 0) = 1;
  system.stiffness[0].c(0, 1) = 0.1;
  const SystemAt at = [&](double x) { return scale_system(system, x); };
  const auto unstable = *stability_sample(at, 2.0, {});
  ASSERT_EQ(unstable.stability.verdict, Verdict::unstable);
  auto open = *stability_sample(at, 2.02, {});
  ASSERT_EQ(open.stability.verdict, Verdict::unstable);
  open.stability.verdict = Verdict::undecided;
  open.stability.growth_error = 2 * open.stability.growth_rate;
  EXPECT_GE(locate_boundary(at, unstable, open).error, 0.02);
  EXPECT_FALSE(locate_boundary(at, unstable, open).converged);
  // Between sure places the end is found.
  const auto bounded = *stability_sample(at, 2.2, {});
  ASSERT_EQ(bounded.stability.verdict, Verdict::bounded);
  const StabilityBoundary end = locate_boundary(at, unstable, bounded);
  EXPECT_LT(end.error, 1e-8);
  EXPECT_NEAR(end.x, 2.095, 0.01);
}

}  // namespace
