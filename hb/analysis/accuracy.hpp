// What one tolerance, the relative error wanted of the answer, means for every solver; the only such place. With T
// the tolerance (Settings::tolerance, 1e-10 by default) and [a, b] for "at least a, at most b":
//
//   response q at one speed        T; max(T/20, 1e-14) where the number of modes is sought: their difference counts
//   ... at its poles               max(T, 1e-5), without a bound of the error
//   exponents at one place         10 T [1e-12, 0.1], relative to the larger of growth rate and speed
//   ... to compare numbers of modes   T/100 [1e-12, 10 T]
//   boundaries of stability        exponents T [1e-13, 1e-9]; bracket T/10 [1e-14, 1e-6] of the number that varies
//   peaks of the response          q T/100 [1e-14, 1e-9]; height T/2 [5e-14, 1e-6]; first looked for with q 1e-5
//   time integration               T, at least 1e-9
//   joint forces                   the harmonics of q carry them: estimated, not asked for
//
// steady, sweep, map, check and tune use these and no others. solver_tolerances tells them.
#pragma once

#include <string>
#include <vector>

#include "hb/analysis/request.hpp"
#include "hb/engine/boundaries/sweep.hpp"

namespace hb {

[[nodiscard]] SteadyOptions response_options(const Settings& settings);
// Where the response is unbounded: what is told of it depends on how near to the pole its place was rounded.
[[nodiscard]] SteadyOptions pole_options(const Settings& settings);
[[nodiscard]] StabilityOptions exponent_options(const Settings& settings);
// To compare growth rates of different numbers of modes.
[[nodiscard]] StabilityOptions growth_comparison_options(const Settings& settings);
// Of sweeps; maps may be asked for another bracket (Settings::boundary_tolerance).
[[nodiscard]] SweepOptions boundary_options(const Settings& settings);
[[nodiscard]] double default_boundary_tolerance(double tolerance);

struct PeakAccuracy {
  double rough = 0, fine = 0;  // of q
  double height = 0;  // of the peak, relative
};
[[nodiscard]] PeakAccuracy peak_accuracy(const Settings& settings);
[[nodiscard]] double integration_tolerance(const Settings& settings);

// The table above with its numbers.
struct SolverTolerance {
  std::string solver;  // as a key of JSON
  double tolerance = 0;
};
[[nodiscard]] std::vector<SolverTolerance> solver_tolerances(const Settings& settings);

}  // namespace hb
