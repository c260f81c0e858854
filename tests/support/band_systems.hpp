// Random systems whose bands and gaps along the speed are hard to find in different ways.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "tests/support/random_hill_system.hpp"

namespace hb::stress {

// Modes w_i > 0 apart, modulated, weakly damped: symmetric; without damping; coupled one way; with antisymmetric
// damping; some of them with negative damping; with unsymmetric harmonics, often of one order alone.
enum class BandKind { nearly_conservative, undamped, one_way, gyroscopic, partly_driven, circulatory };

inline HillSystem band_system(BandKind kind, Random& random) {
  using Eigen::Index;
  const bool coupled = kind == BandKind::one_way || kind == BandKind::gyroscopic || kind == BandKind::circulatory;
  const Index I = random.integer(coupled ? 2 : 1, 4), H = random.integer(1, 3);
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = Eigen::MatrixXd::Zero(I, I);
  system.stiffness[0] = FourierSeries(I * I, H);
  const double modulation = random.power(-3, -0.3), damping = kind == BandKind::undamped ? 0 : random.power(-7, -2);
  std::vector<double> w = {random(0.7, 1.5)};
  for (Index i = 1; i < I; ++i) w.push_back(w.back() * random(1.1, 2.5));
  const auto frequency = [&](Index i) { return w[static_cast<std::size_t>(i)]; };
  for (Index i = 0; i < I; ++i) {
    system.stiffness[0].c(i + I * i, 0) = frequency(i) * frequency(i);
    system.damping(i, i) = damping * random(0.5, 1.5);
    if (kind == BandKind::partly_driven && random.chance(0.3)) system.damping(i, i) *= -1;
  }
  for (Index k = 1; k <= H; ++k)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j <= i; ++j) {
        const double size = 0.5 * modulation * frequency(i) * frequency(j) * std::pow(0.5, k - 1);
        const std::complex<double> value(size * random(-1, 1), size * random(-1, 1));
        system.stiffness[0].c(i + I * j, k) = value;
        if (i != j && kind != BandKind::one_way)
          system.stiffness[0].c(j + I * i, k) =
              kind == BandKind::circulatory ? std::complex<double>{size * random(-1, 1), size * random(-1, 1)} : value;
      }
  if (kind == BandKind::circulatory && random.chance(0.6)) system.stiffness[0].c.middleCols(1, H - 1).setZero();
  if (kind == BandKind::gyroscopic)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j < i; ++j) {
        const double g = random.power(-2, 0) * random(-1, 1);
        system.damping(i, j) += g;
        system.damping(j, i) -= g;
      }
  return system;
}

}  // namespace hb::stress
