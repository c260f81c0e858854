#include "hb/engine/design/worst_case.hpp"

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

TEST(WorstPoint, IsTheSummitOfSeveralVariables) {
  // Largest at (1, 2, 0.3), on a ridge that runs askew.
  const auto f = [](const Eigen::VectorXd& x) {
    const double a = x(0) - 1, b = x(1) - 2, c = x(2) - 0.3;
    return 5 - a * a - (a + b) * (a + b) - 3 * (b - c) * (b - c);
  };
  const Eigen::Vector3d start(0.9, 2.2, 0.4), lower(0, 1, 0), upper(2, 3, 1);
  const WorstPoint found = worst_point(f, start, lower, upper);
  EXPECT_NEAR(found.value, 5, 1e-9);
  EXPECT_NEAR((found.x - Eigen::Vector3d(1, 2, 0.3)).norm(), 0, 1e-5);
}

TEST(WorstPoint, StaysWithinItsBox) {
  const auto f = [](const Eigen::VectorXd& x) { return x(0) - (x(1) - 1) * (x(1) - 1); };
  const WorstPoint found = worst_point(f, Eigen::Vector2d(0.5, 0.7), Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 2));
  EXPECT_EQ(found.x(0), 1);
  EXPECT_NEAR(found.value, 1, 1e-9);
}

TEST(WorstPoint, IsNeverBelowItsStart) {
  const auto f = [](const Eigen::VectorXd& x) { return x(0) == 0.5 && x(1) == 0.5 ? 1.0 : -1.0; };
  const WorstPoint found = worst_point(f, Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1));
  EXPECT_EQ(found.value, 1);
}

}  // namespace
