#include "lib/fourier/fourier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "lib/constants.hpp"

using namespace hb;

namespace {

FourierSeries sampled(double (*f)(double), Eigen::Index N) {
  Eigen::MatrixXd samples(1, N);
  for (Eigen::Index j = 0; j < N; ++j) samples(0, j) = f(2 * pi * double(j) / double(N));
  return fourier::analyse(samples);
}

// 1/(1.25 - cos tau) = (4/3) sum 2^-|k| e^{ik tau}: maximum 4 at 0, minimum 4/9 at pi.
double poisson(double tau) { return 1 / (1.25 - std::cos(tau)); }

TEST(Fourier, RangeOfANarrowPeakIsTheTrueOne) {
  // Poisson's kernel 1 + 2 sum_k r^k cos k(tau - a) = (1 - r^2)/(1 - 2 r cos(tau - a) + r^2).
  const double r = 0.99, a = 2.3456;
  FourierSeries series(1, 3000);
  for (Eigen::Index k = 0; k <= 3000; ++k)
    series.c(0, k) = std::polar(std::pow(r, static_cast<double>(k)), -a * static_cast<double>(k));
  const Range range = fourier::range(series, 0);
  EXPECT_NEAR(range.max.value, (1 + r) / (1 - r), 1e-10);
  EXPECT_NEAR(range.max.crank_angle, a, 1e-9);
  EXPECT_NEAR(range.min.value, (1 - r) / (1 + r), 1e-10);
  EXPECT_NEAR(range.min.crank_angle, a + std::numbers::pi, 1e-5);
}

}  // namespace

TEST(Fourier, CoefficientsOfThePoissonKernelAreItsGeometricSeries) {
  const FourierSeries series = sampled(poisson, 128);
  for (int k = 0; k <= 40; ++k) {
    EXPECT_NEAR(series.c(0, k).real(), 4.0 / 3.0 * std::pow(0.5, k), 8 * eps);
    EXPECT_NEAR(series.c(0, k).imag(), 0, 8 * eps);
  }
}

TEST(Fourier, ThereAndBackReturnsTheSamplesForOddAndEvenLengths) {
  for (const Eigen::Index N : {1, 2, 3, 8, 27, 64, 101}) {
    Eigen::MatrixXd samples(2, N);
    for (Eigen::Index j = 0; j < N; ++j) samples.col(j) << std::sin(1.0 + double(j) * 1.7), double(j % 3);
    if (N % 2 == 0) {  // take the Nyquist term away, which a series with H = (N-1)/2 cannot hold
      Eigen::VectorXd alternating(N);
      for (Eigen::Index j = 0; j < N; ++j) alternating(j) = j % 2 ? -1 : 1;
      samples -= (samples * alternating / double(N)) * alternating.transpose();
    }
    const Eigen::MatrixXd back = fourier::synthesise(fourier::analyse(samples), N);
    EXPECT_LE((back - samples).cwiseAbs().maxCoeff(), 100 * eps) << "N = " << N;
  }
}

TEST(Fourier, DerivativeIsExactForTrigonometricPolynomials) {
  const FourierSeries series = sampled([](double t) { return std::cos(3 * t) + 0.5 * std::sin(7 * t); }, 32);
  const FourierSeries first = fourier::derivative(series), second = fourier::derivative(series, 2);
  for (const double t : {0.0, 0.3, 2.0, 5.9}) {
    EXPECT_NEAR(fourier::evaluate(first, t)(0), -3 * std::sin(3 * t) + 3.5 * std::cos(7 * t), 500 * eps);
    EXPECT_NEAR(fourier::evaluate(second, t)(0), -9 * std::cos(3 * t) - 24.5 * std::sin(7 * t), 5000 * eps);
  }
}

TEST(Fourier, RangeFindsTrueExtremaBetweenSamples) {
  const FourierSeries shifted = sampled([](double t) { return poisson(t - 1.2345); }, 256);
  const Range r = fourier::range(shifted, 0);
  EXPECT_NEAR(r.max.value, 4, 100 * eps);
  EXPECT_NEAR(r.max.crank_angle, 1.2345, 1e-8);
  EXPECT_NEAR(r.min.value, 4.0 / 9, 100 * eps);
  EXPECT_NEAR(r.min.crank_angle, 1.2345 + pi, 1e-8);
}

TEST(Fourier, RangeChoosesTheHigherOfTwoNearlyEqualPeaks) {
  // cos(40 t) peaks equally 40 times; the small cos(t - t0) decides for the peak nearest to t0.
  const double t0 = 2 * pi * 17 / 40;
  const FourierSeries series =
      sampled([](double t) { return std::cos(40 * t) + 1e-6 * std::cos(t - 2 * pi * 17 / 40); }, 128);
  const Extremum peak = fourier::max_abs(series, 0);
  EXPECT_NEAR(peak.value, 1 + 1e-6, 100 * eps);
  EXPECT_NEAR(peak.crank_angle, t0, 1e-7);
}

// From nearly one wave to hundreds, with and without a large mean and small fast waves.
std::vector<FourierSeries> functions_of_all_kinds(Eigen::Index num_components) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> phase(-pi, pi);
  std::vector<FourierSeries> functions;
  for (const double ratio : {0.05, 0.4, 0.8, 0.97})
    for (const double mean : {0.0, 3.0, 1e6})
      for (const double ripple : {0.0, 1e-9, 1e-5, 1e-2}) {
        FourierSeries f(num_components, 250);
        for (Eigen::Index i = 0; i < num_components; ++i) {
          f.c(i, 0) = mean;
          for (Eigen::Index k = 1; k <= 250; ++k) f.c(i, k) = std::polar(std::pow(ratio, double(k)), phase(random));
          f.c(i, 101) += std::polar(ripple, phase(random));
        }
        functions.push_back(f);
      }
  return functions;
}

