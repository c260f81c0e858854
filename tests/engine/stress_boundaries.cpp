// Verdicts next to stability boundaries that are known otherwise.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>

#include "hb/engine/exponents/stability.hpp"
#include "lib/rod/rod.hpp"
#include "tests/support/long_double_floquet.hpp"
#include "tests/support/mathieu_boundaries.hpp"
#include "tests/support/random_hill_system.hpp"
#include "tests/support/six_link.hpp"

namespace hb {
namespace {

// x'' + b x' + (a - 2 q cos 2t) x = 0, at speed 2.
HillSystem mathieu(double b, double a, double q) {
  HillSystem s;
  s.mass = Eigen::MatrixXd::Ones(1, 1);
  s.damping = Eigen::MatrixXd::Constant(1, 1, b);
  s.stiffness[0] = FourierSeries(1, 1);
  s.stiffness[0].c << a, -q;
  return s;
}

TEST(MathieuBoundaries, AreThoseOfTheTable) {
  std::ifstream file(HB_SOURCE_DIR "/tests/reference/mathieu_characteristic.csv");
  int compared = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line[0] == 'f') continue;
    std::istringstream row(line);
    std::string function, m, q, scipy, value;
    for (std::string* cell : {&function, &m, &q, &scipy, &value}) std::getline(row, *cell, ',');
    const long double wanted = std::stold(value), at = std::stod(q);
    const long double here =
        function == "a" ? reference::mathieu_a(std::stoi(m), at) : reference::mathieu_b(std::stoi(m), at);
    EXPECT_NEAR(double(here - wanted), 0, 1e-16 * std::max(1.0L, std::abs(wanted))) << line;
    ++compared;
  }
  EXPECT_EQ(compared, 225);
}

// A relative 1e-6 inside each tongue it is unstable, as far outside it is not: undamped motion is then bounded, its
// growth zero, motion damped by delta has the growth -delta/2 exactly (a + delta^2/4 takes the place of a).
TEST(MathieuBoundaries, VerdictsAreRightAMillionthOnEitherSideUpToQ50) {
  constexpr double relative = 1e-6, delta = 1e-5;
  int inside = 0, outside = 0;
  for (int step = 1; step <= stress::multiplied(25); ++step) {
    const double q = 50.0 * step / stress::multiplied(25);
    for (int m = 0; m <= 6; ++m) {
      const long double a = reference::mathieu_a(m, q), next = reference::mathieu_b(m + 1, q);
      const long double before = m > 0 ? reference::mathieu_b(m, q) : -HUGE_VALL;
      for (const auto& [boundary, up] : {std::pair{a, 1}, std::pair{before, -1}}) {
        if (!std::isfinite(boundary)) continue;
        const long double away = relative * std::max<long double>(1, std::abs(boundary));
        const std::string what = "q " + std::to_string(q) + " m " + std::to_string(m) + (up > 0 ? " upper" : " lower");
        // Inside the tongue, if it is that wide.
        const double in = double(boundary - up * away);
        if (a - before > 2 * away) {
          ++inside;
          EXPECT_EQ(analyse_stability(mathieu(0, in, q), 2).verdict, Verdict::unstable) << what;
        }
        // Outside, if the next tongue has not begun.
        const long double gap = up > 0 ? next - a : before - reference::mathieu_a(m - 1, q);
        if (gap > 2 * away) {
          ++outside;
          const double out = double(boundary + up * away);
          const Stability undamped = analyse_stability(mathieu(0, out, q), 2);
          EXPECT_EQ(undamped.verdict, Verdict::bounded) << what;
          EXPECT_EQ(undamped.growth_rate, 0) << what;
          const Stability damped = analyse_stability(mathieu(delta, out + delta * delta / 4, q), 2);
          EXPECT_EQ(damped.verdict, Verdict::stable)
              << what << ", growth " << damped.growth_rate << " +- " << damped.growth_error;
          EXPECT_LE(std::abs(damped.growth_rate + delta / 2), damped.growth_error) << what;
        }
      }
    }
  }
  EXPECT_GE(inside, 200);
  EXPECT_GE(outside, 150);
}

