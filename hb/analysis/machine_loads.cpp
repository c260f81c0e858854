#include "hb/analysis/machine_loads.hpp"

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"

namespace hb {
namespace {

FourierSeries force_of_frame(const FourierSeries& frame) { return FourierSeries(Eigen::MatrixXcd(frame.c.topRows(2))); }

// What is a sum over joints: each pivot and guide has the error of a joint force, at most that far from the crank.
void add_frame_errors(MachineLoads& loads, const Linkage& linkage) {
  double arm = 0;
  for (const Dyad& dyad : linkage.dyads) {
    const auto* rocker = std::get_if<Rocker>(&dyad.closing);
    const std::complex<double> place = rocker ? rocker->pivot : std::get<Slider>(dyad.closing).guide;
    arm = std::max(arm, std::abs(place - linkage.crank.pivot) + dyad.coupler.length + linkage.crank.body.length);
  }
  const double joints = 1 + static_cast<double>(linkage.dyads.size());
  loads.shaking_force_error = joints * loads.bearing_error;
  loads.shaking_moment_error = loads.shaking_force_error * arm + loads.torque_error;
}

}  // namespace

// Each component of a joint's force may be wrong by its error. The energy is an integral of T less its mean over the
// shorter of two ways round, at most pi of each turn, its largest and its smallest value wrong by no more than that.
void add_drive(MachineLoads& loads, const JointForces& forces, double speed, int turns, const ForceErrors& errors,
               LoadDetail detail) {
  double largest = 0;
  for (const BearingLoad& load : loads.bearings) largest = std::max(largest, load.elastic.value);
  loads.bearing_error = std::sqrt(2.0) * (errors.force + errors.force_cut) * largest;
  loads.torque_error = (errors.torque + errors.torque_cut) * fourier::max_abs(forces.torque, 0).value;
  loads.energy_error = two_pi * turns * loads.torque_error;
  loads.drive = drive_of(forces.torque, speed, turns);
  if (detail == LoadDetail::all) loads.drive_rigid = drive_of(forces.torque_rigid, speed, turns);
  if (!(loads.inertia > 0)) return;
  loads.speed_fluctuation = speed_fluctuation(loads.drive, loads.inertia, speed);
  loads.speed_fluctuation_error = loads.energy_error / (loads.inertia * speed * speed);
}

double crank_inertia(const Linkage& linkage) {
  const Body& crank = linkage.crank.body;
  return crank.inertia + crank.mass * std::norm(crank.com);
}

MachineLoads machine_loads(const Linkage& linkage, double speed, const JointForces& forces, const ForceErrors& errors,
                           LoadDetail detail) {
  constexpr int turns = 1;
  MachineLoads loads;
  loads.bearings = bearing_loads(forces, turns, detail);
  loads.frame = forces.frame;
  loads.shaking_force = fourier::largest_length(force_of_frame(loads.frame.elastic));
  if (detail == LoadDetail::all) loads.shaking_force_rigid = fourier::largest_length(force_of_frame(loads.frame.rigid));
  loads.inertia = crank_inertia(linkage);
  add_drive(loads, forces, speed, turns, errors, detail);
  add_frame_errors(loads, linkage);
  return loads;
}

std::optional<MachineLoads> machine_loads(const SceneModel& model, const SpeedResult& result) {
  if (!result.forces) return std::nullopt;
  MachineLoads loads = machine_loads(*model.linkage(), result.speed, *result.forces,
                                     result.force_errors.value_or(ForceErrors{HUGE_VAL, HUGE_VAL, 0, 0}));
  if (result.theory) loads.mean_theory_error = result.theory->mean_torque;
  return loads;
}

}  // namespace hb
