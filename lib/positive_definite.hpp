// Symmetric positive definite systems, one in each lane.
#pragma once

#include <algorithm>

#include "lib/lanes.hpp"

namespace hb {

// b becomes the x of A x = b, A of n rows, by A = L D L^T; A is given and overwritten column by column, its lower
// triangle alone. False, b then undefined, where a pivot is not positive in every lane.
inline bool solve_positive_definite(Eigen::Index n, Lanes* A, Lanes* b) {
  const auto at = [n, A](Eigen::Index i, Eigen::Index j) -> Lanes& { return A[i + n * j]; };
  for (Eigen::Index j = 0; j < n; ++j) {
    const Lanes::Values pivots = at(j, j).values();
    if (!std::ranges::all_of(pivots, [](double pivot) { return pivot > 0; })) return false;
    const Lanes inverse = Lanes(1) / at(j, j);
    for (Eigen::Index k = j + 1; k < n; ++k) {
      const Lanes l = at(k, j) * inverse;
      for (Eigen::Index i = k; i < n; ++i) at(i, k) -= at(i, j) * l;
      b[k] -= l * b[j];
    }
    b[j] *= inverse;
  }
  // L^T x = D^-1 L^-1 b, the columns of L times D.
  for (Eigen::Index j = n; j-- > 0;) {
    Lanes sum = 0;
    for (Eigen::Index i = j + 1; i < n; ++i) sum += at(i, j) * b[i];
    b[j] -= sum / at(j, j);
  }
  return true;
}

}  // namespace hb