// Stiffness a + c over half the turn, a - c over the other: multipliers of the product of two maps.
TEST(Meissner, GrowthOfTheJumpIsTheLimitOfItsFourierSeries) {
  const double a = 0.3, c = 0.25, b = 0.02, Omega = 1;
  const auto half_turn = [&](double k) {
    const double w = std::sqrt(k - b * b / 4), T = std::numbers::pi / Omega, e = std::exp(-b * T / 2);
    Eigen::Matrix2d m;
    m << std::cos(w * T) + b / (2 * w) * std::sin(w * T), std::sin(w * T) / w, -k / w * std::sin(w * T),
        std::cos(w * T) - b / (2 * w) * std::sin(w * T);
    return Eigen::Matrix2d(e * m);
  };
  const Eigen::Matrix2d turn = half_turn(a - c) * half_turn(a + c);
  const double trace = turn.trace(), det = turn.determinant();
  const std::complex<double> root = std::sqrt(std::complex<double>(trace * trace / 4 - det, 0));
  const double exact =
      std::log(std::max(std::abs(trace / 2 + root), std::abs(trace / 2 - root))) / (2 * std::numbers::pi);
  ASSERT_GT(exact, 0.01);
  double last = HUGE_VAL;
  for (const Eigen::Index H : {20, 80, 320}) {
    HillSystem s = mathieu(b, a, 0);
    s.stiffness[0] = FourierSeries(1, H);
    s.stiffness[0].c(0, 0) = a;
    // Square wave of amplitude c, even about a quarter turn: 4c/(pi k) sin(k tau), k odd.
    for (Eigen::Index k = 1; k <= H; k += 2) s.stiffness[0].c(0, k) = {0, -2 * c / (std::numbers::pi * double(k))};
    const Stability result = analyse_stability(s, Omega);
    EXPECT_EQ(result.verdict, Verdict::unstable);
    const double error = std::abs(result.growth_rate - exact);
    // What is left out, 1/k, acts through its double integral: the error falls at least like 1/H^2.
    EXPECT_LE(error, last / 10);
    last = error;
    const auto reference_growth = reference::floquet_exponents(s, Omega).front();
    EXPECT_LE(std::abs(result.growth_rate - double(reference_growth.value.real())),
              result.growth_error + double(reference_growth.error));
  }
  EXPECT_LE(last, 1e-5);
}

// Two undamped modes 1 and 2, coupled: C_12 = C_21 = e cos(Omega t) is unstable about Omega = w1 + w2 and only there;
// C_12 = -C_21 about Omega = w2 - w1.
TEST(CombinationResonance, SumForSymmetricAndDifferenceForSkewCoupling) {
  for (const double sign : {1.0, -1.0})
    for (const double Omega : {3.0, 1.0}) {
      HillSystem s;
      s.mass = Eigen::Matrix2d::Identity();
      s.damping = 1e-3 * Eigen::Matrix2d::Identity();
      s.stiffness[0] = FourierSeries(4, 1);
      s.stiffness[0].c(0, 0) = 1;
      s.stiffness[0].c(3, 0) = 4;
      s.stiffness[0].c(1, 1) = 0.05;
      s.stiffness[0].c(2, 1) = sign * 0.05;
      const bool unstable = (sign > 0) == (Omega == 3);
      const Stability result = analyse_stability(s, Omega);
      EXPECT_EQ(result.verdict, unstable ? Verdict::unstable : Verdict::stable) << sign << " " << Omega;
      // First order: growth = |c| / (2 sqrt(w1 w2)) - b/2, c the coefficient of e^{i Omega t}.
      if (unstable) {
        EXPECT_NEAR(result.growth_rate, 0.05 / (2 * std::sqrt(2.0)) - 5e-4, 5e-4);
      }
    }
}

TEST(Units, ExponentsKeepTheirDigitsWhateverTheUnitOfMassLengthAndTime) {
  for (int trial = 0; trial < 20; ++trial) {
    stress::Random random(std::uint64_t(trial) + 77);
    const stress::Trial t = stress::random_trial(stress::Family::plain, random, 4);
    const Stability plain = analyse_stability(t.system, t.speed);
    // kg, mm, s instead of kg, m, s scales the equations by 1000; milliseconds scale the speed.
    stress::Trial other = t;
    const double rows = 1000, time = 1e-3;
    other.speed *= time;
    other.system.mass *= rows;
    other.system.damping *= rows * time;
    other.system.stiffness[0].c *= rows * time * time;
    const Stability scaled = analyse_stability(other.system, other.speed);
    EXPECT_EQ(plain.verdict, scaled.verdict) << trial;
    EXPECT_LE(std::abs(scaled.growth_rate / time - plain.growth_rate), scaled.growth_error / time + plain.growth_error)
        << trial;
    EXPECT_NEAR(scaled.growth_rate / time, plain.growth_rate, 1e-9 * std::abs(plain.growth_rate) + 1e-11 * t.speed)
        << trial;
  }
}

TEST(ManyModes, SixtyRitzTermsGiveTheLeadingExponentsOfTen) {
  const Linkage linkage = six_link::linkage({.J = 45});
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const Body& rod = *body_at(linkage, coefficients.links[0]);
  const double Omega = 1500 * std::numbers::pi / 30;
  const Stability ten = analyse_stability(ritz_system(rod, coefficients.rods[0], 10), Omega, {.leading_only = true});
  const Stability sixty = analyse_stability(ritz_system(rod, coefficients.rods[0], 60), Omega, {.leading_only = true});
  EXPECT_EQ(ten.verdict, sixty.verdict);
  EXPECT_NE(sixty.verdict, Verdict::undecided);
  // The terms left out pull at the first like 1/i^4 and faster.
  EXPECT_NEAR(sixty.growth_rate, ten.growth_rate, 1e-4 * std::abs(ten.growth_rate));
}

}  // namespace
}  // namespace hb
