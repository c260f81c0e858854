// Exponents by the phase function: against closed forms, Mathieu's characteristic exponent by propagation, and its
// refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "hb/engine/exponents/radau_turn.hpp"
#include "hb/engine/exponents/scalar_hill.hpp"
#include "hb/engine/exponents/turn_exponents.hpp"

namespace {

using namespace hb;
using cplx = std::complex<double>;

FourierSeries series(double mean, double cosine) {
  FourierSeries s(1, 1);
  s.c(0, 0) = mean;
  s.c(0, 1) = 0.5 * cosine;
  return s;
}

double folded(double x) { return x - std::round(x); }

TEST(PhaseFunction, IsExactForConstantCoefficients) {
  for (const double w : {3.0, 250.0, 40000.0}) {
    const double b = 0.01 * w;
    const auto pair = phase_exponents(series(w * w, 0), series(b, 0), 0, 0, 1e-9 * w);
    ASSERT_TRUE(pair) << w;
    const cplx s(-b / 2, std::sqrt(w * w - b * b / 4));
    for (int k = 0; k < 2; ++k) {
      const cplx found = pair->s[static_cast<std::size_t>(k)];
      EXPECT_LE(std::abs(found - (found.imag() > 0 ? s : std::conj(s))),
                pair->error[static_cast<std::size_t>(k)] + 1e-15 * w)
          << w;
    }
  }
}

TEST(PhaseFunction, AgreesWithPropagationWithinItsBar) {
  const FourierSeries alpha = series(900, 150), beta = series(0.3, 0);
  const auto pair = phase_exponents(alpha, beta, 0, 0, 1e-9);
  ASSERT_TRUE(pair);
  const TurnExponents turned =
      turn_exponents(radau_turn(alpha, beta, 1, radau_cells(160)), Eigen::MatrixXd::Zero(2, 2));
  ASSERT_EQ(turned.s.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(pair->s[k].real(), -0.15, pair->error[k] + 1e-14);
    double nearest = HUGE_VAL;
    for (const cplx s : turned.s) nearest = std::min(nearest, std::abs(folded(s.imag() - pair->s[k].imag())));
    EXPECT_LE(nearest, pair->error[k] + 1e-11);
  }
}

TEST(PhaseFunction, BarContainsWhatTheCoefficientsAreNotKnownTo) {
  const auto exact = phase_exponents(series(400, 30), series(0.1, 0), 0, 0, 1e-6);
  const auto known = phase_exponents(series(400, 30), series(0.1, 0), 1e-4, 0, 1e-3);
  const auto moved = phase_exponents(series(400 + 1e-4, 30), series(0.1, 0), 0, 0, 1e-6);
  ASSERT_TRUE(exact && known && moved);
  const double change = std::abs(moved->s[0] - exact->s[0]);
  EXPECT_GT(change, 1e-6);
  EXPECT_GE(known->error[0], change);
}

// The looser the tolerance, the more is left to the frequency's first-order correction, at and next to resonances too.
TEST(PhaseFunction, ErrorHoldsWhateverIsLeftOfTheEquation) {
  std::mt19937 random(20261127);
  std::uniform_real_distribution<double> uniform(0, 1);
  int settled = 0, corrected = 0;
  for (int system = 0; system < 300; ++system) {
    const double half = std::floor(8 + 40 * uniform(random)) / 2;
    const double w = system % 2 == 0 ? half + 0.01 * uniform(random) : half + uniform(random) / 2;
    FourierSeries alpha(1, 4), beta(1, 2);
    alpha.c(0, 0) = w * w;
    for (int k = 1; k <= 4; ++k)
      alpha.c(0, k) = w * w * 0.08 * cplx(uniform(random) - 0.5, uniform(random) - 0.5) / double(k);
    beta.c(0, 0) = 0.1 * uniform(random);
    beta.c(0, 1) = 0.02 * cplx(uniform(random) - 0.5, uniform(random) - 0.5);
    const TurnExponents turned =
        turn_exponents(radau_turn(alpha, beta, 1, radau_cells(190)), Eigen::MatrixXd::Zero(2, 2));
    ASSERT_EQ(turned.s.size(), 2u);
    for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) {
      const auto pair = phase_exponents(alpha, beta, 0, 0, tolerance);
      if (!pair) continue;
      ++settled;
      for (std::size_t k = 0; k < 2; ++k) {
        double off = HUGE_VAL;
        for (const cplx s : turned.s)
          off = std::min(off, std::hypot(s.real() - pair->s[k].real(), folded(s.imag() - pair->s[k].imag())));
        EXPECT_LE(pair->error[k], tolerance);
        EXPECT_LE(off, pair->error[k] + turned.error[0]) << "system " << system << " at " << tolerance;
        if (off > 1e-12) ++corrected;
      }
    }
  }
  EXPECT_GT(settled, 400);
  EXPECT_GT(corrected, 40);
}

TEST(PhaseFunction, RefusesWhereTheSquareOfTheFrequencyChangesSignOrTheExpansionDiverges) {
  EXPECT_FALSE(phase_exponents(series(1, 3), series(0, 0), 0, 0, 1e-6));
  EXPECT_FALSE(phase_exponents(series(0.25, 0.2), series(0, 0), 0, 0, 1e-9));  // the principal tongue
}

}  // namespace
