#include "lib/zero_between.hpp"

#include <gtest/gtest.h>

namespace hb {
namespace {

struct Found {
  double x;
  int values;
};

template <class Function>
Found zero(const Function& f, double a, double b, double accuracy = 1e-15) {
  Found found{0, 0};
  found.x = zero_between(a, b, accuracy, [&](double x) {
    ++found.values;
    return f(x);
  });
  return found;
}

TEST(ZeroBetween, TakesFewValuesOfASmoothFunction) {
  const Found cosine = zero([](double x) { return std::cos(x) - x; }, 0, 1);
  EXPECT_NEAR(cosine.x, 0.7390851332151607, 1e-15);
  EXPECT_LE(cosine.values, 10);
  const Found steep = zero([](double x) { return std::atan(1000 * (0.2 - x)); }, 0, 1);
  EXPECT_NEAR(steep.x, 0.2, 1e-15);
  EXPECT_LE(steep.values, 20);
}

TEST(ZeroBetween, HalvesAtAJumpAndAtAMultipleZero) {
  const Found jump = zero([](double x) { return x < 0.3 ? 1 + x : -2.0; }, 0, 1);
  EXPECT_NEAR(jump.x, 0.3, 1e-15);
  EXPECT_LE(jump.values, 60);
  EXPECT_NEAR(zero([](double x) { return x * x * x; }, -1, 2).x, 0, 1e-15);
}

TEST(ZeroBetween, StaysBetweenEndsOfOneSign) {
  const double x = zero([](double x) { return 1 + x; }, 0, 1).x;
  EXPECT_GE(x, 0);
  EXPECT_LE(x, 1);
}

}  // namespace
}  // namespace hb
