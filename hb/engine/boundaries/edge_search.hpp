// Every boundary of stability along one edge of a map.
#pragma once

#include <optional>
#include <vector>

#include "hb/engine/boundaries/mode_tracks.hpp"
#include "hb/engine/boundaries/sweep.hpp"

namespace hb {

class EdgeSearch {
 public:
  EdgeSearch(const SweepOptions& options, int num_modes);

  // Between a and b, ascending: where the verdict changes, and tongues (or gaps between two) that both ends do not see.
  [[nodiscard]] std::vector<StabilityBoundary> boundaries(const SystemAt& along, const StabilitySample& a,
                                                          const StabilitySample& b) const;

 private:
  struct Tracked {
    StabilitySample sample;
    std::vector<ModeState> modes;
  };

  static Tracked tracked(StabilitySample sample, const Tracked& p, const Tracked& q);
  StabilityBoundary located(const SystemAt& along, const StabilitySample& p, const StabilitySample& q) const;
  std::optional<StabilitySample> at_centre(const SystemAt& along, const Tracked& a, const Tracked& b, std::size_t mode,
                                           double k) const;
  std::vector<StabilitySample> look_at_centres(const SystemAt& along, const Tracked& a, const Tracked& b) const;

  SweepOptions options_, located_;  // for what lies between two places; for where exactly
  int num_modes_;
};

// Of exponents that only tell what lies where; boundaries take what was asked.
[[nodiscard]] StabilityOptions rough_exponents(StabilityOptions options);

}  // namespace hb
