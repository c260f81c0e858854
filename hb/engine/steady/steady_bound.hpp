// From a residual to a bound on the error. What the residual says is solved for, window and tail in turn,
//     e <- e + (A_window^-1 r_window, D^-1 r_tail),   r = r_0 - A e,
// until the corrections shrink; what rounding hides is (response of A) * |rounding / size of D|. All sizes are those of
// q: max over its components of the sum over all harmonics, which is at least the maximum over the turn.
#pragma once

#include <cmath>

#include "hb/engine/steady/steady_operator.hpp"

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

// e with A e = r, up to `rest`; for rows of r up to last_row(), the others are counted in `outside` as they are.
struct Correction {
  Spectrum window;
  double outside = 0;  // size in q of the rows beyond the window, which no solution on the window has
  double beyond = 0;  // size in q of what rows beyond last_row() answer, not counted in either
  bool resonance_ahead = false;  // they answer more than 0.3 of what stands before them
  double rest = 0;  // size in q of what may be missing else; infinite if the corrections do not shrink
};
// Steps go on until the last is below `enough`, in q. Where the first one and what it leaves are `negligible` already
// there is no other to measure how they shrink: `rest` is both. `hidden`: rounding hides as much. Where r says
// less than that on the window it is as good as rounding: no step is taken, `window` is zero and `rest` what r amounts
// to.
[[nodiscard]] Correction correction(Operator& A, Inverse& inverse, const Spectrum& r, double response,
                                    const Eigen::MatrixXd& T, double enough = HUGE_VAL, double negligible = 0,
                                    double hidden = 0);

// Sizes in q of rows of a residual divided by |D(k)|, those of harmonics k = first, first + 1, ...
[[nodiscard]] Eigen::VectorXd sizes_of_rows(const WeightedSystem& system, const Spectrum& rows, Eigen::Index first,
                                            const Eigen::MatrixXd& T);

// Guess of what rows outside do beyond r/D: feed back into the window, and couple among themselves. For choosing the
// number of harmonics only.
[[nodiscard]] double tail_slack(const Operator& A, double response);

// True if an undamped mode whose coupling cannot shift it is in resonance with a harmonic beyond H, to rounding.
[[nodiscard]] bool resonant_beyond(const WeightedSystem& system, Eigen::Index H);

}  // namespace hb::steady
