// The stiffness at equally spaced crank angles.
#pragma once

#include <Eigen/Core>

#include "hb/engine/system/scaled_system.hpp"

namespace hb {

// N x I*I, entry (i, j) in column i + I j; N > 2 P.
[[nodiscard]] Eigen::MatrixXd stiffness_samples(const ScaledSystem& system, Eigen::Index N);

}  // namespace hb
