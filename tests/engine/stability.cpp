#include "hb/engine/exponents/stability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "lib/constants.hpp"
#include "lib/rod/rod.hpp"
#include "tests/support/six_link.hpp"

using namespace hb;
using cplx = std::complex<double>;

namespace {

// x'' + b x' + (a + c cos Omega t) x = 0.
HillSystem mathieu(double b, double a, double c) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Ones(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, b);
  system.stiffness[0] = FourierSeries(1, 1);
  system.stiffness[0].c << a, c / 2;
  return system;
}

// Modes omega_i = w1 i or w1 i^2 with modal and internal damping, random symmetric coupling decaying as 2^-k.
HillSystem random_system(std::mt19937& generator, Eigen::Index most_modes) {
  std::uniform_real_distribution<double> sign(-1, 1), part(0, 1);
  const Eigen::Index I = 1 + Eigen::Index(part(generator) * double(most_modes)),
                     P = 1 + Eigen::Index(part(generator) * 6);
  const double modulation = 0.8 * std::pow(10, -2 * part(generator));
  const double zeta = part(generator) < 0.3 ? 0 : 0.5 * std::pow(10, -4 * part(generator));
  const double internal = part(generator) < 0.4 ? 0 : std::pow(10, -3 * part(generator));
  const double w1 = std::pow(10, -0.5 + 2 * part(generator));
  const bool beam = part(generator) < 0.5;
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = Eigen::MatrixXd::Zero(I, I);
  system.stiffness[0] = FourierSeries(I * I, P);
  Eigen::VectorXd w(I);
  for (Eigen::Index i = 0; i < I; ++i) {
    w(i) = w1 * double(beam ? (i + 1) * (i + 1) : i + 1);
    system.damping(i, i) = 2 * zeta * w(i) + internal * w(i) * w(i) / w1;
    system.stiffness[0].c(i + I * i, 0) = w(i) * w(i);
  }
  for (Eigen::Index k = 1; k <= P; ++k)
    for (Eigen::Index i = 0; i < I; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) {
        const cplx z = modulation * std::pow(0.5, k) * w(i) * w(j) / (1.0 + double(i - j)) *
                       cplx(sign(generator), sign(generator)) * 0.5;
        system.stiffness[0].c(i + I * j, k) = system.stiffness[0].c(j + I * i, k) = z;
      }
  return system;
}

// Distance of two exponents, imaginary parts modulo Omega.
double strip_distance(cplx a, cplx b, double Omega) {
  double turn = std::fmod(std::abs(a.imag() - b.imag()), Omega);
  turn = std::min(turn, Omega - turn);
  return std::hypot(a.real() - b.real(), turn);
}

}  // namespace

TEST(Stability, PrincipalMathieuTongueIsUnstableAtEverySpeedInsideIt) {
  for (const double Omega : {2.05, 2.10, 2.15, 2.20, 2.25, 2.30})
    for (const auto method :
         {StabilityMethod::automatic, StabilityMethod::hill, StabilityMethod::slaving, StabilityMethod::propagation}) {
      const Stability result = analyse_stability(mathieu(0.1, 1.2, 0.4), Omega, {.method = method});
      EXPECT_EQ(result.verdict, Verdict::unstable) << Omega;
      EXPECT_NEAR(result.exponents.front().value.imag(), Omega / 2, 1e-12) << "period doubling";
    }
}

TEST(Stability, MathieuTongueBoundariesAreWhereTheyBelongTo1em10) {
  const HillSystem system = mathieu(0.1, 1.2, 0.4);
  // To more digits than published: propagation by Taylor series, 30 digits.
  const double left = 2.03252467198976858, right = 2.33736800003823030;
  for (const double boundary : {left, right}) {
    const double inside = boundary == left ? 1 : -1;
    EXPECT_EQ(analyse_stability(system, boundary * (1 - inside * 1e-10)).verdict, Verdict::stable);
    EXPECT_EQ(analyse_stability(system, boundary * (1 + inside * 1e-10)).verdict, Verdict::unstable);
  }
}

