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

Stability with_certain_verdict(const ScaledSystem& system, const StabilityOptions& options) {
  if (options.leading_only) {
    StabilityOptions found = options;
    found.as_found = found.growth_suffices = true;
    Stability stability = with_finite_growth(system, found);
    if (stability.verdict != Verdict::undecided) return stability;
  }
  return with_finite_growth(system, options);
}

}  // namespace hb
