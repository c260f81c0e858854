// Axial and bending stress together as numbers that a design can be chosen by.
#pragma once

#include <string>

#include "hb/analysis/stress_cycle.hpp"
#include "hb/analysis/tune/tune_metric.hpp"
#include "lib/rod/rod_functional.hpp"

namespace hb {

// Of MetricKind::total_stress the largest |sigma|, mass/(length time^2); of MetricKind::safety the larger of sigma/S_y
// and fatigue_usage, 1 over the safety, of those that the strengths give.
struct StressPeak {
  double value = 0, error = 0;
  double x = 0;
  int side = 1;
  double largest_at = 0, smallest_at = 0;  // crank angles; those of the cycle's ends where fatigue is nearer
  bool fatigue = false;
  bool mean_counts = false;  // fatigue at a mean that pulls
  std::string against;  // of a safety: "yielding", "fatigue (Goodman)"
};
[[nodiscard]] StressPeak stress_peak(MetricKind kind, const StressCycle& cycle, const Strength& strength);

// Throws RequestError where they give no safety, with the keys to add.
void require_strength(const Body& link, const Metric& metric);

// The peak's value as a function of the response, for `link` or a design beside it: the place keeps its part of the
// length. Up to the sign of a stress.
[[nodiscard]] RodFunctional stress_functional(MetricKind kind, const Body& link, const RodCoefficients& rod,
                                              double speed, Eigen::Index num_modes, Eigen::Index num_harmonics,
                                              const StressPeak& peak, double part_of_length);

}  // namespace hb
