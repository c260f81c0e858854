// The real transform of short lengths against the sum that defines it.
#include "lib/fourier/short_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace {

using hb::fourier::ShortTransform;

std::vector<std::size_t> lengths() {
  std::vector<std::size_t> all;
  for (std::size_t N = 1; N <= 5000; ++N)
    if (ShortTransform::serves(N)) all.push_back(N);
  return all;
}

std::vector<double> samples_of(std::size_t N) {
  std::mt19937 random(static_cast<unsigned>(N));
  std::vector<double> samples(N);
  for (double& f : samples) f = static_cast<double>(random()) / 4294967296.0 - 0.5;
  return samples;
}

TEST(ShortTransform, ServesPowersOfTwoAndThreeTimesThoseFrom8To4096) {
  EXPECT_EQ(lengths(), (std::vector<std::size_t>{8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024,
                                                 1536, 2048, 3072, 4096}));
}

TEST(ShortTransform, CoefficientsAreTheSumsThatDefineThem) {
  for (const std::size_t N : lengths()) {
    const std::vector<double> f = samples_of(N);
    std::vector<std::complex<double>> c(N / 2 + 1);
    ShortTransform(N).forward(f.data(), c.data(), 1.0 / static_cast<double>(N));
    double size = 0;
    for (const double x : f) size += x * x;
    // Rounding: a few digits' ends of the mean square, whatever the harmonic.
    const double allowed = 4e-16 * std::sqrt(size) / static_cast<double>(N) * std::log2(static_cast<double>(N));
    const std::size_t step = N > 512 ? 37 : 1;
    for (std::size_t k = 0; k <= N / 2; k += step) {
      long double re = 0, im = 0;
      for (std::size_t j = 0; j < N; ++j) {
        const long double angle = 2 * std::numbers::pi_v<long double> * static_cast<long double>(j * k % N) / N;
        re += f[j] * std::cos(angle);
        im -= f[j] * std::sin(angle);
      }
      EXPECT_LE(std::abs(c[k] - std::complex<double>(static_cast<double>(re / N), static_cast<double>(im / N))),
                allowed)
          << N << " " << k;
    }
    EXPECT_EQ(c[0].imag(), 0);
    EXPECT_EQ(c[N / 2].imag(), 0);
  }
}

TEST(ShortTransform, BackwardUndoesForward) {
  for (const std::size_t N : lengths()) {
    const std::vector<double> f = samples_of(N);
    std::vector<std::complex<double>> c(N / 2 + 1);
    std::vector<double> again(N);
    const ShortTransform transform(N);
    transform.forward(f.data(), c.data(), 1.0 / static_cast<double>(N));
    // What c_0 and c_{N/2} hold beside their real parts does not count.
    c[0].imag(3);
    c[N / 2].imag(-5);
    transform.backward(c.data(), again.data());
    for (std::size_t j = 0; j < N; ++j) EXPECT_NEAR(again[j], f[j], 2e-15) << N << " " << j;
  }
}

TEST(ShortTransform, AColumnHasTheSameBitsWhereverItLies) {
  constexpr std::size_t N = 96;
  const std::vector<double> f = samples_of(N);
  const ShortTransform transform(N);
  std::vector<std::complex<double>> first(N / 2 + 1), shifted(N / 2 + 2);
  transform.forward(f.data(), first.data(), 1);
  std::vector<double> odd(N + 1);
  std::copy(f.begin(), f.end(), odd.begin() + 1);
  transform.forward(odd.data() + 1, shifted.data() + 1, 1);
  for (std::size_t k = 0; k <= N / 2; ++k) EXPECT_EQ(first[k], shifted[k + 1]);
}

TEST(ShortTransform, ColumnsTogetherAreThoseAlone) {
  for (const std::size_t N : lengths()) {
    if (N > 600) break;
    const ShortTransform transform(N);
    const double rounding = 4e-16 * std::log2(static_cast<double>(N));
    for (const std::size_t columns : {1u, 2u, 3u, 4u, 5u, 8u, 11u, 17u}) {
      const std::vector<double> f = samples_of(N * columns);
      std::vector<std::complex<double>> together(columns * (N / 2 + 1)), alone(N / 2 + 1);
      std::vector<double> back(N * columns);
      transform.forward(f.data(), together.data(), 1.0 / static_cast<double>(N), columns);
      for (std::size_t c = 0; c < columns; ++c) {
        transform.forward(f.data() + c * N, alone.data(), 1.0 / static_cast<double>(N));
        std::complex<double>* here = together.data() + c * (N / 2 + 1);
        for (std::size_t k = 0; k <= N / 2; ++k)
          EXPECT_LE(std::abs(here[k] - alone[k]), rounding) << N << " " << columns << " " << c << " " << k;
        EXPECT_EQ(here[0].imag(), 0);
        EXPECT_EQ(here[N / 2].imag(), 0);
        here[0].imag(3);
        here[N / 2].imag(-5);
      }
      transform.backward(together.data(), back.data(), columns);
      for (std::size_t j = 0; j < N * columns; ++j)
        EXPECT_NEAR(back[j], f[j], 2e-15) << N << " " << columns << " " << j;
    }
  }
}

}  // namespace
