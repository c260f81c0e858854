// Where over a range of speeds one rod's disturbances decay too slowly: also in bands narrower than the distance of two
// speeds sampled.
#pragma once

#include <numbers>
#include <vector>

#include "hb/analysis/request.hpp"
#include "hb/analysis/work.hpp"
#include "lib/hill_system.hpp"

namespace hb {

// Decay that a condition asks for, 1/time or per turn.
struct RequiredDecay {
  double bound = 0;
  bool per_turn = false;
  double at(double speed) const { return per_turn ? bound * speed / (2 * std::numbers::pi) : bound; }
};

// The growth rate with its error at each of `speeds` (ascending), and further speeds between them, each the fastest
// known of a band that decays slower than one of `required` asks for. No search where growth_bound proves decay faster
// than all of them; of the others none where it cannot change the largest growth rate.
[[nodiscard]] std::vector<double> unstable_speeds(const HillSystem& system, const std::vector<RequiredDecay>& required,
                                                  const Settings& settings, const Work& work,
                                                  const std::vector<double>& speeds, std::vector<double>& growth);

}  // namespace hb
