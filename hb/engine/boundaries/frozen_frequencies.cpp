#include "hb/engine/boundaries/frozen_frequencies.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "lib/jacobi_rotations.hpp"
#include "lib/modulus.hpp"

namespace hb {

namespace {

using Eigen::ArrayXd;
using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::VectorXd;

constexpr Index frozen_harmonics = 31, frozen_angles = 64;

// Entries of K at each angle, then those of K', as lib/jacobi_rotations.hpp places them. Until the thread's next
// transform.
Eigen::Map<Eigen::MatrixXd> samples(const FourierSeries& K, Index I, Index H) {
  const Index entries = I * (I + 1) / 2;
  fourier::RealTransform& transform = fourier::thread_transform(frozen_angles, 2 * entries);
  auto spectrum = transform.spectrum();
  spectrum.bottomRows(spectrum.rows() - H - 1).setZero();
  for (Index j = 0; j < I; ++j)
    for (Index i = j; i < I; ++i) {
      const Index entry = symmetric_entry(I, i, j);
      for (Index k = 0; k <= H; ++k) {
        const std::complex<double> c = K.c(i + I * j, k);
        spectrum(k, entry) = c;
        spectrum(k, entries + entry) = static_cast<double>(k) * std::complex<double>(-c.imag(), c.real());
      }
    }
  transform.backward();
  return transform.samples();
}

}  // namespace

VectorXd frozen_frequencies(const FourierSeries& K, const VectorXd& b) {
  constexpr double least_apart = 4, least_frequency = 2, most_correction = 0.02;
  const Index I = b.size(), H = std::min(K.num_harmonics(), frozen_harmonics), entries = I * (I + 1) / 2;
  auto values = samples(K, I, H).array();
  Eigen::Ref<ArrayXXd> k = values.leftCols(entries), t = values.rightCols(entries);  // to be k_n and t_nl of (B13)
  if (!diagonalise_all(I, k, t)) return {};
  ArrayXXd v(frozen_angles, I);
  for (Index n = 0; n < I; ++n) v.col(n) = k.col(symmetric_entry(I, n, n)) - b(n) * b(n) / 4;
  if (!(v.minCoeff() > least_frequency * least_frequency)) return {};
  v = v.sqrt();
  const double left_out = 2 * moduli(K.c.rightCols(K.num_harmonics() - H)).sum();
  if (!(left_out < most_correction * v.minCoeff())) return {};
  VectorXd correction(I);
  for (Index n = 0; n < I; ++n)
    correction(n) = -(t.col(symmetric_entry(I, n, n)).square() / (32 * v.col(n).square().square() * v.col(n))).mean();
  for (Index n = 0; n < I; ++n)
    for (Index l = n + 1; l < I; ++l) {
      if (!((v.col(l) - v.col(n)).abs().minCoeff() > least_apart)) return {};
      const ArrayXd n2 = v.col(n).square(), l2 = v.col(l).square(), apart = l2 - n2;
      const ArrayXd rate = (t.col(symmetric_entry(I, n, l)) / apart).square() / (2 * apart);
      correction(n) -= (rate * (l2 + 3 * n2) / v.col(n)).mean();
      correction(l) += (rate * (n2 + 3 * l2) / v.col(l)).mean();
    }
  if (!(correction.cwiseAbs().maxCoeff() < most_correction)) return {};
  return v.colwise().mean().matrix().transpose() + correction;
}

}  // namespace hb