TEST(Fourier, ExtremaAreNoLowerThanAnySampleAndLieWhereTheDerivativeVanishes) {
  for (const FourierSeries& f : functions_of_all_kinds(1)) {
    const FourierSeries slope = fourier::derivative(f), bend = fourier::derivative(f, 2);
    const Eigen::RowVectorXd samples = fourier::synthesise(f, 1 << 15).row(0);
    const Range range = fourier::range(f, 0);
    const double rounding = 100 * eps * fourier::wiener_norm(f, 0);
    EXPECT_GE(range.max.value, samples.maxCoeff() - rounding);
    EXPECT_LE(range.min.value, samples.minCoeff() + rounding);
    for (const Extremum& place : {range.min, range.max}) {
      EXPECT_NEAR(place.value, fourier::evaluate(f, place.crank_angle)(0), rounding);
      const double error =
          fourier::evaluate(slope, place.crank_angle)(0) / fourier::evaluate(bend, place.crank_angle)(0);
      EXPECT_LE(std::abs(error), 1e-10);
    }
  }
}

TEST(Fourier, RangesOfAllComponentsAreThoseOfEach) {
  std::vector<FourierSeries> functions = functions_of_all_kinds(3);
  functions.front().c.row(1).tail(250).setZero();  // a constant among them
  for (const FourierSeries& f : functions) {
    const std::vector<Range> ranges = fourier::ranges(f);
    const Eigen::VectorXd largest = fourier::largest_values(f);
    ASSERT_EQ(ranges.size(), 3U);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Range alone = fourier::range(f, i), &of = ranges[static_cast<std::size_t>(i)];
      const double rounding = 100 * eps * fourier::wiener_norm(f, i);
      EXPECT_NEAR(of.min.value, alone.min.value, rounding);
      EXPECT_NEAR(of.max.value, alone.max.value, rounding);
      EXPECT_NEAR(largest(i), fourier::max_abs(f, i).value, rounding);
    }
  }
}

TEST(Fourier, LargestLengthIsNoLowerThanThatOfAnySample) {
  for (const FourierSeries& f : functions_of_all_kinds(2)) {
    const double sampled = fourier::synthesise(f, 1 << 15).colwise().norm().maxCoeff();
    const Extremum peak = fourier::largest_length(f);
    EXPECT_GE(peak.value, sampled * (1 - 100 * eps));
    EXPECT_LE(peak.value, sampled * (1 + 1e-4));
    EXPECT_NEAR(peak.value, fourier::evaluate(f, peak.crank_angle).norm(), 100 * eps * peak.value);
  }
  EXPECT_EQ(fourier::largest_length(FourierSeries()).value, 0);
}

TEST(Fourier, SumsDifferencesAndMeansOfProductsAreThoseOfTheFunctions) {
  const FourierSeries f = sampled([](double t) { return 0.5 + std::cos(t) + 0.2 * std::sin(3 * t); }, 16),
                      g = sampled([](double t) { return 2 - 3 * std::cos(t); }, 5);
  const FourierSeries sum = fourier::sum(f, g), back = fourier::difference(g, f);
  EXPECT_EQ(sum.num_harmonics(), f.num_harmonics());
  EXPECT_EQ(back.num_harmonics(), f.num_harmonics());
  for (const double t : {0.0, 0.7, 4.0}) {
    const double at_f = 0.5 + std::cos(t) + 0.2 * std::sin(3 * t), at_g = 2 - 3 * std::cos(t);
    EXPECT_NEAR(fourier::evaluate(sum, t)(0), at_f + at_g, 1e-15 * 8);
    EXPECT_NEAR(fourier::evaluate(back, t)(0), at_g - at_f, 1e-15 * 8);
  }
  EXPECT_NEAR(fourier::mean_product(f, g), 0.5 * 2 - 0.5 * 3, 1e-15);
}

TEST(Fourier, ConstantHasEqualExtremaAndZeroSeriesHasZeroMaximum) {
  FourierSeries constant(1, 0);
  constant.c(0, 0) = -2.5;
  EXPECT_EQ(fourier::range(constant, 0).max.value, -2.5);
  EXPECT_EQ(fourier::range(constant, 0).min.value, -2.5);
  EXPECT_EQ(fourier::max_abs(constant, 0).value, 2.5);
  EXPECT_EQ(fourier::max_abs(FourierSeries(1, 4), 0).value, 0);
}

TEST(Fourier, WienerNormBoundsTheMaximum) {
  const FourierSeries series = sampled(poisson, 128);
  EXPECT_NEAR(fourier::wiener_norm(series, 0), 4, 100 * eps);
}

TEST(Fourier, SignificantHarmonicsFollowTheDecay) {
  EXPECT_EQ(fourier::significant_harmonics(sampled(poisson, 128), std::pow(0.5, 10.5)), 10);
  EXPECT_EQ(fourier::significant_harmonics(FourierSeries(1, 5), 1e-16), 0);
}

TEST(Fourier, FastLengthsAreLongEnoughAndFew) {
  std::set<Eigen::Index> lengths;
  for (Eigen::Index n = 1; n <= 1024; ++n) {
    const Eigen::Index N = fourier::fast_length(n);
    EXPECT_GE(N, n);
    EXPECT_LE(N, std::max<Eigen::Index>(2, 3 * n / 2));
    EXPECT_EQ(N % 2, 0);
    lengths.insert(N);
  }
  EXPECT_LE(lengths.size(), 20u);
}

TEST(Fourier, SynthesiseRefusesTooFewSamples) {
  EXPECT_THROW((void)fourier::synthesise(FourierSeries(1, 4), 8), std::invalid_argument);
}
