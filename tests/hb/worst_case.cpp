#include "hb/worst_case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace hb;

WorstCase worst(const std::function<double(double)>& f, double from, double to, int count) {
  std::vector<double> x, values;
  for (int k = 0; k < count; ++k) {
    x.push_back(from + (to - from) * k / (count - 1));
    values.push_back(f(x.back()));
  }
  return worst_case(f, x, values);
}

TEST(WorstCase, IsFoundBetweenSamples) {
  // A resonance of a damped oscillator: largest at x^2 = 1 - 2 d^2.
  const double d = 0.05;
  const auto f = [&](double x) { return 1 / std::hypot(1 - x * x, 2 * d * x); };
  const WorstCase found = worst(f, 0.1, 3, 12);
  EXPECT_NEAR(found.x, std::sqrt(1 - 2 * d * d), 1e-6);
  EXPECT_NEAR(found.value, 1 / (2 * d * std::sqrt(1 - d * d)), 1e-10);
}

TEST(WorstCase, IsTheHighestOfSeveralPeaks) {
  const auto f = [](double x) { return std::sin(x) + 0.05 * x; };
  // cos x = -0.05 near the last of the peaks, 2 pi 3 + pi/2.
  const WorstCase found = worst(f, 0, 22, 30);
  EXPECT_NEAR(found.x, 6 * M_PI + std::acos(-0.05), 1e-5);
}

TEST(WorstCase, AtAnEndIsTheEnd) {
  const WorstCase up = worst([](double x) { return x * x; }, 1, 5, 6),
                  down = worst([](double x) { return -x; }, 1, 5, 6);
  EXPECT_EQ(up.x, 5);
  EXPECT_EQ(down.x, 1);
  EXPECT_EQ(worst_case([](double) { return 2.0; }, {3}, {2}).value, 2);
}

TEST(WorstCase, JustInsideAnEndIsFound) {
  const WorstCase found = worst([](double x) { return -(x - 4.7) * (x - 4.7); }, 1, 5, 5);
  EXPECT_NEAR(found.x, 4.7, 1e-6);
}

TEST(WorstCase, AtAKinkIsFound) {
  const WorstCase found = worst([](double x) { return -std::abs(x - 2.34); }, 1, 5, 5);
  EXPECT_NEAR(found.x, 2.34, 1e-5);
}

TEST(WorstCase, OfWhatIsNotANumberIsNotANumber) {
  const auto f = [](double x) { return x > 2.2 && x < 2.8 ? std::numeric_limits<double>::quiet_NaN() : -x * (x - 5); };
  EXPECT_TRUE(std::isnan(worst(f, 1, 4, 4).value));
}

}  // namespace
