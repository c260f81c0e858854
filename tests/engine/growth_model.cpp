// Growth of a pair between places: two that pass each other, and one place that tells of another pair.
#include "hb/engine/boundaries/growth_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace hb;

constexpr double error = 1e-13;

// Two on the axis, without damping, delta(x) half of what they are apart.
double delta(double x) { return 0.03 * x + 0.004 * std::sin(2 * x) + 0.001 * x * x; }
GrowthNode passing(double x) { return pair_node(x, {0, delta(x)}, {0, -delta(x)}, error, error); }
// Locked: growth g, the other decays as fast.
GrowthNode locked(double x, double g) { return pair_node(x, {g, 0}, {-g, 0}, error, error); }

double highest(const GrowthModel& model, double from, double to) {
  double high = -HUGE_VAL;
  for (double t = 1e-4; t < 1; t *= 1.2) high = std::max(high, model(from + t * (to - from)).high);
  return high;
}

// Q has a double zero where they pass each other: two places there show it, one does not.
TEST(GrowthModel, TellsThatTwoPassEachOtherByTwoPlacesThere) {
  const GrowthModel by_one({passing(1e-9), passing(1), passing(-1), passing(2)});
  EXPECT_GT(highest(by_one, 0, 1), 1e-4);
  const GrowthModel by_two({passing(3e-4), passing(1), passing(1e-9), passing(2)});
  EXPECT_LT(highest(by_two, 3e-4, 1), 1e-9);
  // The other way round.
  const GrowthModel mirrored({passing(-3e-4), passing(-1), passing(1e-9), passing(-2)});
  EXPECT_LT(highest(mirrored, -3e-4, -1), 1e-9);
}

// The third place, next to the first, tells of the lock that ends there; the second one and the fourth of another. What
// leaving out the third changes counts.
TEST(GrowthModel, DoubtsALockThatMayEndBesideAPlace) {
  const double edge = 0.02, slope = 0.001;  // growth^2 = slope (edge - x)
  const auto ends = [&](double x) { return locked(x, std::sqrt(slope * (edge - x))); };
  const GrowthModel model({ends(0), locked(1, 0.1), ends(-0.02), locked(2, 0.2)});
  bool doubtful = false;
  for (double x = edge; x < 0.3; x += 0.002) doubtful = doubtful || model(x).low <= 0;
  EXPECT_TRUE(doubtful);
}

}  // namespace
