#include "hb/analysis/machine_loads.hpp"

#include <algorithm>
#include <cmath>

namespace hb {
namespace {

FourierSeries force_of_frame(const FourierSeries& frame) { return FourierSeries(Eigen::MatrixXcd(frame.c.topRows(2))); }

// What is a sum over joints: each pivot and guide has the error of a joint force, at most that far from the crank.
void add_frame_errors(MachineLoads& loads, const Linkage& linkage, const JointForces& forces,
                      const ForceErrors& errors) {
  double largest = 0, arm = 0;
  for (const BearingLoad& load : loads.bearings) largest = std::max(largest, load.elastic.value);
  for (const Dyad& dyad : linkage.dyads) {
    const auto* rocker = std::get_if<Rocker>(&dyad.closing);
    const std::complex<double> place = rocker ? rocker->pivot : std::get<Slider>(dyad.closing).guide;
    arm = std::max(arm, std::abs(place - linkage.crank.pivot) + dyad.coupler.length + linkage.crank.body.length);
  }
  const double joints = 1 + static_cast<double>(linkage.dyads.size());
  loads.shaking_force_error = std::sqrt(2.0) * joints * (errors.force + errors.force_cut) * largest;
  loads.shaking_moment_error =
      loads.shaking_force_error * arm + fourier::max_abs(forces.torque, 0).value * (errors.torque + errors.torque_cut);
}

}  // namespace

double crank_inertia(const Linkage& linkage) {
  const Body& crank = linkage.crank.body;
  return crank.inertia + crank.mass * std::norm(crank.com);
}

MachineLoads machine_loads(const Linkage& linkage, double speed, const JointForces& forces,
                           const std::vector<LinkResponse>& responses, const std::optional<ForceErrors>& errors) {
  MachineLoads loads;
  loads.bearings = bearing_loads(forces);
  loads.frame = frame_forces(linkage, speed, responses);
  loads.shaking_force = largest_length(force_of_frame(loads.frame.elastic));
  loads.shaking_force_rigid = largest_length(force_of_frame(loads.frame.rigid));
  if (errors) add_frame_errors(loads, linkage, forces, *errors);
  loads.drive = drive_of(forces.torque, speed);
  loads.drive_rigid = drive_of(forces.torque_rigid, speed);
  loads.inertia = crank_inertia(linkage);
  if (loads.inertia > 0) loads.speed_fluctuation = speed_fluctuation(loads.drive, loads.inertia, speed);
  return loads;
}

std::optional<MachineLoads> machine_loads(const SceneModel& model, const SpeedResult& result) {
  if (!result.forces) return std::nullopt;
  std::vector<LinkResponse> responses;
  for (const RodResult& rod : result.rods) responses.push_back({rod.link, rod.steady->q});
  return machine_loads(*model.linkage(), result.speed, *result.forces, responses, result.force_errors);
}

}  // namespace hb
