// What a design can be chosen by: quantities that are one number each, the worst over the speed range, and their
// notation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace hb {

enum class MetricKind {
  deflection,  // largest |w| over rod, turn and speeds
  stress,  // largest bending stress E J w'' h/(2 J), h the section's height
  total_stress,  // largest |N/F +- M h/(2 J)|, both at one place and crank angle
  safety,  // smallest of those against yielding and fatigue that the rod's strengths give (safety.hpp)
  force,  // largest joint force
  torque_ripple,  // largest minus smallest driving torque over the turn
  mass,  // of the elastic links
  frequency,  // lowest natural frequency at rest
  margin,  // decay rate of the slowest disturbance: minus the largest growth rate
  margin_per_turn,
  theory,  // theory error of q (theory_error.hpp); where it has no value, 1 + the largest slope
  clearance,  // distance of omega_1/(n Omega) from 1 over all speeds, n = 1..orders; negative inside
  speed_range,  // last minus first speed
};

struct Metric {
  MetricKind kind = MetricKind::deflection;
  std::string name;  // of one rod or joint; empty: the worst of all (mass: the sum)
  int orders = 1;  // of clearance
  std::string text;  // as written
  bool operator==(const Metric& other) const { return text == other.text; }
};

struct GoalTerm {
  double weight = 1;
  Metric metric;
};

// A single term as it is, or a weighted sum of terms over their values at the start.
struct Goal {
  std::vector<GoalTerm> terms;
  bool weighted = false;
  bool maximise = false;
  std::string text;
};

struct Keep {
  Metric metric;
  bool at_least = false;
  double bound = 0;
  std::string text;
};

// Throw RequestError for the field minimise, maximise or keep.
[[nodiscard]] Goal parse_goal(const std::string& text);  // "deflection", "0.7*deflection+0.3*mass"
[[nodiscard]] Goal parse_largest_goal(const std::string& text);  // "stable", "speed-range"
[[nodiscard]] Keep parse_keep(const std::string& text);  // "stable", "stable>=5", "stable>=0.1/turn", "force:B<=200"

[[nodiscard]] bool depends_on_speed(MetricKind kind);
[[nodiscard]] bool better_large(MetricKind kind);
[[nodiscard]] bool needs_forces(const Metric& metric);
[[nodiscard]] bool is_whole_stress(const Metric& metric);  // total_stress, safety
[[nodiscard]] bool is_margin(const Metric& metric);
// Scene's length and mass; N, N m, MPa, Hz, rpm. The unknowns of a [hill] scene have no unit.
[[nodiscard]] std::string unit_of(MetricKind kind, const Scene& scene);

}  // namespace hb
