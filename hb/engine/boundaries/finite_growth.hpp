// Exponents at one place of a sweep or map.
#pragma once

#include "hb/engine/exponents/stability.hpp"

namespace hb {

// With options.leading_only: all exponents all the same where the leading ones alone give no bound.
[[nodiscard]] Stability with_finite_growth(const ScaledSystem& system, const StabilityOptions& options);

}  // namespace hb
