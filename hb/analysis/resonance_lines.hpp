// Parametric resonance lines over two parameters: where the mean frequencies of a system stand in a simple ratio to the
// speed,   k Omega = omega_i + omega_j,   k Omega = |omega_i - omega_j|,
// which is where tongues of instability start when damping and variation of the coefficients go to zero.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "hb/engine/boundaries/stability_map.hpp"

namespace hb {

struct ResonanceLine {
  int i = 0, j = 0;  // modes, from 0
  int sign = 1;  // of omega_j
  int k = 1;
  std::vector<std::vector<std::array<double, 2>>> pieces;  // points (x, y)

  // "2ω_1/3", "(ω_1+ω_2)/2": what the speed equals; `subscripts`: gnuplot's enhanced markup.
  [[nodiscard]] std::string name(bool subscripts) const;
};

// Lines of the lowest two modes that cross the rectangle, strongest kinds first (sums before differences, then by k),
// at most `max_lines`. `for_each`: who does some of the places.
[[nodiscard]] std::vector<ResonanceLine> resonance_lines(const MapSystemAt& at, std::array<double, 2> x,
                                                         std::array<double, 2> y, std::size_t max_lines,
                                                         const ForEach& for_each);

}  // namespace hb
