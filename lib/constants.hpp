#pragma once

#include <limits>
#include <numbers>

namespace hb {

inline constexpr double pi = std::numbers::pi, two_pi = 2 * pi;
inline constexpr double eps = std::numeric_limits<double>::epsilon();
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace hb
