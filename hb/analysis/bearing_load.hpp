// The resultant at each joint: what a bearing is chosen by.
#pragma once

#include <string>
#include <vector>

#include "lib/linkage/joint_forces.hpp"

namespace hb {

struct BearingLoad {
  std::string joint;
  Extremum rigid, elastic;  // largest length of the force over the turn, and where
  double mean = 0, rms = 0;  // of the length, elastic
};

// Harmonic k of the forces is k/turns times a turn; crank angles are over all turns.
[[nodiscard]] std::vector<BearingLoad> bearing_loads(const JointForces& forces, int turns = 1);

// Largest length of a force given by its components.
[[nodiscard]] Extremum largest_length(const FourierSeries& force);

}  // namespace hb
