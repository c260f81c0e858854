// What is known of the sign of the growth rate.
#pragma once

#include <span>

namespace hb {

// From the best to the worst.
enum class Verdict {
  stable,  // every disturbance dies out
  bounded,  // disturbances neither grow nor die out: all exponents on the imaginary axis (see imaginary_axis.hpp)
  undecided,  // the error is larger than what there is to decide
  unstable,  // some disturbance grows
};

// The worst of several, in the order unstable, undecided, bounded, stable; stable for none.
[[nodiscard]] Verdict worst(std::span<const Verdict> verdicts);
[[nodiscard]] inline Verdict worst(Verdict a, Verdict b) { return a < b ? b : a; }

// Of a growth rate that lies between `low` and `high`; NaN decides nothing.
[[nodiscard]] inline Verdict verdict_of(double low, double high) {
  return low > 0 ? Verdict::unstable : high < 0 ? Verdict::stable : Verdict::undecided;
}

[[nodiscard]] const char* to_string(Verdict verdict);

}  // namespace hb
