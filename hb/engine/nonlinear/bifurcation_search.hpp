// What happens between two neighbouring points of a branch, and where.
#pragma once

#include <optional>
#include <vector>

#include "hb/engine/nonlinear/branch_tracer.hpp"

namespace hb::nonlinear {

// Unstable exponents by kind; empty if one of them is not known to lie on either side of the imaginary axis.
struct UnstableCount {
  int plus = 0;  // real multipliers above 1
  int minus = 0;  // real multipliers below -1
  int pairs = 0;  // complex pairs outside the unit circle
};
[[nodiscard]] std::optional<UnstableCount> unstable_count(const BranchPoint& point);

// Folds and bifurcations between a and b, both with exponents if those are wanted, along the arc; points between them
// are traced with `tracer`. What changes twice in between is not seen.
[[nodiscard]] std::vector<Bifurcation> bifurcations_between(BranchTracer& tracer, const BranchPoint& a,
                                                            const BranchPoint& b, double tolerance);

}  // namespace hb::nonlinear
