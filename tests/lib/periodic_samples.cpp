#include "lib/fourier/periodic_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lib/constants.hpp"

using namespace hb;

namespace {

double wave(double t) { return 1 + std::cos(t) - 0.5 * std::sin(2 * t) + 0.1 * std::cos(3 * t - 1); }

}  // namespace

TEST(PeriodicSamples, InterpolantPassesThroughEvenAndOddNumbersOfSamples) {
  for (const int N : {3, 4, 7, 16, 101}) {
    for (const double first : {0.0, 0.3, -2.0}) {
      Eigen::MatrixXd samples(2, N);
      for (int j = 0; j < N; ++j) samples.col(j) << std::sin(1.7 * j * j), (j % 2 ? -1.0 : 1.0);
      const FourierSeries series = interpolate(samples, first);
      for (int j = 0; j < N; ++j) {
        const Eigen::VectorXd value = fourier::evaluate(series, first + 2 * pi * j / N);
        EXPECT_LE((value - samples.col(j)).norm(), 200 * N * eps) << N << " " << first << " " << j;
      }
    }
  }
}

TEST(PeriodicSamples, InterpolantOfAWaveIsTheWave) {
  Eigen::MatrixXd samples(1, 20);
  for (int j = 0; j < 20; ++j) samples(0, j) = wave(0.7 + 2 * pi * j / 20);
  const FourierSeries series = interpolate(samples, 0.7);
  for (const double t : {0.0, 1.0, 4.4}) EXPECT_NEAR(fourier::evaluate(series, t)(0), wave(t), 100 * eps);
}

// Uneven knots: the series is the spline, so it passes through the knots as closely as its cut allows.
TEST(PeriodicSamples, SplineSeriesPassesThroughItsKnots) {
  for (const int n : {3, 5, 24}) {
    Eigen::VectorXd angles(n), values(n);
    for (int j = 0; j < n; ++j) {
      angles(j) = -1 + 2 * pi * (j + 0.3 * std::sin(3.0 * j)) / n;
      values(j) = wave(angles(j));
    }
    const FourierSeries series = spline_series(angles, values);
    for (int j = 0; j < n; ++j) {
      EXPECT_NEAR(fourier::evaluate(series, angles(j))(0), values(j), 2e-7 * values.cwiseAbs().maxCoeff()) << n;
    }
  }
}

// Error of the interpolating cubic spline is O(h^4) for a smooth function.
TEST(PeriodicSamples, SplineConvergesWithTheFourthPowerOfTheStep) {
  const auto error = [](int n) {
    Eigen::VectorXd angles(n), values(n);
    for (int j = 0; j < n; ++j) {
      const double s = 2 * pi * j / n;
      angles(j) = s + 0.3 * std::sin(s);
      values(j) = wave(angles(j));
    }
    const FourierSeries series = spline_series(angles, values);
    double worst = 0;
    for (int j = 0; j < 500; ++j) {
      const double t = 2 * pi * j / 500;
      worst = std::max(worst, std::abs(fourier::evaluate(series, t)(0) - wave(t)));
    }
    return worst;
  };
  const double coarse = error(32), fine = error(64);
  EXPECT_LE(coarse, 1e-2);
  EXPECT_GE(coarse / fine, 11);
  EXPECT_LE(coarse / fine, 25);
}

// Coefficients against the spline's own pieces: a spline through samples of a constant is that constant, and one
// through a cubic spline's values reproduces its closed-form coefficients. The periodic B-spline on m equal knots has
//     c_k = (1/m) (sin(k h/2)/(k h/2))^4,   h = 2 pi/m,
// and takes the values 2/3 and 1/6 at its knots.
TEST(PeriodicSamples, SplineSeriesOfABSplineHasItsClosedFormCoefficients) {
  const int m = 9;
  const double h = 2 * pi / m;
  Eigen::VectorXd angles(m), values = Eigen::VectorXd::Zero(m);
  for (int j = 0; j < m; ++j) angles(j) = h * j;
  values(0) = 2.0 / 3;
  values(1) = values(m - 1) = 1.0 / 6;
  const FourierSeries series = spline_series(angles, values);
  EXPECT_NEAR(series.c(0, 0).real(), 1.0 / m, 10 * eps);
  for (const int k : {1, 2, 5, 8, 13, 100, 300}) {
    const double x = k * h / 2;
    EXPECT_NEAR(series.c(0, k).real(), std::pow(std::sin(x) / x, 4) / m, 20 * eps) << k;
    EXPECT_NEAR(series.c(0, k).imag(), 0, 20 * eps) << k;
  }
}

TEST(PeriodicSamples, SplineOfZerosAndOfConstantsIsExact) {
  const Eigen::Vector4d angles(0, 1, 3, 5);
  EXPECT_EQ(spline_series(angles, Eigen::Vector4d::Zero()).c.cwiseAbs().maxCoeff(), 0);
  const FourierSeries constant = spline_series(angles, Eigen::Vector4d::Constant(7));
  EXPECT_EQ(constant.num_harmonics(), 0);
  EXPECT_NEAR(constant.c(0, 0).real(), 7, 10 * eps);
}
