#include "hb/engine/system/independent_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/stability.hpp"
#include "tests/support/long_double_floquet.hpp"

namespace hb {
namespace {

using Eigen::Index;

// Three oscillators; 0 and 2 feel each other through harmonic k, 1 is alone.
HillSystem three_oscillators(Index k) {
  HillSystem system;
  system.mass = Eigen::Vector3d(1, 2, 0.5).asDiagonal();
  system.damping = Eigen::Vector3d(0.1, 0.3, 0.02).asDiagonal();
  system.stiffness[0] = FourierSeries(9, 2 * k);
  Eigen::MatrixXcd& c = system.stiffness[0].c;
  c(0, 0) = 1.3, c(4, 0) = 3.1, c(8, 0) = 2.2;
  c(0, k) = 0.2, c(4, k) = {0.4, 0.3}, c(8, k) = 0.1;
  c(2, k) = c(6, k) = {0.15, -0.1};
  c(4, 2 * k) = 0.1;
  return system;
}

// Every exponent of the reference has one of the result within the bars, and the other way round.
void expect_same(const Stability& result, const std::vector<reference::FloquetExponent>& exact, double Omega) {
  ASSERT_EQ(result.exponents.size(), exact.size());
  const auto distance = [&](std::complex<double> a, reference::Complex b) {
    const double turn = std::remainder(a.imag() - double(b.imag()), Omega);
    return std::hypot(a.real() - double(b.real()), turn);
  };
  std::vector<bool> taken(exact.size(), false);
  for (const Exponent& e : result.exponents) {
    EXPECT_LE(std::abs(e.value.imag()), Omega / 2 * (1 + 1e-15));
    EXPECT_LE(e.error, 1e-9);
    std::size_t best = 0;
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < exact.size(); ++i)
      if (!taken[i] && distance(e.value, exact[i].value) < nearest) nearest = distance(e.value, exact[best = i].value);
    taken[best] = true;
    EXPECT_LE(nearest, e.error + double(exact[best].error)) << e.value;
  }
  EXPECT_TRUE(std::is_sorted(result.exponents.begin(), result.exponents.end(),
                             [](const auto& a, const auto& b) { return a.value.real() > b.value.real(); }));
  EXPECT_NEAR(result.growth_rate, double(exact.front().value.real()), result.growth_error);
}

TEST(IndependentParts, GroupsAreThoseThatFeelEachOther) {
  const ScaledSystem system = scale_system(three_oscillators(1), 1.7);
  const std::vector<std::vector<int>> groups = independent_groups(system);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0], (std::vector<int>{0, 2}));
  EXPECT_EQ(groups[1], std::vector<int>{1});
  // A group's own series ends where its harmonics do.
  EXPECT_EQ(group_of(system, groups[0]).K.num_harmonics(), 1);
  EXPECT_EQ(group_of(system, groups[1]).K.num_harmonics(), 2);
}

TEST(IndependentParts, ExponentsOfTheGroupsAreThoseOfTheWhole) {
  for (const double Omega : {0.4, 1.7, 2.3, 5.0}) {
    const HillSystem system = three_oscillators(1);
    const Stability result = analyse_stability(system, Omega);
    EXPECT_NE(result.evidence.find("2 groups"), std::string::npos);
    expect_same(result, reference::floquet_exponents(system, Omega), Omega);
  }
}

TEST(IndependentParts, ModesCoupledOneWayAreGroupsOfTheirOwn) {
  HillSystem system = three_oscillators(1);
  system.stiffness[0].c(3, 1) = 40;  // mode 0 feels mode 1
  system.damping(2, 1) = 7;  // mode 2 too
  const ScaledSystem scaled = scale_system(system, 1.7);
  EXPECT_EQ(independent_groups(scaled).size(), 1u);
  const std::vector<std::vector<int>> groups = one_way_groups(scaled);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0], (std::vector<int>{0, 2}));
  EXPECT_EQ(groups[1], std::vector<int>{1});
}

// Strong coupling one way leaves the exponents as they are, and their errors.
TEST(IndependentParts, ExponentsOfModesCoupledOneWayAreThoseOfEachAlone) {
  for (const double Omega : {0.4, 1.7, 2.3, 5.0}) {
    HillSystem system = three_oscillators(1);
    const Stability apart = analyse_stability(system, Omega);
    system.stiffness[0].c(3, 1) = 4e5;
    system.damping(2, 1) = 7e3;
    const Stability result = analyse_stability(system, Omega);
    ASSERT_EQ(result.exponents.size(), apart.exponents.size());
    for (std::size_t i = 0; i < apart.exponents.size(); ++i) {
      EXPECT_EQ(result.exponents[i].value, apart.exponents[i].value);
      EXPECT_EQ(result.exponents[i].error, apart.exponents[i].error);
    }
    EXPECT_EQ(result.verdict, apart.verdict);
  }
}

TEST(IndependentParts, AShorterPeriodHasTheSameExponentsFoldedToTheTurn) {
  for (const Index k : {2, 3}) {
    EXPECT_EQ(common_divisor(scale_system(three_oscillators(k), 1)), k);
    for (const double Omega : {0.3, 0.9, 1.7}) {
      const HillSystem system = three_oscillators(k);
      const Stability result = analyse_stability(system, Omega);
      EXPECT_NE(result.evidence.find("a turn"), std::string::npos);
      expect_same(result, reference::floquet_exponents(system, Omega), Omega);
    }
  }
}

TEST(IndependentParts, AWorseGroupGivesTheVerdict) {
  // Oscillator 1 negatively damped: unstable whatever the others do.
  HillSystem system = three_oscillators(1);
  system.damping(1, 1) = -0.01;
  const Stability result = analyse_stability(system, 5.0);
  EXPECT_EQ(result.verdict, Verdict::unstable);
  EXPECT_EQ(result.exponents.front().mode, 1);
}

}  // namespace
}  // namespace hb
