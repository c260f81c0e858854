#include "hb/analysis/nonlinear/motion_loads.hpp"

namespace hb {

std::optional<MachineLoads> machine_loads(const Linkage& linkage, const NonlinearResult& result) {
  if (!result.forces || !result.frame) return std::nullopt;
  MachineLoads loads;
  loads.bearings = bearing_loads(*result.forces, result.turns);
  loads.frame = *result.frame;
  const auto resultant = [&](const FourierSeries& frame) {
    Extremum peak = largest_length(FourierSeries(Eigen::MatrixXcd(frame.c.topRows(2))));
    peak.crank_angle *= result.turns;
    return peak;
  };
  loads.shaking_force = resultant(loads.frame.elastic);
  loads.shaking_force_rigid = resultant(loads.frame.rigid);
  if (result.frame_errors) {
    loads.shaking_force_error = result.frame_errors->force;
    loads.shaking_moment_error = result.frame_errors->moment;
  }
  loads.drive = drive_of(result.forces->torque, result.speed, result.turns);
  loads.drive_rigid = drive_of(result.forces->torque_rigid, result.speed, result.turns);
  loads.inertia = crank_inertia(linkage);
  if (loads.inertia > 0) loads.speed_fluctuation = speed_fluctuation(loads.drive, loads.inertia, result.speed);
  return loads;
}

}  // namespace hb
