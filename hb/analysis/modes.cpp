#include "hb/analysis/modes.hpp"

#include <algorithm>

#include "hb/analysis/linkage_analysis.hpp"

namespace hb {

int start_modes(const Modes& modes) {
  constexpr int first_auto_modes = 3;
  return is_auto(modes) ? first_auto_modes : std::get<int>(modes);
}

Eigen::Index comparison_modes(Eigen::Index num_modes) { return num_modes + std::max<Eigen::Index>(3, num_modes / 2); }

Eigen::Index more_modes(Eigen::Index num_modes) {
  return std::min<Eigen::Index>(comparison_modes(num_modes), max_modes);
}

int most_modes(const std::vector<RodResult>& rods, int least) {
  for (const RodResult& rod : rods)
    least = std::max({least, static_cast<int>(rod.num_modes), static_cast<int>(rod.growth_modes)});
  return least;
}

}  // namespace hb
