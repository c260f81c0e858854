#include "hb/analysis/nonlinear/motion_loads.hpp"

namespace hb {

std::optional<MachineLoads> machine_loads(const Linkage& linkage, const NonlinearResult& result, LoadDetail detail) {
  if (!result.forces) return std::nullopt;
  MachineLoads loads;
  loads.bearings = bearing_loads(*result.forces, result.turns, detail);
  loads.frame = result.forces->frame;
  const auto resultant = [&](const FourierSeries& frame) {
    Extremum peak = fourier::largest_length(FourierSeries(Eigen::MatrixXcd(frame.c.topRows(2))));
    peak.crank_angle *= result.turns;
    return peak;
  };
  loads.shaking_force = resultant(loads.frame.elastic);
  if (detail == LoadDetail::all) loads.shaking_force_rigid = resultant(loads.frame.rigid);
  if (result.frame_errors) {
    loads.shaking_force_error = result.frame_errors->force;
    loads.shaking_moment_error = result.frame_errors->moment;
  }
  loads.inertia = crank_inertia(linkage);
  add_drive(loads, *result.forces, result.speed, result.turns, *result.force_errors, detail);
  return loads;
}

}  // namespace hb
