// Hill's determinant, scalar and of systems, against propagation, known boundaries and the full Hill spectrum.
#include "hb/engine/exponents/hill_determinant.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "hb/engine/exponents/mathieu_determinant.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "tests/support/long_double_floquet.hpp"
#include "tests/support/mathieu_boundaries.hpp"
#include "tests/support/random_hill_system.hpp"

namespace hb {
namespace {

using cplx = std::complex<double>;

// x'' + b x' + (w2 + 2 q cos tau) x = 0.
HillSystem mathieu(const MathieuEquation& equation) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Ones(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, equation.b);
  system.stiffness[0] = FourierSeries(1, 1);
  system.stiffness[0].c << equation.w2, equation.q;
  return system;
}

// w1 = 1, w2 = 2.3, damping b each, coupled by symmetric cos tau and a little cos 2 tau on the diagonal.
HillSystem two_modes(double b, double coupling) {
  HillSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.damping = b * Eigen::Matrix2d::Identity();
  system.stiffness[0] = FourierSeries(4, 2);
  system.stiffness[0].c.col(0) << 1, 0, 0, 2.3 * 2.3;
  system.stiffness[0].c.col(1) << 0, coupling, coupling, 0;
  system.stiffness[0].c.col(2) << coupling / 3, 0, 0, coupling / 2;
  return system;
}

// Largest distance of an exponent from the nearest of the reference, beyond both bars; imaginary parts modulo speed.
double beyond_bars(const Stability& result, const std::vector<reference::FloquetExponent>& exact, double speed) {
  double worst = 0;
  for (const auto* list : {&result.exponents, &result.uncertain})
    for (const Exponent& e : *list) {
      double nearest = HUGE_VAL;
      for (const auto& r : exact) {
        const double turn = std::remainder(double(e.value.imag() - r.value.imag()), speed);
        nearest = std::min(nearest, std::hypot(double(e.value.real() - r.value.real()), turn) - double(r.error));
      }
      worst = std::max(worst, nearest - e.error);
    }
  return worst;
}

TEST(MathieuDeterminant, ExponentsAreThoseOfPropagationInLongDouble) {
  stress::Random random(11);
  double largest_bar = 0;
  for (int trial = 0; trial < stress::multiplied(150); ++trial) {
    MathieuEquation equation;
    equation.w2 = random.power(-1.5, 1.5) * (random.chance(0.1) ? -0.1 : 1);
    equation.q = std::abs(equation.w2) * random.power(-3, 0);
    equation.b = random.chance(0.2) ? 0 : random.power(-4, 0);
    const auto pair = mathieu_exponents(equation);
    ASSERT_TRUE(pair) << equation.w2 << " " << equation.q;
    const auto exact = reference::floquet_exponents(mathieu(equation), 1);
    for (int i : {0, 1}) {
      double nearest = HUGE_VAL;
      for (const auto& r : exact) {
        const cplx s = pair->s[std::size_t(i)];
        const double turn = std::remainder(double(s.imag() - r.value.imag()), 1.0);
        nearest = std::min(nearest, std::hypot(double(s.real() - r.value.real()), turn) - double(r.error));
      }
      EXPECT_LE(nearest, pair->error[std::size_t(i)])
          << "w^2 " << equation.w2 << " q " << equation.q << " b " << equation.b;
      largest_bar = std::max(largest_bar, pair->error[std::size_t(i)]);
    }
  }
  EXPECT_LE(largest_bar, 1e-10);
}

// Undamped, 1e-12 on either side of a_m and b_m: growth on one side, none on the other.
TEST(MathieuDeterminant, TellsTheSidesOfABoundaryApartAt1em12) {
  int compared = 0;
  for (const double q : {0.5, 2.0, 5.0})
    for (int m = 1; m <= 4; ++m)
      for (const int upper : {0, 1}) {
        const long double boundary = upper ? reference::mathieu_a(m, q) : reference::mathieu_b(m, q);
        if (reference::mathieu_a(m, q) - reference::mathieu_b(m, q) < 1e-6L) continue;
        const double step = 1e-12 * std::max(1.0, std::abs(double(boundary))) * (upper ? -1 : 1);
        // x'' + (a - 2 q cos 2t) x = 0 in tau = 2t.
        const auto growth = [&](double a) {
          const auto pair = mathieu_exponents({.w2 = a / 4, .q = q / 4});
          EXPECT_TRUE(pair);
          return pair->s[0].real();
        };
        EXPECT_GT(growth(double(boundary) + 4 * step), 0) << m << " " << q;
        EXPECT_EQ(growth(double(boundary) - 4 * step), 0) << m << " " << q;
        ++compared;
      }
  EXPECT_GE(compared, 20);
}

TEST(MathieuDeterminant, IsNotTakenWhereItsRecurrencesWouldBeTooLong) {
  EXPECT_FALSE(mathieu_exponents({.w2 = 1e7, .q = 1e6}));
  EXPECT_TRUE(mathieu_exponents({.w2 = 1e4, .q = 1}));
}

TEST(HillDeterminant, IsTheProductOfSinesOverTheExponents) {
  const HillSystem system = two_modes(0.05, 0.4);
  const double Omega = 1.3;
  const auto exact = reference::floquet_exponents(system, Omega);
  ASSERT_EQ(exact.size(), 4u);
  const HillDeterminant F(scale_system(system, Omega));
  for (const cplx s : {cplx(0, 0), cplx(0.3, 0.2), cplx(-0.1, 0.5)}) {
    cplx product = 1;
    for (const auto& e : exact) {
      const cplx exponent = cplx(double(e.value.real()), double(e.value.imag())) / Omega;
      product *= 2.0 * std::sinh(std::numbers::pi * (s - exponent));
    }
    const auto value = F(s);
    // Exponents are known up to multiples of i: the product up to its sign.
    const cplx ratio = std::exp(value.log) / product;
    EXPECT_NEAR(std::abs(ratio), 1, value.error + 1e-12) << s;
    EXPECT_NEAR(std::abs(ratio.real()), 1, value.error + 1e-12) << s;
  }
}

// The determinant settled on a wrong value, off by 1e-2, where the harmonics outside the core were no multiple of P:
// the block next to the core was narrower than what the one outside it reaches.
TEST(HillDeterminant, OfStrongModulationWithSeveralHarmonicsIsTheProductOfSines) {
  for (const Eigen::Index P : {2, 3, 4, 5})
    for (const double strength : {0.6, 1.2, 2.0, 3.0}) {
      HillSystem system;
      system.mass = Eigen::MatrixXd::Ones(1, 1);
      system.damping = Eigen::MatrixXd::Constant(1, 1, 0.15);
      system.stiffness[0] = FourierSeries(1, P);
      system.stiffness[0].c(0, 0) = 7.4;
      for (Eigen::Index k = 1; k <= P; ++k)
        system.stiffness[0].c(0, k) = 7.4 * strength * std::polar(0.3, 1.1 * double(k));
      const auto exact = reference::floquet_exponents(system, 1);
      const HillDeterminant F(scale_system(system, 1));
      for (const cplx s : {cplx(0.05, 0.2), cplx(-0.1, 0.45)}) {
        cplx product = 1;
        for (const auto& e : exact)
          product *= 2.0 * std::sinh(std::numbers::pi * (s - cplx(double(e.value.real()), double(e.value.imag()))));
        const auto value = F(s);
        EXPECT_LT(value.error, 1e-6) << P << ' ' << strength;
        EXPECT_NEAR(std::abs(std::exp(value.log) / product), 1, value.error + 1e-12)
            << P << ' ' << strength << ' ' << s;
      }
    }
}

TEST(HillDeterminant, AtZeroAndHalfItIsRealAndChangesSignAtTheBoundaries) {
  // Boundaries of the tongue at twice the frequency, -1, in reference/mathieu_characteristic: a_1 and b_1.
  const double q = 0.7;
  const auto at = [&](long double a, double s) {
    const HillDeterminant F(scale_system(mathieu({.w2 = double(a) / 4, .q = q / 4}), 1));
    return std::exp(F(cplx(0, s)).log);
  };
  for (const long double boundary : {reference::mathieu_b(1, q), reference::mathieu_a(1, q)}) {
    const cplx below = at(boundary - 1e-6L, 0.5), above = at(boundary + 1e-6L, 0.5);
    EXPECT_LT(below.real() * above.real(), 0);
    EXPECT_NEAR(below.imag(), 0, 1e-12);
  }
  for (const long double boundary : {reference::mathieu_b(2, q), reference::mathieu_a(2, q)}) {
    const cplx below = at(boundary - 1e-6L, 0), above = at(boundary + 1e-6L, 0);
    EXPECT_LT(below.real() * above.real(), 0);
    EXPECT_NEAR(below.imag(), 0, 1e-12);
  }
}

TEST(HillDeterminant, ExponentsAndTheirNumberAreThoseOfPropagation) {
  int stable = 0, unstable = 0, unclear = 0;
  for (const double coupling : {0.1, 0.4, 0.9})
    for (double Omega = 0.9; Omega < 5; Omega += 0.2) {
      const HillSystem system = two_modes(0.02, coupling);
      const Stability result = analyse_stability(system, Omega, {.method = StabilityMethod::determinant});
      const auto exact = reference::floquet_exponents(system, Omega);
      EXPECT_LE(beyond_bars(result, exact, Omega), 0) << coupling << " " << Omega;
      int growing = 0;
      for (const auto& e : exact) growing += e.value.real() > 0;
      const auto counted = HillDeterminant(scale_system(system, Omega)).exponents_above(0);
      if (!counted || result.verdict == Verdict::undecided) {
        ++unclear;
        continue;
      }
      EXPECT_EQ(*counted, growing) << coupling << " " << Omega;
      EXPECT_EQ(result.verdict == Verdict::unstable, growing > 0) << coupling << " " << Omega;
      (growing > 0 ? unstable : stable) += 1;
    }
  EXPECT_GE(stable, 10);
  EXPECT_GE(unstable, 10);
  EXPECT_LE(unclear, 5);
}

TEST(HillDeterminant, BarsHoldOnRandomSystems) {
  int decided = 0;
  for (int trial = 0; trial < stress::multiplied(40); ++trial) {
    stress::Random random(std::uint64_t(trial) + 500);
    const stress::Trial t = stress::random_trial(stress::Family::plain, random, 2);
    const Stability result = analyse_stability(t.system, t.speed, {.method = StabilityMethod::determinant});
    const auto exact = reference::floquet_exponents(t.system, t.speed);
    EXPECT_LE(beyond_bars(result, exact, t.speed), 0) << trial;
    if (result.verdict == Verdict::undecided) continue;
    ++decided;
    EXPECT_EQ(result.verdict == Verdict::unstable, exact.front().value.real() > 0) << trial;
  }
  EXPECT_GE(decided, stress::multiplied(40) / 2);
}

// Modes as of a bent rod with internal damping: the resonances of the faster ones lie outside the harmonics of the
// window, and what is left of the determinant is nearly one factor at all s.
TEST(HillDeterminant, OfManyModesTellsTheLeadingExponent) {
  constexpr Eigen::Index I = 6;
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(I, I), along(I, I);
  system.damping = mean;
  for (Eigen::Index i = 0; i < I; ++i) {
    const double w = 9.2 * double((i + 1) * (i + 1));
    mean(i, i) = w * w;
    system.damping(i, i) = 0.006 * w * w;
    for (Eigen::Index j = 0; j < I; ++j) along(i, j) = 0.4 * double((i + 1) * (j + 1)) * ((i + j) % 2 == 0 ? 1 : 0.3);
  }
  system.stiffness[0] = FourierSeries(I * I, 12);
  system.stiffness[0].c.col(0) = mean.reshaped().cast<cplx>();
  for (Eigen::Index k = 1; k <= 12; ++k) system.stiffness[0].c.col(k) = std::pow(0.5, double(k)) * along.reshaped();
  for (const double speed : {0.93, 1.0}) {
    const Stability expected = analyse_stability(system, speed, {.tolerance = 1e-12});
    const Stability found = analyse_stability(system, speed, {.method = StabilityMethod::determinant});
    ASSERT_LT(expected.growth_error, 1e-9);
    EXPECT_EQ(found.verdict, Verdict::stable) << speed;
    EXPECT_LT(found.growth_error, 1e-2) << speed;
    EXPECT_LE(std::abs(found.growth_rate - expected.growth_rate), found.growth_error + expected.growth_error) << speed;
  }
}

TEST(HillDeterminant, RefusesCoupledDamping) {
  HillSystem system = two_modes(0.1, 0.3);
  system.damping << 0.1, 0.04, -0.04, 0.1;
  EXPECT_THROW(HillDeterminant(scale_system(system, 1)), std::invalid_argument);
  EXPECT_EQ(analyse_stability(system, 1, {.method = StabilityMethod::determinant}).verdict, Verdict::undecided);
}

// All eigenvalues of the truncated Hill matrix of a small system: every exponent is one of them, but sorting them by
// size would not find it.
TEST(HillSpectrum, ContainsTheExponents) {
  for (const double Omega : {1.3, 2.05, 3.4}) {
    const ScaledSystem system = scale_system(two_modes(0.05, 0.6), Omega);
    const Eigen::Index I = 2, H = 20, n = I * (2 * H + 1);
    Eigen::MatrixXcd A = Eigen::MatrixXcd::Zero(2 * n, 2 * n);  // of (x, (d/dtau + s) x)
    for (Eigen::Index k = -H; k <= H; ++k)
      for (Eigen::Index i = 0; i < I; ++i) {
        const Eigen::Index row = (k + H) * I + i;
        A(row, row) = A(n + row, n + row) = cplx(0, -double(k));
        A(row, n + row) = 1;
        for (Eigen::Index j = 0; j < I; ++j) A(n + row, n + (k + H) * I + j) -= system.G(i, j);
        for (Eigen::Index m = -system.K.num_harmonics(); m <= system.K.num_harmonics(); ++m) {
          if (std::abs(k - m) > H) continue;
          for (Eigen::Index j = 0; j < I; ++j) {
            const cplx c = system.K.c(i + I * j, std::abs(m));
            A(n + row, (k - m + H) * I + j) -= m >= 0 ? c : std::conj(c);
          }
        }
      }
    const Eigen::VectorXcd spectrum = Eigen::ComplexEigenSolver<Eigen::MatrixXcd>(A, false).eigenvalues();
    const Stability result = analyse_stability(two_modes(0.05, 0.6), Omega);
    ASSERT_EQ(result.exponents.size(), 4u);
    for (const Exponent& e : result.exponents) {
      const double nearest = (spectrum.array() - e.value / Omega).abs().minCoeff();
      EXPECT_LE(nearest, 1e-9) << Omega << " " << e.value;
    }
  }
}

}  // namespace
}  // namespace hb
