// What rows beyond those that a window reaches answer, resonances of faster modes among them: hb/engine/README.md
// (S12).
#pragma once

#include "hb/engine/steady/steady_operator.hpp"

namespace hb::steady {

// max_i sum_j |T_ij| sizes_j.
[[nodiscard]] double weigh(const Eigen::VectorXd& sizes, const Eigen::MatrixXd& T);

// Size in q of what rows k > R answer to harmonics before them and to their own loads; infinite where no end is seen.
// The harmonics before are x and rest/D of rows H+1..R, both (R+1) x I, taken to be of size `known` in q altogether;
// loads: rows beyond R of r.
[[nodiscard]] double answered_beyond(const WeightedSystem& system, const Spectrum& x, const Spectrum& rest,
                                     const Spectrum& r, Eigen::Index H, double known, const Eigen::MatrixXd& T);

}  // namespace hb::steady
