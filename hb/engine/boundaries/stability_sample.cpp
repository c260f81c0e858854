#include "hb/engine/boundaries/stability_sample.hpp"

#include <cmath>

#include "hb/engine/exponents/growth_bound.hpp"

namespace hb {

StabilitySample stability_sample(const ScaledSystem& system, double x, const StabilityOptions& options) {
  StabilitySample sample{x, system.speed, analyse_stability(system, options), mean_exponents(system),
                         growth_bound(system)};
  if (options.leading_only && !std::isfinite(sample.stability.growth_rate + sample.stability.growth_error)) {
    StabilityOptions all = options;
    all.leading_only = false;
    sample.stability = analyse_stability(system, all);
  }
  return sample;
}

std::optional<StabilitySample> stability_sample(const SystemAt& at, double x, const StabilityOptions& options) {
  const std::optional<ScaledSystem> system = at(x);
  if (!system) return std::nullopt;
  return stability_sample(*system, x, options);
}

}  // namespace hb
