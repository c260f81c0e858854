#include "lib/band_lu.hpp"

#include <algorithm>
#include <cmath>
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
    const double inverse = 1 / own[0];
    for (Index i = k + 1; i <= last_row; ++i) {
      double* below = &at(i, k);
      const double factor = below[0] *= inverse;
      if (factor == 0) continue;
      for (Index j = 1; j < count; ++j) below[j] -= factor * own[j];
    }
  }
}

void BandLu::solve_in_place(Eigen::VectorXd& b) const {
  for (Index k = 0; k < n_; ++k) {
    std::swap(b(k), b(pivot_[static_cast<std::size_t>(k)]));
    const Index last = std::min(n_ - 1, k + half_);
    for (Index i = k + 1; i <= last; ++i) b(i) -= at(i, k) * b(k);
  }
  for (Index k = n_; k-- > 0;) {
    const Index last = std::min(n_ - 1, k + 2 * half_);
    double sum = b(k);
    for (Index j = k + 1; j <= last; ++j) sum -= at(k, j) * b(j);
    b(k) = sum / at(k, k);
  }
}

}  // namespace hb::dense
