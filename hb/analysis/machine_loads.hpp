// What a machine's designer reads beside joint forces, of one answer of the linear theory: bearings, frame, drive and
// flywheel.
#pragma once

#include <optional>
#include <vector>

#include "hb/analysis/bearing_load.hpp"
#include "hb/analysis/drive.hpp"
#include "hb/analysis/force_error.hpp"
#include "hb/analysis/linkage_analysis.hpp"

namespace hb {

struct MachineLoads {
  std::vector<BearingLoad> bearings;
  FrameForces frame;
  Extremum shaking_force, shaking_force_rigid;  // largest resultant
  // Bounds from the estimated errors of joint forces and torque; infinite where these are.
  double bearing_error = 0;  // of each resultant
  double shaking_force_error = 0, shaking_moment_error = 0;
  double torque_error = 0, energy_error = 0;  // of all of Drive's torques, and of its energy
  Drive drive, drive_rigid;
  std::optional<double> mean_theory_error;  // TheoryErrors::mean_torque, of the linear theory
  double inertia = 0;  // of the crank about its pivot
  std::optional<double> speed_fluctuation, speed_fluctuation_error;  // where the crank has inertia

  // Of all of Drive's powers.
  [[nodiscard]] double power_error(double speed) const { return speed * torque_error; }
};

// Fills drives, speed fluctuation and what the errors of joint forces and torque leave of bearings and drive, of forces
// over `turns` turns. Needs bearings and inertia.
void add_drive(MachineLoads& loads, const JointForces& forces, double speed, int turns, const ForceErrors& errors,
               LoadDetail detail);

// Moment of inertia of the crank about its pivot: what the torque's fluctuation accelerates.
[[nodiscard]] double crank_inertia(const Linkage& linkage);

// Of a linkage and its joint forces at this speed (rad per unit time). `largest` leaves rigid loads and the bearings'
// mean and rms at zero.
[[nodiscard]] MachineLoads machine_loads(const Linkage& linkage, double speed, const JointForces& forces,
                                         const ForceErrors& errors, LoadDetail detail = LoadDetail::all);
// Empty where joint forces were not computed.
[[nodiscard]] std::optional<MachineLoads> machine_loads(const SceneModel& model, const SpeedResult& result);

}  // namespace hb
