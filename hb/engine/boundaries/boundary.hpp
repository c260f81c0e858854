// Where the verdict changes along a parameter, and how.
#pragma once

#include "hb/engine/boundaries/stability_sample.hpp"

namespace hb {

struct SweepOptions {
  double tolerance = 1e-11;  // bracket of a boundary, relative to |x|
  double least_growth = 1e-9;  // a weaker instability, relative to the speed, is not looked for
  int max_order = 512;  // nor one of higher order k
  StabilityOptions stability;
};

// The exponent that gives the growth rate is known well enough to tell how it leaves.
[[nodiscard]] bool leading_resolved(const Stability& stability);

// How the leading exponent leaves: multiplier +1, -1 (period doubling), or a complex pair.
enum class BoundaryKind { plus_one, minus_one, complex };
[[nodiscard]] BoundaryKind boundary_kind(const Stability& stability, double speed);
[[nodiscard]] const char* to_string(BoundaryKind kind);  // "+1", "-1", "complex"

// Relative error that a boundary is located to where no other is asked for; the bracket goes below it.
constexpr double promised_of_boundaries = 1e-10;

struct StabilityBoundary {
  double x = 0;
  double error = 0;  // half of the bracket that is left, and what the growth rate's error bound moves
  BoundaryKind kind = BoundaryKind::complex;
  bool unstable_above = false;
  bool converged = false;  // error within promised_of_boundaries of x
};

// Where the verdict changes between a and b, one of which is unstable: ITP bracketing on the growth rate.
[[nodiscard]] StabilityBoundary locate_boundary(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                                                const SweepOptions& options = {});

}  // namespace hb
