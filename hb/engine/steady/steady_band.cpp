#include "hb/engine/steady/steady_band.hpp"

#include <algorithm>
#include <complex>

namespace hb::steady {

namespace {

using Index = Eigen::Index;

Index half_width(const WeightedSystem& system) { return 2 * system.I * (factor_harmonics(system) + 1) - 1; }

Index first_unknown(Index I, Index k) { return k == 0 ? 0 : I * (2 * k - 1); }

}  // namespace

bool BandInverse::suits(const Operator& A) {
  constexpr Index widest = 15;
  return half_width(A.system()) <= widest;
}

BandInverse::BandInverse(Operator& A)
    : EliminatedInverse(A),
      factors_(A.num_modes() * (2 * A.num_harmonics() + 1), half_width(A.system())),
      unknowns_(factors_.size()) {
  const WeightedSystem& s = A.system();
  const Index I = s.I, H = A.num_harmonics(), P = factor_harmonics(s);
  for (Index l = 0; l <= H; ++l)
    for (Index k = std::max<Index>(0, l - P); k <= std::min(H, l + P); ++k)
      for (Index j = 0; j < I; ++j)
        for (Index i = 0; i < I; ++i) {
          std::complex<double> here = s.K(i + I * j, std::abs(k - l));
          if (k < l) here = std::conj(here);
          if (k == l) here += std::complex<double>(0, static_cast<double>(k) * s.G(i, j));
          if (k == l && i == j) here -= static_cast<double>(k * k);
          const std::complex<double> conjugate = l > 0 && k + l <= P ? s.K(i + I * j, k + l) : 0;
          const std::complex<double> cosine = here + conjugate, sine = here - conjugate;
          const Index row = first_unknown(I, k) + i, column = first_unknown(I, l) + j;
          factors_(row, column) = cosine.real();
          if (k > 0) factors_(row + I, column) = cosine.imag();
          if (l == 0) continue;
          factors_(row, column + I) = -sine.imag();
          if (k > 0) factors_(row + I, column + I) = sine.real();
        }
  factors_.factorise();
  regular_ = factors_.smallest_pivot() > smallest_pivot;
}

void BandInverse::substitute(const Spectrum& rhs, Spectrum& z) const {
  const Index I = A_.num_modes(), H = A_.num_harmonics();
  for (Index i = 0; i < I; ++i)
    for (Index k = 0; k <= H; ++k) {
      const Index at = first_unknown(I, k) + i;
      unknowns_(at) = rhs(k, i).real();
      if (k > 0) unknowns_(at + I) = rhs(k, i).imag();
    }
  factors_.solve_in_place(unknowns_);
  z.resize(H + 1, I);
  for (Index i = 0; i < I; ++i)
    for (Index k = 0; k <= H; ++k) {
      const Index at = first_unknown(I, k) + i;
      z(k, i) = {unknowns_(at), k > 0 ? unknowns_(at + I) : 0.0};
    }
}

}  // namespace hb::steady
