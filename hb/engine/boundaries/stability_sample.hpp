// What is known of a system's stability at one value of a parameter.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/mean_exponents.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/system/scaled_system.hpp"

namespace hb {

struct StabilitySample {
  double x = 0;
  double speed = 0;  // rad per unit time
  Stability stability;
  std::vector<MeanExponent> mean = {};  // may be empty: then it is computed where it is needed
  double growth_bound = HUGE_VAL;  // in closed form, per radian of crank angle
};

// The system at x, in the solvers' coordinates; empty where there is none (a linkage that does not close). Same x, same
// result.
using SystemAt = std::function<std::optional<ScaledSystem>(double x)>;

// With options.leading_only: all exponents all the same where the leading ones alone give no bound.
[[nodiscard]] StabilitySample stability_sample(const ScaledSystem& system, double x, const StabilityOptions& options);
[[nodiscard]] std::optional<StabilitySample> stability_sample(const SystemAt& at, double x,
                                                              const StabilityOptions& options);
// With mean exponents only where the bound proves no decay: elsewhere a search of the intervals beside seldom goes so
// far.
[[nodiscard]] StabilitySample grid_sample(const ScaledSystem& system, double x, const StabilityOptions& options);

[[nodiscard]] inline bool is_unstable(const StabilitySample& sample) {
  return sample.stability.verdict == Verdict::unstable;
}

}  // namespace hb
