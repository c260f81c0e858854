// What rows beyond those that a window reaches answer, resonances of faster modes among them: hb/engine/README.md
// (S12).
#pragma once

#include "hb/engine/steady/steady_operator.hpp"

namespace hb::steady {

// max_i sum_j |T_ij| sizes_j.
[[nodiscard]] double weigh(const Eigen::VectorXd& sizes, const Eigen::MatrixXd& T);

// Size in q of what rows k > R answer to `before`, (R+1) x I moduli of harmonics up to R; infinite where no end is
// seen.
[[nodiscard]] double answered_beyond(const WeightedSystem& system, const Eigen::MatrixXd& before,
                                     const Eigen::MatrixXd& T);

}  // namespace hb::steady
