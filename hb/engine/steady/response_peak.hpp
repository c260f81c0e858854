// Where a smooth function of one variable is largest, to nearly the accuracy of its argument: the maximum of a function
// known to eps is only seen to sqrt(eps), the zero of its interpolant's derivative to about eps times its width.
#pragma once

#include <functional>
#include <optional>

namespace hb {

struct ResponsePeak {
  double x = 0;
  double value = 0;  // infinite at a pole
  double error = 0;  // estimate, of x
  bool converged = false;  // error within the tolerance
};

// Empty where the function does not exist.
using ResponseAt = std::function<std::optional<double>(double x)>;

// Where it grows like 1/|x - x0| down to 1e-7 of x0 it is unbounded: a pole, located as such.
// The maximum between low and high, given low < inside < high with value(inside) not below the two others. `tolerance`
// is relative to |x|. `rough` serves to find the neighbourhood: a few digits of `value` are enough for that. Empty if
// the function does not exist somewhere on the way.
[[nodiscard]] std::optional<ResponsePeak> locate_peak(const ResponseAt& rough, const ResponseAt& value, double low,
                                                      double inside, double high, double tolerance = 1e-11);

}  // namespace hb
