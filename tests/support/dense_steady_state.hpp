// Dense harmonic balance, all harmonics -H..H in one linear system: slow, plain, for tests only.
#pragma once

#include <Eigen/LU>
#include <complex>

#include "lib/hill_system.hpp"

namespace hb {

inline FourierSeries dense_steady_state(const HillSystem& system, double Omega, int H) {
  const Eigen::Index I = system.num_modes();
  const FourierSeries C = stiffness_at(system, Omega), h = load_at(system, Omega);
  const auto coefficient = [](const FourierSeries& s, Eigen::Index row, int k) -> std::complex<double> {
    if (std::abs(k) > s.num_harmonics()) return 0;
    return k >= 0 ? s.c(row, k) : std::conj(s.c(row, -k));
  };
  const Eigen::Index n = I * (2 * H + 1);
  Eigen::MatrixXcd A = Eigen::MatrixXcd::Zero(n, n);
  Eigen::VectorXcd b(n);
  for (int k = -H; k <= H; ++k) {
    for (int m = -H; m <= H; ++m)
      for (Eigen::Index i = 0; i < I; ++i)
        for (Eigen::Index j = 0; j < I; ++j) A((k + H) * I + i, (m + H) * I + j) = coefficient(C, i + I * j, k - m);
    A.block((k + H) * I, (k + H) * I, I, I) +=
        -k * k * Omega * Omega * system.mass + std::complex<double>(0, k * Omega) * system.damping;
    for (Eigen::Index i = 0; i < I; ++i) b((k + H) * I + i) = coefficient(h, i, k);
  }
  const Eigen::VectorXcd x = A.partialPivLu().solve(b);
  FourierSeries q(I, H);
  for (int k = 0; k <= H; ++k) q.c.col(k) = x.segment((k + H) * I, I);
  return q;
}

}  // namespace hb
