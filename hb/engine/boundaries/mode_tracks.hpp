// Floquet exponents along a parameter: which belongs to which mode, and with which frequency before folding.
#pragma once

#include <vector>

#include "hb/engine/exponents/stability.hpp"

namespace hb {

// One mode at one place. NaN: not resolved there.
struct ModeState {
  double frequency = 0;  // >= 0, unfolded, rad per unit time
  double growth = 0;  // larger real part of its two exponents, 1/time
  double growth_low = 0;  // smaller one
  bool locked = false;  // two real multipliers: the frequency is a multiple of half the crank's
  double damping() const { return -0.5 * (growth + growth_low); }
};

// By mode as the exponents name it; as many entries as the system has modes.
[[nodiscard]] std::vector<ModeState> modes_by_name(const Stability& stability, int num_modes);

// The exponents given to the modes whose expected state (from neighbouring places) is nearest in frequency and growth;
// of the frequencies |+-Im + k Omega| that an exponent may have, the one nearest to what is expected.
[[nodiscard]] std::vector<ModeState> modes_by_continuity(const Stability& stability, double speed,
                                                         const std::vector<ModeState>& expected);

struct TrackedPlace {
  double x = 0, speed = 0;
  const Stability* stability = nullptr;  // null: nothing known there
};

// One entry per place, each with one state per mode: followed from place to place by linear extrapolation, so that
// crossings stay crossings. `places` in ascending order of x.
[[nodiscard]] std::vector<std::vector<ModeState>> track_modes(const std::vector<TrackedPlace>& places, int num_modes);

}  // namespace hb
