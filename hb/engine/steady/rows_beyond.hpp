// What rows beyond those that a window reaches answer, resonances of faster modes among them: hb/engine/README.md
// (S12).
#pragma once

#include "hb/engine/steady/steady_operator.hpp"

namespace hb::steady {

// max_i sum_j |T_ij| sizes_j.
[[nodiscard]] double weigh(const Eigen::VectorXd& sizes, const Eigen::MatrixXd& T);

// Size in q of what rows k > R answer to harmonics before them, over that of these, which are x and r/D of rows
// first..R of x and r, both (R+1) x I; infinite where no end is seen.
[[nodiscard]] double answered_beyond(const WeightedSystem& system, const Spectrum& x, const Spectrum& r,
                                     Eigen::Index first, const Eigen::MatrixXd& T);

}  // namespace hb::steady
