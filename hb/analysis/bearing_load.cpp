#include "hb/analysis/bearing_load.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

Extremum largest_length(const FourierSeries& force) {
  if (force.num_harmonics() < 0) return {};
  if (force.num_components() == 1) return fourier::max_abs(force, 0);
  // Its square has twice the harmonics.
  const Eigen::MatrixXd samples = fourier::synthesise(force, fourier::fast_length(4 * force.num_harmonics() + 4));
  const Eigen::MatrixXd square = samples.colwise().squaredNorm();
  Extremum peak = fourier::range(fourier::analyse(square), 0).max;
  peak.value = std::sqrt(std::max(0.0, peak.value));
  return peak;
}

std::vector<BearingLoad> bearing_loads(const JointForces& forces, int turns) {
  // The length has kinks where the force passes through zero: its mean settles slowly with the samples.
  constexpr Eigen::Index samples_per_harmonic = 64;
  std::vector<BearingLoad> loads;
  for (const JointForce& joint : forces.joints) {
    BearingLoad load{joint.name, largest_length(joint.rigid), largest_length(joint.elastic), 0, 0};
    if (joint.elastic.num_harmonics() >= 0) {
      const Eigen::Index N =
          fourier::fast_length(samples_per_harmonic * std::max<Eigen::Index>(joint.elastic.num_harmonics(), 16));
      const Eigen::RowVectorXd length = fourier::synthesise(joint.elastic, N).colwise().norm();
      load.mean = length.mean();
      load.rms = std::sqrt(length.squaredNorm() / static_cast<double>(N));
    }
    for (Extremum* peak : {&load.rigid, &load.elastic}) peak->crank_angle *= turns;
    loads.push_back(std::move(load));
  }
  return loads;
}

}  // namespace hb
