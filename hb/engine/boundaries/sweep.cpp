#include "hb/engine/boundaries/sweep.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

std::vector<UnstableBand> unstable_bands(const std::vector<const StabilitySample*>& samples,
                                         const std::vector<StabilityBoundary>& boundaries) {
  std::vector<UnstableBand> bands;
  const StabilitySample* last = nullptr;
  UnstableBand band;
  bool inside = false;
  const auto boundary_between = [&](double from, double to) {
    return std::find_if(boundaries.begin(), boundaries.end(),
                        [&](const StabilityBoundary& b) { return b.x >= from && b.x <= to; });
  };
  const auto close = [&](double x, bool open) {
    band.to = x;
    band.open_to = open;
    bands.push_back(band);
    inside = false;
  };
  for (const StabilitySample* sample : samples) {
    if (sample == nullptr) {
      if (inside) close(last->x, true);
      last = nullptr;
      continue;
    }
    const bool unstable = is_unstable(*sample);
    if (unstable && !inside) {
      band = UnstableBand{};
      band.fastest = -HUGE_VAL;
      band.from = sample->x;
      band.open_from = true;
      band.kind_from = boundary_kind(sample->stability, sample->speed);
      if (last != nullptr) {
        const auto boundary = boundary_between(last->x, sample->x);
        if (boundary != boundaries.end()) {
          band.from = boundary->x;
          band.error_from = boundary->error;
          band.open_from = false;
          band.kind_from = boundary->kind;
        }
      }
      inside = true;
    } else if (!unstable && inside) {
      const auto boundary = boundary_between(last->x, sample->x);
      const bool known = boundary != boundaries.end();
      if (known) {
        band.kind_to = boundary->kind;
        band.error_to = boundary->error;
      }
      close(known ? boundary->x : last->x, !known);
    }
    if (unstable) {
      band.kind_to = boundary_kind(sample->stability, sample->speed);
      if (sample->stability.growth_rate > band.fastest) {
        band.fastest = sample->stability.growth_rate;
        band.fastest_x = sample->x;
      }
    }
    last = sample;
  }
  if (inside) close(last->x, true);
  return bands;
}

}  // namespace hb
