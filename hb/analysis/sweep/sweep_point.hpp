// Everything asked for at one place of a sweep.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hb/analysis/drive.hpp"
#include "hb/analysis/machine_loads.hpp"
#include "hb/analysis/sweep/sweep_scene.hpp"
#include "hb/engine/boundaries/stability_sample.hpp"

namespace hb {

// Smallest and largest over the turn.
struct TurnRange {
  double min = 0, max = 0;
};

// StressCycle and RodStress in short, scene's units; safeties infinite without stress.
struct StressPoint {
  double axial = 0, bending = 0;  // the largest of each, at their own places and times
  double axial_error = 0, bending_error = 0;
  double max_abs = 0, mean = 0, amplitude = 0;
  double x = 0, crank_angle = 0;  // of max_abs; rad
  double error = 0;  // of these four, an estimate; infinite where no more modes were looked at
  std::optional<double> yield_safety, fatigue_safety;
  double yield_safety_error = 0, fatigue_safety_error = 0;
};

// MachineLoads in short, elastic.
struct MachinePoint {
  std::vector<double> bearings;  // largest resultant of each joint
  double shaking_force = 0;  // largest resultant
  TurnRange shaking_moment;
  Drive drive;
  std::optional<double> speed_fluctuation, speed_fluctuation_error;
  double bearing_error = 0, shaking_force_error = 0, shaking_moment_error = 0, torque_error = 0, power_error = 0;
  double energy_error = 0;
};

[[nodiscard]] MachinePoint machine_point(const MachineLoads& loads, double speed);

struct RodPoint {
  std::optional<SteadyStatus> steady;  // empty: not asked for
  int num_harmonics = 0;
  double error_bound = 0, resonance_distance = 0;
  std::vector<double> max_abs;  // of each q_i over the turn; empty if singular
  std::optional<double> deflection, bending_moment;  // largest over rod and turn
  std::optional<double> deflection_error, bending_moment_error;  // PeakErrors; empty: no more modes were looked at
  std::optional<double> buckling_share, buckling_share_error, strain;  // RodStress, beside them
  std::optional<StressPoint> stress;  // with a section
  // TheoryErrors::Rod::q and deflection; empty: beyond the linear theory, or not asked for.
  std::optional<double> theory_error, deflection_theory_error;
  std::optional<StabilitySample> stability;
};

struct SweepPoint {
  double x = 0, speed = 0;
  std::string problem;  // no linkage at this x: why; everything below is empty then
  std::vector<RodPoint> rods;
  std::string theory_reason;  // TheoryErrors::reason
  // TheoryErrors, where asked for.
  std::optional<double> force_theory_error, torque_theory_error, mean_torque_theory_error, growth_theory_error;
  std::vector<TurnRange> joints, joints_rigid;  // per component, in the order of SweepResult::joint_components
  std::optional<TurnRange> torque, torque_rigid;
  std::optional<ForceErrors> force_errors;  // beside them
  std::optional<MachinePoint> machine;
};

// Stability::solved of each rod.
using PointSolution = std::vector<std::vector<SlavingStart>>;

struct PointOptions {
  // Where slaving begins: decides how long it takes and moves what comes out by less than its error.
  const PointSolution* start = nullptr;
  PointSolution* solution = nullptr;  // takes what slaving came to
  std::vector<bool> at_boundary;  // rods with growth rate zero, an end of a band: no second method seeks its sign
  std::vector<bool> at_pole;  // rods whose response has no bound: it is told roughly, its error bound infinite
};

[[nodiscard]] SweepPoint analyse_point(const SweepScene& scene, double x, const Only& wanted,
                                       const PointOptions& options = {});

}  // namespace hb
