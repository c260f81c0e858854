#include "hb/engine/steady/truncation.hpp"

#include <algorithm>
#include <cmath>

#include "lib/lanes.hpp"
#include "lib/modulus.hpp"
#include "lib/stop_wish.hpp"

namespace hb::steady {

namespace {
using Index = Eigen::Index;
}

// hb/engine/README.md (S4):
// a_k,i = (|f_k,i| + sum_m sum_j |K_m,ij| a_k-m,j) / |D_i(k)|, kept at or below the largest response to the load itself
// where the recursion would grow (that is the core, not the tail).
Index predicted_harmonics(const WeightedSystem& system, double tolerance, Index most) {
  const Index I = system.I, P = system.P, F = system.f.rows() - 1;
  const auto sizes = [&](Index m) { return system.K.col(m).real().cwiseAbs() + system.K.col(m).imag().cwiseAbs(); };
  // Harmonics of K that cannot matter are left out.
  Eigen::VectorXd floor(I * I);
  for (Index j = 0; j < I; ++j)
    for (Index i = 0; i < I; ++i) floor(i + I * j) = 0.1 * tolerance * system.smallest_diagonal(i);
  Index P_cut = P;
  while (P_cut > 0 && (sizes(P_cut).array() <= floor.array()).all()) --P_cut;

  // Components i side by side in lanes, zeros beyond them; of `coupling` column j + I (m - 1) is |K_m,ij|, as a_k-m,j
  // stand in `a`, the last one first.
  const Index padded = (I + Lanes::width - 1) / Lanes::width * Lanes::width;
  Eigen::MatrixXd coupling(padded, I * P_cut);
  coupling.bottomRows(padded - I).setZero();
  for (Index m = 1; m <= P_cut; ++m) coupling.block(0, I * (m - 1), I, I) = sizes(m).reshaped(I, I);
  const Eigen::MatrixXd loads = moduli(system.f).transpose();
  Eigen::MatrixXd of_each = Eigen::MatrixXd::Zero(padded, 5);
  auto mean = of_each.col(0), damping = of_each.col(1), magnitude = of_each.col(2), response = of_each.col(3),
       d = of_each.col(4);
  mean.head(I) = system.mean;
  damping.head(I) = system.G.diagonal();
  for (Index i = 0; i < I; ++i) magnitude(i) = system.magnitude(i, 0);
  Index room = std::min(most, F + 4 * P_cut + 64) + 1;
  Eigen::VectorXd a(I * room);
  double largest = 0;
  Index H = 0;  // last harmonic that mattered
  for (Index k = 0; k <= most; ++k) {
    if (k % 64 == 0) end_if_wished();
    if (k == room) {
      const Eigen::VectorXd kept = a;
      room = std::min(most + 1, 2 * k);
      a.resize(I * room);
      a.tail(kept.size()) = kept;
    }
    const Index terms = I * std::min(k, P_cut);
    const double *before = a.data() + I * (room - k), n = double(k);
    for (Index i = 0; i < padded; i += Lanes::width) {
      const Lanes w2 = Lanes::load(&mean(i)), b = Lanes::load(&damping(i));
      const Lanes size = k == 0 ? Lanes::load(&magnitude(i)) : abs(w2) + n * n + n * abs(b);
      const Lanes real = w2 - n * n, imaginary = n * b;
      max(sqrt(real * real + imaginary * imaginary), 1e-12 * size).store(&d(i));
      Lanes sums[4];
      Index t = 0;
      for (; t + 4 <= terms; t += 4)
        for (Index s = 0; s < 4; ++s) sums[s] += Lanes::load(&coupling(i, t + s)) * before[t + s];
      for (; t < terms; ++t) sums[0] += Lanes::load(&coupling(i, t)) * before[t];
      ((sums[0] + sums[1]) + (sums[2] + sums[3])).store(&response(i));
    }
    for (Index i = 0; i < I && k <= F; ++i) {
      largest = std::max(largest, loads(i, k) / d(i));
      response(i) += loads(i, k);
    }
    bool small = true;
    double* const here = a.data() + I * (room - 1 - k);
    for (Index i = 0; i < I; ++i) {
      here[i] = std::min(response(i) / d(i), largest);
      small = small && here[i] <= tolerance * largest;
    }
    if (!small) H = k;
    if (k >= F && k - H > std::max<Index>(P_cut, 2)) break;
  }
  return std::clamp<Index>(H + 1, std::min<Index>(2, most), most);
}

}  // namespace hb::steady
