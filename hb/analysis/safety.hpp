// How far a stress that repeats with every turn is from yielding and from fatigue.
#pragma once

#include "lib/linkage/linkage.hpp"

namespace hb {

// The straight line between endurance limit S_e (mean 0) and what the mean may reach (amplitude 0):
//     1/n = sigma_a/S_e + max(sigma_m, 0)/S,      S = S_u (Goodman) or S_y (Soderberg),
// n the factor that mean and amplitude together may grow by. A mean that presses is taken as 0, which is safe. Goodman
// where the tensile strength is known, Soderberg where only the yield strength is.
enum class FatigueLine { none, goodman, soderberg };

// none: endurance limit or both of the others are unknown.
[[nodiscard]] FatigueLine fatigue_line(const Strength& strength);
[[nodiscard]] const char* to_string(FatigueLine line);  // "Goodman", "Soderberg"

// 1/n. Needs a line.
[[nodiscard]] double fatigue_usage(const Strength& strength, double mean, double amplitude);

struct SafetyFactor {
  double value = 0;  // infinite without stress
  double error = 0;  // of the value, upward, where it is larger; infinite where the stress is not known
};
// From usage = 1/n and its error.
[[nodiscard]] SafetyFactor safety_factor(double usage, double error);

}  // namespace hb