TEST(Stability, MathieuMultipliersAreThePublishedOnes) {
  const Stability result = analyse_stability(mathieu(0.1, 1.2, 0.4), 1.0);
  ASSERT_EQ(result.exponents.size(), 2u);
  for (const int i : {0, 1}) {
    const cplx multiplier = std::exp(result.exponents[std::size_t(i)].value * 2.0 * pi);
    EXPECT_NEAR(multiplier.real(), 0.63284681, 6e-9);
    EXPECT_NEAR(std::abs(multiplier.imag()), 0.36468206, 6e-9);
  }
  EXPECT_EQ(result.verdict, Verdict::stable);
}

TEST(Stability, ConstantCoefficientsGiveTheRootsOfTheCharacteristicEquation) {
  // Diagonal: underdamped, critically damped, overdamped, statically unstable.
  HillSystem system;
  system.mass = Eigen::Vector4d(2, 1, 1, 1).asDiagonal();
  system.damping = Eigen::Vector4d(0.4, 2, 50, 0.1).asDiagonal();
  system.stiffness[0] = FourierSeries(16, 0);
  const Eigen::Vector4d k(8, 1, 1, -0.01);
  for (int i = 0; i < 4; ++i) system.stiffness[0].c(5 * i, 0) = k(i);
  const double Omega = 1.3;
  const Stability result = analyse_stability(system, Omega);
  ASSERT_EQ(result.exponents.size(), 8u);
  EXPECT_EQ(result.verdict, Verdict::unstable);
  std::vector<cplx> wanted;
  for (int i = 0; i < 4; ++i) {
    const double m = system.mass(i, i), b = system.damping(i, i);
    const cplx root = std::sqrt(cplx(b * b - 4 * m * k(i), 0));
    wanted.push_back((-b + root) / (2 * m));
    wanted.push_back((-b - root) / (2 * m));
  }
  for (const cplx w : wanted) {
    double nearest = HUGE_VAL;
    for (const Exponent& e : result.exponents)
      nearest = std::min(nearest, std::max(0.0, strip_distance(e.value, w, Omega) - e.error));
    EXPECT_LE(nearest, 1e-13 * std::max(1.0, std::abs(w))) << w;
  }
}

TEST(Stability, CoupledConstantCoefficientsFollowTheQuadraticEigenproblem) {
  // Equal masses and springs in a row: omega^2 = 1 and 3, damping 0.02 in each.
  HillSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.damping = 0.02 * Eigen::Matrix2d::Identity();
  system.stiffness[0] = FourierSeries(4, 0);
  system.stiffness[0].c << 2, -1, -1, 2;
  const double Omega = 10;
  const Stability result = analyse_stability(system, Omega);
  ASSERT_EQ(result.exponents.size(), 4u);
  EXPECT_NEAR(result.growth_rate, -0.01, 1e-14);
  for (const double w2 : {1.0, 3.0}) {
    const double frequency = std::sqrt(w2 - 1e-4);
    EXPECT_TRUE(std::any_of(result.exponents.begin(), result.exponents.end(),
                            [&](const Exponent& e) { return std::abs(e.value.imag() - frequency) < 1e-13; }));
  }
}

TEST(Stability, UndampedMotionIsBoundedNeverStable) {
  for (const auto method :
       {StabilityMethod::automatic, StabilityMethod::hill, StabilityMethod::slaving, StabilityMethod::propagation}) {
    const Stability result = analyse_stability(mathieu(0, 1.2, 0.1), 1.0, {.method = method});
    EXPECT_EQ(result.verdict, Verdict::bounded);
    EXPECT_EQ(result.growth_rate, 0);
    EXPECT_EQ(result.growth_error, 0);
    ASSERT_EQ(result.exponents.size(), 2u);
    for (const Exponent& e : result.exponents) EXPECT_EQ(e.value.real(), 0);
  }
}

