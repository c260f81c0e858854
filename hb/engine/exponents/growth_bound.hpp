// Closed-form sufficient test of stability: an upper bound on the growth rate without any eigenvalue or propagation.
#pragma once

#include <Eigen/Core>

#include "hb/engine/system/scaled_system.hpp"

namespace hb {

// N samples over the turn of
//     y1' = y2 + cross y1,      y2' = -stiffness y1 - diag(damping) y2.
struct SampledSystem {
  Eigen::MatrixXd stiffness;  // N x n*n, entry (j, i) in column j + n i
  Eigen::MatrixXd cross;  // the same; empty: zero
  Eigen::VectorXd damping;  // n
};

// Upper bound on Re s per radian of crank angle: the logarithmic norm in adiabatic amplitudes, averaged over the turn.
// Per mode the amplitude (sqrt(W) y1, (y2 + g y1)/sqrt(W)), W^2 = K_jj - b^2/4, g = b/2 + W'/(2W), grows at most by
// -b/2 + |W''/(2W) - 3/4 (W'/W)^2|/(2W); an overdamped mode's amplitudes along its two mean roots. Couplings enter by
// the norms of their 2x2 blocks, the modes weighted by powers of the Perron vector of their means. It bounds the growth
// by an exact mean; what is taken for that is the mean over the nodes, twice its difference to every other node's, and
// an allowance for rounding. Infinite where W^2 comes near zero at a node.
[[nodiscard]] double growth_bound(const SampledSystem& system);

// Of a whole system; infinite if its damping is not diagonal.
[[nodiscard]] double growth_bound(const ScaledSystem& system);

}  // namespace hb
