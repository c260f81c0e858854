// What a machine's designer reads beside joint forces, of one answer of the linear theory: bearings, frame, drive and
// flywheel.
#pragma once

#include <optional>
#include <vector>

#include "hb/analysis/bearing_load.hpp"
#include "hb/analysis/drive.hpp"
#include "hb/analysis/force_error.hpp"
#include "hb/analysis/frame_forces.hpp"
#include "hb/analysis/linkage_analysis.hpp"

namespace hb {

struct MachineLoads {
  std::vector<BearingLoad> bearings;
  FrameForces frame;
  Extremum shaking_force, shaking_force_rigid;  // largest resultant
  double shaking_force_error = 0, shaking_moment_error = 0;  // bounds from those of joint forces and torque
  Drive drive, drive_rigid;
  double inertia = 0;  // of the crank about its pivot
  std::optional<double> speed_fluctuation;  // where the crank has inertia
};

// Moment of inertia of the crank about its pivot: what the torque's fluctuation accelerates.
[[nodiscard]] double crank_inertia(const Linkage& linkage);

// Of a linkage and its joint forces at this speed (rad per unit time). Without `errors` the bounds are 0.
[[nodiscard]] MachineLoads machine_loads(const Linkage& linkage, double speed, const JointForces& forces,
                                         const std::vector<LinkResponse>& responses,
                                         const std::optional<ForceErrors>& errors);
// Empty where joint forces were not computed.
[[nodiscard]] std::optional<MachineLoads> machine_loads(const SceneModel& model, const SpeedResult& result);

}  // namespace hb
