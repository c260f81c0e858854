// Exponents when nothing varies over the turn: roots of det(s^2 + s G + K) = 0.
#pragma once

#include "hb/engine/exponents/turn_exponents.hpp"
#include "hb/engine/system/scaled_system.hpp"

namespace hb {

// Of the mean of K alone; imaginary parts not folded, no particular order.
[[nodiscard]] TurnExponents constant_exponents(const ScaledSystem& system);

}  // namespace hb
