// The engine's collocation in 80 bits: what rounds in its maps is told from their truncation.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lib/fourier/fourier.hpp"

namespace hb::attack {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

// Maps of (W x, x'), W = diag(scale), over the cells of one turn of x'' + beta x' + alpha x = 0 by Radau IIA with 8
// stages; alpha and beta have m*m components, column-major.
[[nodiscard]] std::vector<LongMatrix> long_radau_turn(const FourierSeries& alpha, const FourierSeries& beta,
                                                      Eigen::Index num_cells, const Eigen::VectorXd& scale);

}  // namespace hb::attack
