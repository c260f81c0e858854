// How well a boundary between two places is known.
#include "hb/engine/boundaries/boundary.hpp"

#include <gtest/gtest.h>

#include <tuple>

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

// Frequencies 1 and 2, coupled by `coupling` cos(Omega t): a band about 3.
HillSystem two_oscillators(double damping, double coupling) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(2, 2);
  system.damping = damping * Eigen::MatrixXd::Identity(2, 2);
  system.stiffness[0] = FourierSeries(4, 1);
  system.stiffness[0].c.col(0) << 1, 0, 0, 4;
  system.stiffness[0].c.col(1) << 0, 0.5 * coupling, 0.5 * coupling, 0;
  return system;
}

// Q is nearly a parabola that is widest in the middle of a narrow band; where two with damping meet off +-1 what is
// bracketed has no root at the boundary. Without these it took 8, 11 and 9 places.
TEST(Boundary, OfTwoThatMeetTakesFewPlaces) {
  for (const auto& [damping, coupling, stable_x, most] :
       {std::tuple{0.0, 1e-4, 3.1, 5}, std::tuple{0.02, 0.5, 3.25, 8}, std::tuple{0.02, 0.1, 3.1, 8}}) {
    const HillSystem system = two_oscillators(damping, coupling);
    int places = 0;
    const SystemAt at = [&](double x) {
      ++places;
      return scale_system(system, x);
    };
    const auto unstable = *stability_sample(at, 3.0, {}), stable = *stability_sample(at, stable_x, {});
    ASSERT_EQ(unstable.stability.verdict, Verdict::unstable);
    ASSERT_TRUE(stable.stability.verdict == Verdict::stable || stable.stability.verdict == Verdict::bounded);
    places = 0;
    const StabilityBoundary end = locate_boundary(at, unstable, stable);
    EXPECT_LE(places, most) << coupling;
    EXPECT_TRUE(end.converged);
    EXPECT_EQ(end.kind, BoundaryKind::complex);
    EXPECT_TRUE(is_unstable(*stability_sample(at, end.x - 2 * end.error, {}))) << coupling;
    EXPECT_FALSE(is_unstable(*stability_sample(at, end.x + 2 * end.error, {}))) << coupling;
  }
}

}  // namespace
