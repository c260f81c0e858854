// Where a response is largest along one variable, to nearly the accuracy of that: the maximum of a function known to
// eps is only seen to sqrt(eps), the zero of its interpolant's slope to about eps times its width.
#pragma once

#include <functional>
#include <optional>

#include "lib/fourier/fourier.hpp"

namespace hb {

struct ResponsePeak {
  double x = 0;
  double value = 0;  // max over the turn of |response|; infinite at a pole
  double error = 0;  // estimate, of x
  bool converged = false;  // error within the tolerance
};

// One component of the periodic response at x; empty where there is none.
using ResponseAt = std::function<std::optional<FourierSeries>(double x)>;

struct PeakResponses {
  ResponseAt rough;  // a few digits: to find the neighbourhood
  ResponseAt fine;  // what is interpolated
  ResponseAt sure;  // with its error bounded: what the interpolant is compared with
  double rough_error = 1e-5, fine_error = 1e-13;  // of heights, relative
};

// The maximum between low and high, given low < inside < high with the response inside not below the two others. Where
// it grows like 1/|x - x0| down to 2e-6 of x0 it is unbounded: a pole, located as such. `tolerance` is relative to |x|.
// Empty if there is no response somewhere on the way.
[[nodiscard]] std::optional<ResponsePeak> locate_peak(const PeakResponses& responses, double low, double inside,
                                                      double high, double tolerance = 1e-11);

}  // namespace hb
