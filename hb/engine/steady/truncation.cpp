#include "hb/engine/steady/truncation.hpp"

#include <algorithm>
#include <cmath>

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

  // For row i of (S4) all |K_m,ij| after each other, m = 1, 2, ..., as a_k-m,j stand in `a`: the last one first.
  Eigen::MatrixXd row_sums(I * P_cut, I);
  for (Index m = 1; m <= P_cut; ++m) row_sums.middleRows(I * (m - 1), I) = sizes(m).reshaped(I, I).transpose();
  Index room = std::min(most, F + 4 * P_cut + 64) + 1;
  Eigen::VectorXd a(I * room), response(I);
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
    response.noalias() = row_sums.topRows(terms).transpose() * a.segment(I * (room - k), terms);
    auto here = a.segment(I * (room - 1 - k), I);
    for (Index i = 0; i < I; ++i) {
      const double d = std::max(modulus(system.D(i, k)), 1e-12 * system.magnitude(i, k));
      const double load = k <= F ? modulus(system.f(k, i)) : 0;
      largest = std::max(largest, load / d);
      here(i) = std::min((load + response(i)) / d, largest);
    }
    if (!(here.maxCoeff() <= tolerance * largest)) H = k;
    if (k >= F && k - H > std::max<Index>(P_cut, 2)) break;
  }
  return std::clamp<Index>(H + 1, std::min<Index>(2, most), most);
}

}  // namespace hb::steady
