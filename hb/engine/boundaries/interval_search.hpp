// Every change of verdict between two values of a parameter, also those that both ends do not show, and what could not
// be settled. How, and what may be missed: hb/engine/README.md, "Boundaries".
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hb/engine/boundaries/boundary.hpp"
#include "hb/engine/boundaries/stability_sample.hpp"

namespace hb {

struct SearchedInterval {
  std::vector<StabilityBoundary> boundaries;  // ascending
  std::vector<StabilitySample> samples;  // ascending: one between each two boundaries, the fastest or slowest growing
  std::vector<std::array<double, 2>> not_excluded;  // ascending: where a band or a gap may have been missed
  int evaluations = 0;
};

// Between a and b, a.x < b.x. `before` and `after` (or null): samples next to them, which save evaluations, as do those
// `farther` away. Samples of leading exponents alone will do where others_below tells that the rest decays faster.
[[nodiscard]] SearchedInterval search_interval(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                                               const StabilitySample* before, const StabilitySample* after,
                                               const SweepOptions& options = {},
                                               std::span<const StabilitySample> farther = {});

}  // namespace hb
