// How many harmonics: the one rule. Predicted from the decay of load and stiffness; whether the prediction was enough
// is decided by the exact residual of what was left out, never by this file.
#pragma once

#include "hb/engine/steady/steady_operator.hpp"

namespace hb::steady {

// Smallest H at which a majorant of the solution has decayed below `tolerance`, at least 2.
[[nodiscard]] Eigen::Index predicted_harmonics(const WeightedSystem& system, double tolerance, Eigen::Index most);

}  // namespace hb::steady
