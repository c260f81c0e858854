// A proof of the error bound, for single points: Newton-Kantorovich for the infinite block Hill system A x = f with an
// explicit approximate inverse B, dense on harmonics -N..N and D^-1 beyond,
//     e = B r + (1 - B A) e   =>   |e| <= |B r| / (1 - |1 - B A|).
// Every sum that is not exact carries an allowance for its rounding.
#pragma once

#include "hb/engine/steady/steady_operator.hpp"

namespace hb::steady {

struct Proof {
  double error = 0;  // bound on the size in q (see steady_bound) of e; infinite if nothing could be shown
  double contraction = 0;  // |1 - B A| at most, in the norm sum_j max_i |T_ij| (sum over all harmonics of |x_j|)
};

// `r` are rows 0.. of the residual, known up to `rounding`, rows and columns as in Spectrum. All harmonics of r take
// part; N = num_harmonics. Work and memory grow like (I (2N+1))^3 and ^2.
[[nodiscard]] Proof prove_error(const WeightedSystem& system, const Eigen::MatrixXd& T, Eigen::Index num_harmonics,
                                const Spectrum& r, const Eigen::MatrixXd& rounding);

// Number of unknowns that B would have.
[[nodiscard]] Eigen::Index proof_size(const WeightedSystem& system, Eigen::Index num_harmonics);

}  // namespace hb::steady