TEST(Stability, SixLinkExponentsMatchTheIndependentReferenceWithinTheirBars) {
  std::ifstream file(HB_SOURCE_DIR "/tests/reference/six_link.json");
  const auto reference = nlohmann::json::parse(file);
  int compared = 0;
  for (const auto& entry : reference["cases"]) {
    const Linkage linkage = six_link::linkage({.J = entry["J"]});
    const LinkageCoefficients coefficients = linkage_coefficients(linkage);
    const double Omega = double(entry["rpm"]) * pi / 30;
    for (std::size_t rod = 0; rod < coefficients.links.size(); ++rod) {
      const Body& link = *body_at(linkage, coefficients.links[rod]);
      const HillSystem system = ritz_system(link, coefficients.rods[rod], entry["modes"]);
      const Stability result = analyse_stability(system, Omega);
      double leading = -HUGE_VAL;
      for (const auto& wanted : entry["rods"][link.name]["exponents"]) {
        const cplx value(wanted[0], wanted[1]);
        leading = std::max(leading, value.real());
        double nearest = HUGE_VAL;
        for (const Exponent& e : result.exponents)
          nearest = std::min(nearest, strip_distance(e.value, value, Omega) - e.error);
        // The reference's own error: 1e-9 relative for what it propagates.
        EXPECT_LE(nearest, 1e-9 * std::max(1.0, std::abs(value)))
            << link.name << " J " << entry["J"] << " rpm " << entry["rpm"] << " exponent " << value;
        ++compared;
      }
      EXPECT_NEAR(result.growth_rate, leading, 1e-9 * std::max(1.0, std::abs(leading)));
      EXPECT_EQ(result.verdict, leading < 0 ? Verdict::stable : Verdict::unstable);
      EXPECT_LE(result.growth_error, 1e-7 * std::max(1.0, std::abs(leading)));
    }
  }
  EXPECT_GE(compared, 100);
}

TEST(Stability, ExponentsOfStiffRodsSumToTheTraceOfDamping) {
  // Liouville: all 2I exponents, from -1505 to -6e5 1/s, add up to -tr(M^-1 B).
  const Linkage linkage = six_link::linkage({.J = 4500});
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  for (const double rpm : {1.0, 300.0, 3000.0, 6000.0})
    for (std::size_t rod = 0; rod < 2; ++rod) {
      const HillSystem system = ritz_system(*body_at(linkage, coefficients.links[rod]), coefficients.rods[rod], 5);
      const Stability result = analyse_stability(system, rpm * pi / 30);
      ASSERT_EQ(result.exponents.size(), 10u) << rpm;
      double sum = 0, bars = 0;
      for (const Exponent& e : result.exponents) {
        sum += e.value.real();
        bars += e.error;
      }
      const double trace = system.mass.diagonal().cwiseInverse().dot(system.damping.diagonal());
      EXPECT_LE(std::abs(sum + trace), bars + 100 * eps * trace) << rpm;
      EXPECT_LE(bars, 1e-9 * trace);
    }
}

TEST(Stability, MethodsAgreeWithinTheirBarsOnRandomSystems) {
  std::mt19937 generator(1997);
  int slaved = 0, decided = 0;
  for (int i = 0; i < 80; ++i) {
    const HillSystem system = random_system(generator, 4);
    const Stability a = analyse_stability(system, 1.0, {.method = StabilityMethod::slaving});
    const Stability b = analyse_stability(system, 1.0, {.method = StabilityMethod::propagation});
    EXPECT_LE(std::abs(a.growth_rate - b.growth_rate), a.growth_error + b.growth_error) << "system " << i;
    if (a.verdict != Verdict::undecided && b.verdict != Verdict::undecided) {
      EXPECT_EQ(a.verdict, b.verdict) << "system " << i;
      ++decided;
    }
    slaved += a.method == StabilityMethod::slaving;
  }
  EXPECT_GE(slaved, 50);
  EXPECT_GE(decided, 50);
}

