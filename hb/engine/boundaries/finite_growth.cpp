#include "hb/engine/boundaries/finite_growth.hpp"

#include <cmath>

namespace hb {

Stability with_finite_growth(const ScaledSystem& system, const StabilityOptions& options) {
  Stability stability = analyse_stability(system, options);
  if (!options.leading_only || std::isfinite(stability.growth_rate + stability.growth_error)) return stability;
  StabilityOptions all = options;
  all.leading_only = false;
  return analyse_stability(system, all);
}

}  // namespace hb
