#include "lib/band_lu.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace hb::dense {

using Eigen::Index;

BandLu::BandLu(Index n, Index half_width)
    : n_(n),
      half_(half_width),
      width_(3 * half_width + 1),
      rows_(static_cast<std::size_t>(n * width_)),
      pivot_(static_cast<std::size_t>(n)) {}

void BandLu::factorise() {
  smallest_pivot_ = HUGE_VAL;
  for (Index k = 0; k < n_; ++k) {
    const Index last_row = std::min(n_ - 1, k + half_), last_column = std::min(n_ - 1, k + 2 * half_);
    Index p = k;
    for (Index i = k + 1; i <= last_row; ++i)
      if (std::abs(at(i, k)) > std::abs(at(p, k))) p = i;
    pivot_[static_cast<std::size_t>(k)] = p;
    const double size = std::abs(at(p, k));
    // Also where it is no number.
    if (!(size >= smallest_pivot_)) smallest_pivot_ = size;
    if (!(size > 0)) {
      smallest_pivot_ = 0;
      return;
    }
    const Index count = last_column - k + 1;
    double* own = &at(k, k);
    if (p != k) std::swap_ranges(own, own + count, &at(p, k));
    const double inverse = own[0] = 1 / own[0];
    for (Index i = k + 1; i <= last_row; ++i) {
      double* below = &at(i, k);
      const double factor = below[0] *= inverse;
      if (factor == 0) continue;
      for (Index j = 1; j < count; ++j) below[j] -= factor * own[j];
    }
  }
}

void BandLu::solve_in_place(Eigen::VectorXd& b) const {
  if (half_ == 3)  // of one mode and one harmonic
    substitute(std::integral_constant<Index, 3>(), b.data());
  else
    substitute(half_, b.data());
}

template <class Half>
void BandLu::substitute(Half half, double* x) const {
  const auto forward = [&](Index k, auto most) {
    std::swap(x[k], x[pivot_[static_cast<std::size_t>(k)]]);
    const double here = x[k], *below = &rows_[static_cast<std::size_t>(k * width_ + half_)];
    for (Index i = 1; i <= most; ++i) x[k + i] -= *(below += width_ - 1) * here;
  };
  const auto backward = [&](Index k, auto most) {
    const double* own = &rows_[static_cast<std::size_t>(k * width_ + half_)];
    double sum = x[k];
    for (Index j = 1; j <= most; ++j) sum -= own[j] * x[k + j];
    x[k] = sum * own[0];
  };
  const auto twice = [&] {
    if constexpr (std::is_same_v<Half, Index>)
      return 2 * half;
    else
      return std::integral_constant<Index, 2 * Half::value>();
  }();
  Index k = 0;
  for (; k < n_ - half; ++k) forward(k, half);
  for (; k < n_; ++k) forward(k, n_ - 1 - k);
  for (; k > 0 && n_ - k < twice; --k) backward(k - 1, n_ - k);
  for (; k > 0; --k) backward(k - 1, twice);
}

}  // namespace hb::dense
