// Resonance peaks of one rod along a sweep: where to look for them, and which mode is met there.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "hb/analysis/sweep/rod_along.hpp"
#include "hb/engine/boundaries/mode_tracks.hpp"
#include "hb/engine/boundaries/stability_sample.hpp"

namespace hb {

// max |q_i| of every i at one place.
struct ResponseSample {
  double x;
  std::vector<double> max_abs;
};

// What is known of a rod at a place of the sweep.
struct ResponsePlace {
  double x = 0, speed = 0;
  int num_harmonics = 0;
  const std::vector<double>& max_abs;
  const std::vector<ModeState>& modes;
};

// Resonances omega_j = n Omega that pass between two places and are narrower than their distance: samples on top and
// on both flanks, ascending.
[[nodiscard]] std::vector<ResponseSample> resonances_between(const RodAlong& rod, const ResponsePlace& a,
                                                             const ResponsePlace& b);

// Inside an interval that has no other one beside it, where a maximum need not show on its ends. Ascending.
[[nodiscard]] std::vector<ResponseSample> samples_inside(const RodAlong& rod, double a, double b);

// On both sides of a place without a response, not equally far: halving the way between them does not lead back to it.
// Empty where there is none there either.
[[nodiscard]] std::vector<ResponseSample> beside_pole(const RodAlong& rod, double x, double distance);

// A maximum of |q_i|, i = component + 1, with a place on either side that is not higher.
struct Maximum {
  int component;
  double low, inside, high;
  double prominence;  // height above the higher of the two valleys beside it, relative
};

// Of each component, those places where it is the largest one.
[[nodiscard]] std::vector<Maximum> local_maxima(const std::vector<ResponseSample>& samples, int num_components);

// Whether the frequency of a mode is near n Omega, and then n, from 1.
[[nodiscard]] std::optional<int> order_met(const ModeState& mode, double speed);

}  // namespace hb
