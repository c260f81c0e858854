#include "hb/engine/boundaries/stability_sample.hpp"

#include "hb/engine/boundaries/finite_growth.hpp"
#include "hb/engine/exponents/growth_bound.hpp"

namespace hb {

StabilitySample stability_sample(const ScaledSystem& system, double x, const StabilityOptions& options) {
  return {x, system.speed, with_finite_growth(system, options), mean_exponents(system), growth_bound(system)};
}

StabilitySample grid_sample(const ScaledSystem& system, double x, const StabilityOptions& options) {
  StabilitySample sample{x, system.speed, with_finite_growth(system, options), {}, growth_bound(system)};
  if (!(sample.growth_bound < 0)) sample.mean = mean_exponents(system);
  return sample;
}

std::optional<StabilitySample> stability_sample(const SystemAt& at, double x, const StabilityOptions& options) {
  const std::optional<ScaledSystem> system = at(x);
  if (!system) return std::nullopt;
  return stability_sample(*system, x, options);
}

}  // namespace hb
