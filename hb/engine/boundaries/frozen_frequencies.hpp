// Frequencies with the stiffness of each angle in turn, hb/engine/README.md (B13).
#pragma once

#include <Eigen/Core>

#include "lib/fourier/fourier.hpp"

namespace hb {

// w_n, per radian, ascending, of I modes with the stiffness K (I*I components, symmetric at all angles) and each its
// own damping b_n, to second order in how fast the modes turn. Empty where they change too fast to be followed through
// the turn.
[[nodiscard]] Eigen::VectorXd frozen_frequencies(const FourierSeries& K, const Eigen::VectorXd& b);

}  // namespace hb
