// Unstable bands of one system along one parameter (its speed, or any other number).
#pragma once

#include <vector>

#include "hb/engine/boundaries/boundary.hpp"
#include "hb/engine/boundaries/stability_sample.hpp"

namespace hb {

struct UnstableBand {
  double from = 0, to = 0;
  double error_from = 0, error_to = 0;
  bool open_from = false, open_to = false;  // the sweep ends inside the band, or has no answer beyond
  BoundaryKind kind_from = BoundaryKind::complex, kind_to = BoundaryKind::complex;
  double fastest = 0;  // largest growth rate sampled inside, 1/time
  double fastest_x = 0;
};

// From samples in ascending order (null: no system there) and the boundaries between them.
[[nodiscard]] std::vector<UnstableBand> unstable_bands(const std::vector<const StabilitySample*>& samples,
                                                       const std::vector<StabilityBoundary>& boundaries);

}  // namespace hb
