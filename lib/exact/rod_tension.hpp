// The axial force along the bent rods of a motion, by the exact model.
#pragma once

#include <vector>

#include "lib/exact/exact_model.hpp"

namespace hb {

// Smallest and largest along one rod over the angles; tension positive.
struct TensionRange {
  double low = 0, high = 0;
};

// Of every rod of the model, in its order. Not finite where the model breaks down.
[[nodiscard]] std::vector<TensionRange> rod_tensions(const ExactModel& model, double speed, const CrankAngles& angles,
                                                     const RitzSamples& motion);

}  // namespace hb
