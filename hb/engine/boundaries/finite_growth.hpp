// Exponents at one place of a sweep or map.
#pragma once

#include "hb/engine/exponents/stability.hpp"

namespace hb {

// With options.leading_only: all exponents all the same where the leading ones alone give no bound.
[[nodiscard]] Stability with_finite_growth(const ScaledSystem& system, const StabilityOptions& options);

// The verdict, with options.leading_only from the leading exponents as they are found where these decide; else as
// accurately as the options say.
[[nodiscard]] Stability with_certain_verdict(const ScaledSystem& system, const StabilityOptions& options);

}  // namespace hb
