// The leading pair of exponents and its interpolation against the trace of the turn's map, integrated here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/leading_pair.hpp"
#include "hb/engine/boundaries/pair_model.hpp"
#include "tests/support/random_hill_system.hpp"

namespace {

using namespace hb;
using std::numbers::pi;

constexpr double damping = 0.1;

HillSystem mathieu(double modulation) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Ones(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, damping);
  system.stiffness[0] = FourierSeries(1, 1);
  system.stiffness[0].c(0, 0) = 1;
  system.stiffness[0].c(0, 1) = modulation / 2;
  return system;
}

// tr Phi/(2 sqrt(det Phi)) of x'' + damping x' + (1 + modulation cos(Omega t)) x = 0 over a turn, by Runge and Kutta.
double half_trace(double modulation, double speed) {
  constexpr int steps = 4000;
  const double T = 2 * pi / speed, h = T / steps;
  double trace = 0;
  for (const int column : {0, 1}) {
    std::array<double, 2> y = {column == 0 ? 1.0 : 0.0, column == 1 ? 1.0 : 0.0};
    const auto rate = [&](double t, const std::array<double, 2>& z) {
      return std::array<double, 2>{z[1], -damping * z[1] - (1 + modulation * std::cos(speed * t)) * z[0]};
    };
    const auto moved = [&](const std::array<double, 2>& k, double by) {
      return std::array<double, 2>{y[0] + by * k[0], y[1] + by * k[1]};
    };
    for (int n = 0; n < steps; ++n) {
      const double t = n * h;
      const auto k1 = rate(t, y), k2 = rate(t + h / 2, moved(k1, h / 2)), k3 = rate(t + h / 2, moved(k2, h / 2)),
                 k4 = rate(t + h, moved(k3, h));
      for (const std::size_t i : {0, 1}) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    trace += y[static_cast<std::size_t>(column)];
  }
  return trace / 2 * std::exp(damping * T / 2);
}

StabilitySample sample_of(const HillSystem& system, double speed) {
  return stability_sample(scale_system(system, speed), speed, {.tolerance = 1e-11});
}

TEST(SeparatePair, IsTheTraceOfTheTurnsMapLockedOrNot) {
  for (const double speed : {0.9, 1.3, 1.9, 2.0, 2.2, 3.1}) {
    const auto pair = leading_pair(sample_of(mathieu(0.8), speed));
    ASSERT_TRUE(pair) << speed;
    const double truth = half_trace(0.8, speed);
    EXPECT_NEAR(pair->half_trace, truth, pair->half_trace_error + 1e-9 * std::abs(truth)) << speed;
    EXPECT_NEAR(pair->mean, -damping / 2 / speed, pair->mean_error + 1e-14) << speed;
    EXPECT_EQ(pair->others, -HUGE_VAL);
  }
}

TEST(SeparatePair, ItsModelHoldsTheGrowthOnBothSidesOfATonguesEdge) {
  const HillSystem system = mathieu(0.8);
  std::vector<PairNode> nodes;
  for (const double speed : {2.3, 2.5, 2.1, 2.7, 1.9})
    nodes.push_back({speed, *leading_pair(sample_of(system, speed))});
  const PairModel model(nodes);
  bool stable = false, unstable = false;
  for (const double speed : model.telling()) {
    const Stability truth = sample_of(system, speed).stability;
    const GrowthBounds growth = model.leading(speed);
    EXPECT_LE(growth.low, truth.growth_high / speed) << speed;
    EXPECT_GE(growth.high, truth.growth_low / speed) << speed;
    EXPECT_LT(growth.high - growth.low, 0.2) << speed;
    (truth.growth_rate > 0 ? unstable : stable) = true;
  }
  EXPECT_TRUE(stable && unstable);
}

// Mode 1 strongly modulated; mode 2 feels it and decays several times as fast.
HillSystem slow_and_fast() {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(2, 2);
  system.damping = Eigen::Vector2d(0.04, 1.5).asDiagonal();
  system.stiffness[0] = FourierSeries(4, 2);
  system.stiffness[0].c.col(0) << 1, 0, 0, 14;
  system.stiffness[0].c.col(1) << 0.35, 0.2, 0.2, 0.9;
  system.stiffness[0].c.col(2) << 0.15, 0.1, 0.1, 0.3;
  return system;
}

TEST(SeparatePair, VerdictsBetweenPlacesAreThoseOfAFineGrid) {
  const HillSystem system = slow_and_fast();
  const SystemAt at = [&](double speed) { return scale_system(system, speed); };
  for (const int intervals : {5, 16}) {
    std::vector<StabilitySample> grid;
    for (int k = 0; k <= intervals; ++k) grid.push_back(sample_of(system, 0.5 + 2.5 * k / intervals));
    std::vector<double> changes;
    for (std::size_t k = 0; k + 1 < grid.size(); ++k) {
      const SearchedInterval found = search_interval(at, grid[k], grid[k + 1], k > 0 ? &grid[k - 1] : nullptr,
                                                     k + 2 < grid.size() ? &grid[k + 2] : nullptr);
      EXPECT_TRUE(found.not_excluded.empty());
      for (const StabilityBoundary& boundary : found.boundaries) changes.push_back(boundary.x);
    }
    EXPECT_GE(changes.size(), 4U);
    bool unstable = is_unstable(grid.front());
    std::size_t next = 0;
    constexpr int fine = 2000;
    for (int k = 0; k <= fine; ++k) {
      const double speed = 0.5 + 2.5 * k / fine;
      for (; next < changes.size() && changes[next] < speed; ++next) unstable = !unstable;
      EXPECT_EQ(analyse_stability(system, speed).growth_rate > 0, unstable) << speed;
    }
  }
}

// A node 1e-9 of the interval beside the gap between two locks of opposite sign.
TEST(SeparatePair, AGapBesideANodeIsLookedAt) {
  constexpr double gap = 1e-9;
  std::vector<PairNode> nodes;
  for (const double x : {0.0, 1.0, 2.0, -1.0}) {
    PairNode node;
    node.x = x;
    node.pair.mean = -1e-4;
    node.pair.half_trace = 1e9 * (gap - x);
    nodes.push_back(node);
  }
  const PairModel model(nodes);
  const std::vector<double> places = model.telling();
  EXPECT_TRUE(std::ranges::any_of(places, [&](double x) { return model.predicted(x) < 0; }));
  EXPECT_TRUE(std::ranges::none_of(places, [](double x) { return x == 0 || x == 1; }));
}

// A narrow lock, c = 1.0001 cos 2 pi phi, phi = const - 1/x: places far apart do not show where it is.
TEST(SeparatePair, ItsErrorLeavesRoomForALockBetweenPlacesFarApart) {
  stress::Random random(7);
  int settled = 0;
  for (int number = 0; number < 5000; ++number) {
    const double from = random(2, 6), spacing = random.power(-1.5, -0.15), last = spacing * random(0.3, 1);
    std::vector<double> turns = {0, last, last + spacing * random(0.3, 1), -spacing * random(0.3, 1)};
    if (random.chance(0.5)) turns.push_back(turns[2] + spacing * random(0.3, 1));
    const double lock = last * std::array{1e-3, 0.01, 0.2, 0.5, 0.8, 0.99}[std::size_t(number % 6)];
    constexpr double deepest = 1.0001;
    std::vector<PairNode> nodes;
    for (const double t : turns) {
      PairNode node;
      node.x = 1 / (from - t);
      node.turned = t;
      node.pair.half_trace = deepest * std::cos(2 * pi * (t - lock));
      nodes.push_back(node);
    }
    const GrowthBounds growth = PairModel(nodes).leading(1 / (from - lock));
    const double truth = std::acosh(deepest) / (2 * pi);
    EXPECT_GE(growth.high, truth) << number;
    EXPECT_LE(growth.low, truth) << number;
    settled += growth.high < 2 * truth;
  }
  EXPECT_GT(settled, 100);
}

}  // namespace
