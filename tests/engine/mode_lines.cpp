// Growth rates by lines of modes beside propagation.
#include "hb/engine/exponents/mode_lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hb/engine/exponents/radau_turn.hpp"
#include "lib/constants.hpp"

namespace {

using namespace hb;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr GrowthAccuracy percents{.of_change = 0.02, .of_rate = 1e-7};

// Two modes each, w and 4 w, whose frequencies change over the turn by a few per cent and which feel each other.
PeriodicCoefficients rod(double w, double modulation, double damping) {
  PeriodicCoefficients system{FourierSeries(4, 2), FourierSeries(4, 0), 2};
  const double w2 = w * w;
  system.alpha.c.col(0).real() << w2, 0.1 * w2, 0.1 * w2, 16 * w2;
  system.alpha.c.col(1).real() << modulation * w2, 0.1 * modulation * w2, 0.1 * modulation * w2, 2 * modulation * w2;
  system.alpha.c.col(2).imag() << 0.3 * modulation * w2, 0, 0, modulation * w2;
  system.beta.c.col(0).real() << damping, 0, 0, 8 * damping;
  return system;
}

// Of all modes, at N angles: damping, stiffness, coupling of both rods.
NormalForm small_change(Index n, double w, double size, Index N) {
  NormalForm change{MatrixXd::Zero(n * n, N), MatrixXd::Zero(n * n, N)};
  for (Index j = 0; j < N; ++j) {
    const double tau = two_pi * double(j) / double(N);
    for (Index i = 0; i < n; ++i)
      for (Index k = 0; k < n; ++k) {
        change.alpha(i + n * k, j) = size * w * w * std::cos(tau + double(i - 2 * k)) * (i == k ? 1 : 0.5);
        change.beta(i + n * k, j) = size * (i == k ? 1 - std::cos(2 * tau) : w * std::sin(tau + double(k)));
      }
  }
  return change;
}

double propagated_change(const std::vector<PeriodicCoefficients>& parts, const NormalForm& change) {
  const Index n = change.num_modes(), cells = radau_cells(2048);
  PeriodicCoefficients all{fourier::analyse(change.alpha), fourier::analyse(change.beta), n};
  double before = -HUGE_VAL;
  Index first = 0;
  for (const PeriodicCoefficients& part : parts) {
    before = std::max(before, rough_growth(part, cells));
    const Index m = part.num_modes;
    for (Index j = 0; j < m; ++j) {
      const Index row = first + n * (first + j);
      all.alpha.c.block(row, 0, m, 3) += part.alpha.c.middleRows(m * j, m);
      all.beta.c.col(0).segment(row, m) += part.beta.c.col(0).segment(m * j, m);
    }
    first += m;
  }
  return rough_growth(all, cells) - before;
}

TEST(ModeLines, TellWhatPropagationTellsOfASmallChange) {
  for (const double w : {3.3, 7.3, 20.3}) {
    // The second pair of rods has frequencies that cross during the turn.
    for (const double other : {1.7, 1.02}) {
      SCOPED_TRACE(std::to_string(w) + ", " + std::to_string(other));
      const std::vector<PeriodicCoefficients> parts{rod(w, 0.03, 0.2), rod(other * w, 0.01, 0.21)};
      const NormalForm change = small_change(4, w, 2e-3, 16);
      const auto found = UncoupledSystems(parts, 32).growth(change, percents);
      ASSERT_TRUE(found);
      const double expected = propagated_change(parts, change);
      EXPECT_GT(std::abs(expected), 1e-5);
      EXPECT_NEAR(found->change, expected, 0.01 * std::abs(expected));
    }
  }
}

TEST(ModeLines, EverySecondAngleTellsAsMuchAsHalfOfThem) {
  const std::vector<PeriodicCoefficients> parts{rod(7.3, 0.03, 0.2), rod(9.1, 0.01, 0.21)};
  NormalForm change = small_change(4, 7.3, 2e-3, 16);
  for (Index j = 0; j < 16; ++j) change.beta.col(j) *= 1 + 0.3 * std::cos(8 * two_pi * double(j) / 16);
  const auto half = Eigen::seqN(0, 8, 2);
  UncoupledSystems systems(parts, 32);
  const auto all = systems.growth(change, percents),
             some = systems.growth({change.alpha(Eigen::all, half), change.beta(Eigen::all, half)}, percents);
  ASSERT_TRUE(all && some);
  EXPECT_GT(std::abs(all->change - some->change), 0.1 * std::abs(some->change));
  EXPECT_NEAR(all->by_half, some->change, 0.02 * std::abs(some->change));
}

// Rods of which one is damped more: its lines are left behind, and orders to come are foreseen. At as many angles as
// the change is known at, or more.
TEST(ModeLines, TellTheSameAtAnyAngles) {
  const std::vector<PeriodicCoefficients> parts{rod(7.3, 0.03, 0.2), rod(12.4, 0.01, 0.26)};
  const NormalForm change = small_change(4, 7.3, 2e-3, 24);
  const double expected = propagated_change(parts, change);
  for (const Index M : {24, 32, 64}) {
    SCOPED_TRACE(M);
    const auto found = UncoupledSystems(parts, M).growth(change, percents);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->change, expected, 0.003 * std::abs(expected));
  }
}

TEST(ModeLines, AreSilentWhereAModeIsLockedToTheTurn) {
  const std::vector<PeriodicCoefficients> parts{rod(3.5, 0, 0.02)};
  NormalForm change = small_change(2, 3.5, 0, 32);
  for (Index j = 0; j < 32; ++j) change.alpha(0, j) = 0.6 * std::cos(7 * two_pi * double(j) / 32);
  EXPECT_GT(propagated_change(parts, change), 0.01);  // a real multiplier
  EXPECT_FALSE(UncoupledSystems(parts, 32).growth(change, percents));
}

TEST(ModeLines, AreSilentWhereAModeDoesNotOscillate) {
  std::vector<PeriodicCoefficients> parts{rod(3.5, 0.03, 0.02)};
  parts[0].beta.c(3, 0) = 60;
  EXPECT_FALSE(UncoupledSystems(parts, 32).growth(small_change(2, 3.5, 1e-3, 16), percents));
}

}  // namespace