TEST(Stability, LeadingExponentsAloneAreThoseOfTheFullSet) {
  std::mt19937 generator(11);
  int skipped = 0;
  for (int i = 0; i < 80; ++i) {
    const HillSystem system = random_system(generator, 5);
    const Stability all = analyse_stability(system, 1.0);
    const Stability leading = analyse_stability(system, 1.0, {.leading_only = true});
    EXPECT_LE(std::abs(all.growth_rate - leading.growth_rate), all.growth_error + leading.growth_error)
        << "system " << i;
    if (all.verdict != Verdict::undecided && leading.verdict != Verdict::undecided) {
      EXPECT_EQ(all.verdict, leading.verdict) << "system " << i;
    }
    skipped += leading.exponents.size() < all.exponents.size();
  }
  EXPECT_GE(skipped, 10);
}

TEST(Stability, OneMethodKeepsItsErrorsWhereASecondOneIsAskedOtherwise) {
  std::mt19937 generator(1683);
  int spared = 0;
  const auto second = [](const Stability& of) { return of.evidence.find("(second method") != std::string::npos; };
  for (int i = 0; i < 200; ++i) {
    const HillSystem system = random_system(generator, 5);
    const Stability both = analyse_stability(system, 1.0, {.tolerance = 1e-13});
    const Stability one = analyse_stability(system, 1.0, {.tolerance = 1e-13, .one_method = true});
    EXPECT_FALSE(second(one)) << "system " << i;
    EXPECT_EQ(one.exponents.size() + one.uncertain.size(), both.exponents.size() + both.uncertain.size());
    EXPECT_LE(std::abs(both.growth_rate - one.growth_rate), both.growth_error + one.growth_error) << "system " << i;
    EXPECT_LE(both.growth_error, one.growth_error) << "system " << i;
    if (both.verdict != Verdict::undecided && one.verdict != Verdict::undecided) {
      EXPECT_EQ(both.verdict, one.verdict) << "system " << i;
    }
    spared += second(both);
  }
  EXPECT_GE(spared, 10);
}

TEST(Stability, LeadingExponentsHaveFiniteBarsInsideATongue) {
  const Linkage linkage = six_link::linkage({.J = 45});
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  for (const double rpm : {2400.0, 3000.0, 6000.0}) {
    const HillSystem system = ritz_system(*body_at(linkage, coefficients.links[0]), coefficients.rods[0], 5);
    const Stability result = analyse_stability(system, rpm * pi / 30, {.leading_only = true});
    EXPECT_EQ(result.verdict, Verdict::unstable) << rpm;
    EXPECT_LE(result.growth_error, 1e-6 * result.growth_rate) << rpm;
  }
}

TEST(Stability, CombinationResonanceGivesAComplexUnstablePair) {
  // Two oscillators, omega = 1 and 2, cross-coupled by 0.5 cos Omega t: sum combination at Omega = 3.
  HillSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.damping = 0.02 * Eigen::Matrix2d::Identity();
  system.stiffness[0] = FourierSeries(4, 1);
  system.stiffness[0].c.col(0) << 1, 0, 0, 4;
  system.stiffness[0].c.col(1) << 0, 0.25, 0.25, 0;
  const Stability inside = analyse_stability(system, 3.0), outside = analyse_stability(system, 2.6);
  EXPECT_EQ(inside.verdict, Verdict::unstable);
  EXPECT_GT(std::abs(inside.exponents.front().value.imag()), 0.1);
  EXPECT_LT(std::abs(inside.exponents.front().value.imag()), 1.4);
  // First-order theory: growth -b/2 + (c/2)/(2 sqrt(w1 w2)), c = 0.5.
  EXPECT_NEAR(inside.growth_rate, -0.01 + 0.25 / (2 * std::sqrt(2.0)), 0.01);
  EXPECT_EQ(outside.verdict, Verdict::stable);
}

