// What a cross-section carries over a turn: axial and bending stress together, at the outer fibres of the section.
#pragma once

#include <functional>
#include <optional>

#include "hb/analysis/safety.hpp"
#include "lib/linkage/linkage.hpp"
#include "lib/rod/rod.hpp"

namespace hb {

// Where fatigue is nearest: its own place, of all places and fibres.
struct FatigueSafety {
  SafetyFactor factor;
  double mean = 0, amplitude = 0;  // there
  double x = 0;
  int side = 1;
  double largest_at = 0, smallest_at = 0;  // crank angles of the ends of its range, rad
};

// Of (D1), (D2) in hb/analysis/README.md: sigma(x, tau) = N/F + side M e/J with N the axial force of the rigid
// mechanism, M the bending moment, e half of the section's height and side = +1 or -1 the fibre. Stresses mass/(length
// time^2), tension positive.
struct StressCycle {
  double max_abs = 0;  // of all places, fibres and crank angles
  double x = 0, crank_angle = 0;  // where, from joint 0; rad
  int side = 1;
  // Of the place and fibre with the largest amplitude: half of largest minus smallest, and half of their sum.
  double amplitude = 0, mean = 0;
  double amplitude_x = 0;
  int amplitude_side = 1;
  double error = 0;  // of each of these stresses, an estimate: modes and harmonics left out
  std::optional<SafetyFactor> yield;  // S_y/max_abs, where the yield strength is known
  std::optional<FatigueSafety> fatigue;  // where fatigue_line is known
};

// Stresses of a motion at places x, a row for each, at equally spaced crank angles: of N/F and of M e/J.
struct StressSamples {
  Eigen::MatrixXd axial, bending;
};
using StressField = std::function<StressSamples(const Eigen::Ref<const Eigen::VectorXd>& x)>;

// The places at which a cycle is looked for first, joint 0 to joint 1.
[[nodiscard]] Eigen::VectorXd stress_places(const Body& link, Eigen::Index num_modes);
// `grid`: the field at these places; `error`: of its stresses. Needs elastic.section_height.
[[nodiscard]] StressCycle stress_cycle(const Body& link, const StressField& field, const StressSamples& grid,
                                       double error);

// By the linear theory. `more_modes`: the response with more modes, or empty: then the error is that of `error_bound`
// alone, which is relative to the largest |q|. Needs elastic.section_height.
[[nodiscard]] StressCycle stress_cycle(const Body& link, const RodCoefficients& rod, double speed,
                                       const FourierSeries& q, const FourierSeries& more_modes, double error_bound);

// Smallest and largest stress over the turn at equally spaced places from joint 0 to joint 1, of both fibres.
struct StressEnvelope {
  Eigen::VectorXd x;
  Eigen::VectorXd smallest[2], largest[2];  // side +1, side -1
};
[[nodiscard]] StressEnvelope stress_envelope(const Body& link, const StressField& field, Eigen::Index points);
[[nodiscard]] StressEnvelope stress_envelope(const Body& link, const RodCoefficients& rod, double speed,
                                             const FourierSeries& q, Eigen::Index points);

}  // namespace hb
