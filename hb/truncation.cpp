#include "hb/truncation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hb::steady {

namespace {
using Index = Eigen::Index;
}

// a_k = (f_k + sum_m e_m a_{k-m}) / d_k with f_k = max_i |f_i,k|, e_m the largest entry of K_m and d_k the smallest
// |D_i(k)|, rows scaled by w_i so that stiff modes do not drown soft ones; a_k is kept at or below the largest so far
// where the recursion would grow (that is the core, not the tail).
Index predicted_harmonics(const WeightedSystem& system, double tolerance, Index most) {
  const Index I = system.I, P = system.P, F = system.f.rows() - 1;
  Eigen::VectorXd s(I);  // w_i
  for (Index i = 0; i < I; ++i) s(i) = std::sqrt(std::max(1.0, std::abs(system.mean(i))));
  std::vector<double> e(static_cast<std::size_t>(P + 1), 0.0);
  for (Index m = 1; m <= P; ++m)
    for (Index j = 0; j < I; ++j)
      for (Index i = 0; i < I; ++i)
        e[static_cast<std::size_t>(m)] =
            std::max(e[static_cast<std::size_t>(m)], std::abs(system.K(i + I * j, m)) / (s(i) * s(j)));
  const double cut = 1e-3 * tolerance;
  Index P_cut = P;
  while (P_cut > 0 && e[static_cast<std::size_t>(P_cut)] <= cut) --P_cut;

  std::vector<double> a;
  double largest = 0;
  Index H = 0;  // last harmonic that mattered
  for (Index k = 0; k <= most; ++k) {
    double sum = 0, response = 0;
    for (Index m = 1; m <= std::min(k, P_cut); ++m)
      sum += e[static_cast<std::size_t>(m)] * a[static_cast<std::size_t>(k - m)];
    for (Index i = 0; i < I; ++i) {
      const double d = std::abs(system.D(i, k));
      const double f = k <= F ? std::abs(system.f(k, i)) : 0;
      const double b = f + sum * s(i) * s(i);
      response = std::max(response, b > 0 ? b / std::max(d, 1e-12 * system.magnitude(i, k)) : 0.0);
    }
    // Load alone may set a new largest; coupling alone not.
    double direct = 0;
    if (k <= F)
      for (Index i = 0; i < I; ++i)
        direct = std::max(direct, std::abs(system.f(k, i)) / std::max(std::abs(system.D(i, k)), 1e-12 * system.magnitude(i, k)));
    largest = std::max(largest, direct);
    const double value = std::min(response, std::max(largest, direct));
    a.push_back(value);
    if (!(value <= tolerance * largest)) H = k;
    if (k >= F && k - H > std::max<Index>(P_cut, 2)) break;
  }
  return std::clamp<Index>(H + 1, std::min<Index>(2, most), most);
}

Index grown_harmonics(Index H, Index most) { return std::min(most, H + std::max<Index>(3, H / 4)); }

}  // namespace hb::steady
