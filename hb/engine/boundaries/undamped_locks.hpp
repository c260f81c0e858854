// Whether a stable gap may lie between two unstable places of a system without damping where a lock to real multipliers
// lasts. hb/engine/README.md, (B17).
#pragma once

#include <optional>

#include "hb/engine/boundaries/place_models.hpp"

namespace hb {

// NaN where a lock lasts from p to q; else where to look. Empty where that cannot be told: with damping, without a lock
// at both places, or where that may not be followed.
[[nodiscard]] std::optional<double> doubtful_while_locked(const Places& places, const Place& p, const Place& q);

}  // namespace hb
