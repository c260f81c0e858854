// Stiffness made of few functions of the crank angle: found where it is, not where it is not, and its samples.
#include "hb/engine/system/modulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "hb/engine/system/stiffness_samples.hpp"
#include "lib/constants.hpp"
#include "tests/support/random_hill_system.hpp"

namespace hb {
namespace {

using Eigen::Index;

// r random functions of P harmonics that fall by a third each, in random shares; the mean is full.
FourierSeries made_of(Index r, Index I, Index P, bool symmetric, stress::Random& random, double decades = 2) {
  FourierSeries K(I * I, P);
  for (Index m = 0; m < r; ++m) {
    Eigen::MatrixXd S(I, I);
    for (Index q = 0; q < I * I; ++q) S(q) = random(-1, 1) * random.power(-decades, decades);
    if (symmetric) S = (S + S.transpose()).eval();
    for (Index k = 1; k <= P; ++k) {
      const std::complex<double> g(random(-1, 1), random(-1, 1));
      K.c.col(k) += std::pow(3.0, -double(k)) * g * S.reshaped();
    }
  }
  for (Index q = 0; q < I * I; ++q) K.c(q, 0) = random(10, 20);
  return K;
}

// Largest |K - mean - sum_m S_m g_m| over that of each entry's largest harmonic.
double left_out(const Modulation& modulation, const FourierSeries& K) {
  double largest = 0;
  for (Index q = 0; q < K.num_components(); ++q) {
    const Eigen::VectorXcd given = K.c.row(q).tail(K.num_harmonics()).transpose();
    const Eigen::VectorXcd rest = given - modulation.functions * modulation.shares.row(q).transpose();
    largest = std::max(largest, rest.cwiseAbs().maxCoeff() / given.cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(Modulation, FindsAsManyFunctionsAsThereAre) {
  stress::Random random(1);
  for (const bool symmetric : {true, false})
    for (const Index I : {3, 5, 8})
      for (const Index r : {1, 2, 3}) {
        SCOPED_TRACE(std::to_string(I) + ", " + std::to_string(r));
        const FourierSeries K = made_of(r, I, 12, symmetric, random);
        const Modulation found = modulation_of(K, I);
        // Rounding may ask for one more.
        EXPECT_GE(found.functions.cols(), r);
        EXPECT_LE(found.functions.cols(), std::min(r + 1, I * (I + 1) / 4));
        EXPECT_EQ(found.functions.rows(), 12);
        EXPECT_LE(left_out(found, K), 8 * eps);
      }
}

TEST(Modulation, IsEmptyWhereThereAreNotFew) {
  stress::Random random(2);
  EXPECT_FALSE(modulation_of(made_of(8, 5, 12, true, random), 5).found());
  EXPECT_FALSE(modulation_of(FourierSeries(25, 0), 5).found());
  EXPECT_FALSE(modulation_of(made_of(1, 1, 12, true, random), 1).found());
  EXPECT_FALSE(modulation_of(FourierSeries(25, 12), 5).found());
}

// What the first harmonics do not show is not overlooked.
TEST(Modulation, IsEmptyWhereALateHarmonicHasAFunctionOfItsOwn) {
  stress::Random random(3);
  FourierSeries K = made_of(2, 5, 12, true, random);
  ASSERT_TRUE(modulation_of(K, 5).found());
  K.c(7, 11) += 1e-12 * K.c.row(7).tail(12).cwiseAbs().maxCoeff();
  EXPECT_FALSE(modulation_of(K, 5).found());
}

// K_11 is almost nothing in the first harmonics, and a function of its own later on: in large shares that cancel, the
// samples of K_22, which has no sixth harmonic, would have what rounding leaves of one 1e10 times as large.
TEST(Modulation, IsEmptyWhereLargeTermsCancel) {
  for (const double small : {1e-4, 1e-10, 1e-14, 1e-17, 0.0}) {
    FourierSeries K(9, 6);
    K.c(0, 1) = small;
    K.c(0, 6) = 0.9;
    K.c(4, 1) = 1.1;
    K.c(4, 2) = 0.3;
    for (int i = 0; i < 3; ++i) K.c(4 * i, 0) = 2.3 * (i + 1);
    EXPECT_FALSE(modulation_of(K, 3).found()) << small;
  }
}

TEST(Modulation, NotANumberIsNoFunction) {
  stress::Random random(4);
  FourierSeries K = made_of(2, 5, 12, true, random);
  K.c(3, 2) = nan;
  EXPECT_FALSE(modulation_of(K, 5).found());
  K.c(3, 2) = 1;
  K.c(3, 10) = nan;
  EXPECT_FALSE(modulation_of(K, 5).found());
}

// By functions, and by the transform of each entry: apart by the rounding of either.
TEST(StiffnessSamples, AreThoseOfEveryEntry) {
  stress::Random random(5);
  for (const bool symmetric : {true, false})
    for (const Index N : {32, 48, 64}) {
      ScaledSystem system;
      system.G = Eigen::MatrixXd::Identity(5, 5);
      system.K = made_of(2, 5, 15, symmetric, random, 0.3);
      const Eigen::MatrixXd all = stiffness_samples(system, N);
      system.modulation = modulation_of(system.K, 5);
      ASSERT_TRUE(system.modulation.found());
      const Eigen::MatrixXd by_few = stiffness_samples(system, N);
      ASSERT_EQ(all.rows(), N);
      for (Index q = 0; q < 25; ++q) {
        double size = 0;
        for (Index k = 0; k <= 15; ++k) size += 2 * std::abs(system.K.c(q, k));
        EXPECT_LE((all.col(q) - by_few.col(q)).cwiseAbs().maxCoeff(), 8 * eps * size) << q;
      }
      const Eigen::MatrixXd direct = fourier::synthesise(system.K, N).transpose();
      EXPECT_LE((all - direct).cwiseAbs().maxCoeff(), 1e-13 * direct.cwiseAbs().maxCoeff());
    }
}

// What is slaved and solved with few functions is what it is with every entry by itself: bars hold what rounding moves.
TEST(Modulation, ChangesAnswersByRoundingAlone) {
  stress::Random random(6);
  HillSystem system;
  const Index I = 4;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = 0.1 * Eigen::MatrixXd::Identity(I, I);
  system.stiffness[0] = made_of(3, I, 8, true, random);
  system.stiffness[0].c.rightCols(8) *= 1e-3;
  for (Index j = 0; j < I; ++j)
    for (Index i = 0; i < I; ++i) system.stiffness[0].c(i + I * j, 0) = i == j ? std::pow(2.3 * double(i) + 1.4, 2) : 0;
  system.load[0] = FourierSeries(I, 3);
  for (Index q = 0; q < 4 * I; ++q) system.load[0].c(q) = random(-1, 1);
  const ScaledSystem few = scale_system(system, 1);
  ASSERT_TRUE(few.modulation.found());
  ScaledSystem every = few;
  every.modulation = {};
  const SteadyState a = solve_steady_state(few), b = solve_steady_state(every);
  ASSERT_EQ(a.status, SteadyStatus::converged);
  ASSERT_EQ(a.num_harmonics, b.num_harmonics);
  const double largest = fourier::largest_values(b.q).maxCoeff();
  EXPECT_LE(fourier::largest_values(fourier::difference(a.q, b.q)).maxCoeff(),
            (a.error_bound + b.error_bound) * largest);
  const StabilityOptions slaved{.method = StabilityMethod::slaving};
  const Stability p = analyse_stability(few, slaved), q = analyse_stability(every, slaved);
  ASSERT_EQ(p.exponents.size(), 2u * I);
  ASSERT_EQ(q.exponents.size(), 2u * I);
  for (std::size_t i = 0; i < p.exponents.size(); ++i)
    EXPECT_LE(std::abs(p.exponents[i].value - q.exponents[i].value), p.exponents[i].error + q.exponents[i].error);
}

}  // namespace
}  // namespace hb
