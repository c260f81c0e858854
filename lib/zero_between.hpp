// Where a function of one variable passes zero between two places.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

namespace hb {

// Chandrupatla's method (1997): from the last three places by inverse quadratic interpolation where phi and xi allow
// that, else half way,
//     1 - sqrt(1 - xi) < phi < sqrt(xi),   xi = (x - other)/(before - other), phi likewise of the values,
// until the bracket is no wider than `accuracy`. At a jump that takes as many steps as halving alone. Where the ends
// have one sign it is one of them or a place where the function has the other sign.
template <class Function>
[[nodiscard]] double zero_between(double a, double b, double accuracy, const Function& value) {
  constexpr int most_steps = 200;
  double x = b, other = a, at_x = value(b), at_other = value(a), t = 0.5;
  for (int step = 0; step < most_steps && std::abs(other - x) > accuracy && at_x != 0; ++step) {
    double before = x, at_before = at_x;
    const double next = x + t * (other - x), at_next = value(next);
    if ((at_next > 0) != (at_x > 0)) {
      std::swap(before, other);
      std::swap(at_before, at_other);
    }
    x = next;
    at_x = at_next;
    const double xi = (x - other) / (before - other), phi = (at_x - at_other) / (at_before - at_other);
    const bool curved = 1 - std::sqrt(1 - xi) < phi && phi < std::sqrt(xi);
    t = curved ? at_x / (at_other - at_x) * (at_before / (at_other - at_before)) +
                     (before - x) / (other - x) * (at_x / (at_before - at_x)) * (at_other / (at_before - at_other))
               : 0.5;
    const double least = std::min(0.5, 0.5 * accuracy / std::abs(other - x));
    t = std::clamp(t, least, 1 - least);
  }
  return std::abs(at_x) < std::abs(at_other) ? x : other;
}

}  // namespace hb
