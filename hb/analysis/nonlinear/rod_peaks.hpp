#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace hb {

// Largest |q_i| over the motion, by rod and mode.
using RodPeaks = std::vector<std::vector<double>>;

// Whether motions with these peaks are one and the same.
[[nodiscard]] inline bool same_motion(const RodPeaks& a, const RodPeaks& b) {
  constexpr double difference = 1e-4;  // relative to the rod's largest
  for (std::size_t r = 0; r < a.size(); ++r) {
    const double size = *std::ranges::max_element(a[r]);
    for (std::size_t i = 0; i < a[r].size(); ++i)
      if (!(std::abs(a[r][i] - b[r][i]) <= difference * size)) return false;
  }
  return true;
}

}  // namespace hb
