// What an integration is going to cost, before it is begun.
#pragma once

#include "hb/engine/time/time_integration.hpp"

namespace hb {

// Eigenvalues of the frozen system over the turn, per radian of crank angle.
struct FrozenSpectrum {
  std::vector<Eigen::VectorXcd> eigenvalues;  // at equally spaced angles
  double slowest = 0;  // largest |mean real part| that matters: growth, or decay of the slowest mode
  double fastest = 0;  // largest |eigenvalue|
};
[[nodiscard]] FrozenSpectrum frozen_spectrum(ScaledMotion& motion);

// Steps over one turn cut into segments that each start anew.
[[nodiscard]] double predicted_steps(const FrozenSpectrum& spectrum, Integrator method, double tolerance,
                                     int num_segments);

// Cells between `num_outputs` equally spaced outputs that resolve the slow modes.
[[nodiscard]] int collocation_cells(const FrozenSpectrum& spectrum, int num_outputs);

// Work of a step of `num_columns` solutions side by side, in seconds of one core of about 10 GFlop/s: counted, the same
// on every machine and in every run, so that methods are compared by it.
[[nodiscard]] double work_per_step(Integrator method, Eigen::Index num_modes, Eigen::Index num_columns);

// Seconds per step of `num_columns` solutions side by side, measured now.
[[nodiscard]] double seconds_per_step(ScaledMotion& motion, Integrator method, Eigen::Index num_columns);

}  // namespace hb