TEST(Stability, ShiftInTimeChangesNothing) {
  std::mt19937 generator(7);
  for (int i = 0; i < 10; ++i) {
    HillSystem system = random_system(generator, 3);
    const Stability before = analyse_stability(system, 1.0);
    for (Eigen::Index k = 0; k < system.stiffness[0].c.cols(); ++k)
      system.stiffness[0].c.col(k) *= std::polar(1.0, 0.7 * double(k));
    const Stability after = analyse_stability(system, 1.0);
    EXPECT_LE(std::abs(before.growth_rate - after.growth_rate), before.growth_error + after.growth_error);
  }
}

TEST(Stability, FullDampingMatricesAreCoupledRight) {
  // A gyroscopic pair with constant coefficients in disguise: tiny modulation, so that the periodic path is taken.
  HillSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.damping = (Eigen::Matrix2d() << 0.1, 0.6, -0.6, 0.1).finished();
  system.stiffness[0] = FourierSeries(4, 0);
  system.stiffness[0].c.col(0) << 2, 0.1, 0.1, 5;
  const Stability constant = analyse_stability(system, 0.9);
  system.stiffness[0] = fourier::resized(system.stiffness[0], 1);
  system.stiffness[0].c(0, 1) = 1e-9;
  for (const auto method : {StabilityMethod::slaving, StabilityMethod::propagation}) {
    const Stability periodic = analyse_stability(system, 0.9, {.method = method});
    ASSERT_EQ(periodic.exponents.size(), 4u);
    for (const Exponent& e : constant.exponents) {
      double nearest = HUGE_VAL;
      for (const Exponent& other : periodic.exponents)
        nearest = std::min(nearest, strip_distance(e.value, other.value, 0.9));
      EXPECT_LE(nearest, 1e-8);
    }
  }
}

// x'' + 0.1 x' + (a + c cos t) x = 0 and, not coupled to it, a stable one of Mathieu's equations.
HillSystem beside_a_stable_one(double a, double c) {
  HillSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.damping = 0.1 * Eigen::Matrix2d::Identity();
  system.stiffness[0] = FourierSeries(4, 1);
  system.stiffness[0].c.col(0) << 1.2, 0, 0, a;
  system.stiffness[0].c.col(1) << 0.2, 0, 0, c / 2;
  return system;
}

// What cannot be resolved is not left out: neither by a group of modes that nothing is known of, nor by frequencies
// that no number of cells resolves.
TEST(Stability, WhatIsNotResolvedIsUndecidedWhateverTheMethod) {
  for (const double stiffness : {1e16, 1e17, 1e38, 1e60, 1e200}) {
    for (const HillSystem& system :
         {mathieu(0.1, stiffness, 3 * stiffness), beside_a_stable_one(stiffness, 3 * stiffness)})
      for (const auto method : {StabilityMethod::automatic, StabilityMethod::hill, StabilityMethod::slaving,
                                StabilityMethod::propagation, StabilityMethod::bound}) {
        const Stability result = analyse_stability(system, 1, {.method = method});
        EXPECT_EQ(result.verdict, Verdict::undecided) << stiffness << " " << to_string(method);
        EXPECT_FALSE(result.converged) << stiffness << " " << to_string(method);
      }
  }
}

TEST(Stability, HillsMethodDoesNotHideTheGroupItDidNotFind) {
  const HillSystem system = beside_a_stable_one(100, 300);
  EXPECT_EQ(analyse_stability(system, 1).verdict, Verdict::unstable);
  EXPECT_NE(analyse_stability(system, 1, {.method = StabilityMethod::hill}).verdict, Verdict::stable);
}

TEST(Stability, RefusesImpossibleSpeeds) {
  for (const double speed : {0.0, -1.0, double(NAN), double(INFINITY)})
    EXPECT_THROW((void)analyse_stability(mathieu(0.1, 1, 0.1), speed), std::invalid_argument);
}
