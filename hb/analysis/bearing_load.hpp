// The resultant at each joint: what a bearing is chosen by.
#pragma once

#include <string>
#include <vector>

#include "lib/linkage/joint_forces.hpp"

namespace hb {

struct BearingLoad {
  std::string joint;
  Extremum elastic;  // largest length of the force over the turn, and where
  Extremum rigid;  // likewise, without the rods' deflection
  double mean = 0, rms = 0;  // of the length, elastic
};

// Of a machine's loads: those that come from the elastic answer's peaks and harmonics alone, or all.
enum class LoadDetail { largest, all };

// Harmonic k of the forces is k/turns times a turn; crank angles are over all turns. `largest`: `elastic` alone.
[[nodiscard]] std::vector<BearingLoad> bearing_loads(const JointForces& forces, int turns = 1,
                                                     LoadDetail detail = LoadDetail::all);

}  // namespace hb
