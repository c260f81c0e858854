// From a residual to a bound on the error: |A^-1 r| <= (response of A) * |r / size of D| inside the window, the
// residual of the rows outside divided by D there. All sizes are those of q: max over its components of the sum over
// all harmonics, which is at least the maximum over the turn.
#pragma once

#include "hb/steady_operator.hpp"

namespace hb::steady {

// max_i sum_j |T_ij| (sum over harmonics of |x_j|).
[[nodiscard]] double size_in_q(const Spectrum& x, const Eigen::MatrixXd& T);

// Norm of A^-1 |D| (|D| without cancellation: k^2 + k |G_ii| + |w_i^2|), estimated by a solve for a random load and
// one inverse iteration: 1 far from resonance, infinite at it, NaN if the inverse fails.
[[nodiscard]] double response(Operator& A, Inverse& inverse, const Eigen::MatrixXd& T);

// Safety times response times the size in q of r/|D|; `r` holds moduli, (H+1) x I.
[[nodiscard]] double amplified(const Operator& A, const Eigen::MatrixXd& r, double response, const Eigen::MatrixXd& T);
// The same for sums over harmonics of |r|/|D|, per component.
[[nodiscard]] double amplified(const Eigen::VectorXd& sizes, double response, const Eigen::MatrixXd& T);

// Row k > H of the residual, divided by |D(k)|, in q.
[[nodiscard]] double tail_row(const Operator& A, const Spectrum& r, Eigen::Index k, const Eigen::MatrixXd& T);

// What rows outside can do beyond r/D: feed back into the window, and couple among themselves.
[[nodiscard]] double tail_slack(const Operator& A, double response);

// True if an undamped mode whose coupling cannot shift it is in resonance with a harmonic beyond H, to rounding.
[[nodiscard]] bool resonant_beyond(const WeightedSystem& system, Eigen::Index H);

}  // namespace hb::steady
