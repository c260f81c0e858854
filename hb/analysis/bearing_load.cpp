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

namespace {

// Mean length over the turn. It has kinks where the force passes through zero: there it settles slowly with the
// samples.
double mean_length(const FourierSeries& force) {
  constexpr Eigen::Index most_per_harmonic = 64;
  constexpr double settled = 1e-12;
  const Eigen::Index H = std::max<Eigen::Index>(force.num_harmonics(), 16);
  for (Eigen::Index per_harmonic = 8;; per_harmonic *= 2) {
    const Eigen::Index N = fourier::fast_length(per_harmonic * H);
    const Eigen::RowVectorXd length = fourier::synthesise(force, N).colwise().norm();
    const double mean = length.mean(), of_half = length(Eigen::seqN(0, N / 2, 2)).mean();
    if (std::abs(mean - of_half) <= settled * mean || per_harmonic >= most_per_harmonic) return mean;
  }
}

// Of the length, which is that of the components together: sum over all harmonics, both signs, of |c|^2.
double rms_length(const FourierSeries& force) {
  const double constant = force.c.col(0).squaredNorm();
  return std::sqrt(constant + 2 * force.c.rightCols(force.num_harmonics()).squaredNorm());
}

}  // namespace

std::vector<BearingLoad> bearing_loads(const JointForces& forces, int turns) {
  std::vector<BearingLoad> loads;
  for (const JointForce& joint : forces.joints) {
    BearingLoad load{joint.name, largest_length(joint.rigid), largest_length(joint.elastic), 0, 0};
    if (joint.elastic.num_harmonics() >= 0) {
      load.mean = mean_length(joint.elastic);
      load.rms = rms_length(joint.elastic);
    }
    for (Extremum* peak : {&load.rigid, &load.elastic}) peak->crank_angle *= turns;
    loads.push_back(std::move(load));
  }
  return loads;
}

}  // namespace hb
