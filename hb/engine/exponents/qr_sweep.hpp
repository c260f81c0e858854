// QR sweeps over the cells of a turn: the discrete QR method for Floquet exponents (L. Dieci, R. D. Russell, E. S. Van
// Vleck, SIAM J. Numer. Anal. 34 (1997) 402, doi:10.1137/S0036142993247311), turn after turn until the leading
// subspaces come back onto themselves.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace hb {

// Q_i R_i = Phi_i Q_(i-1), i = 1..N, and what turns the last frame back to the first.
struct QrSweep {
  Eigen::MatrixXd R;  // n x n N
  Eigen::MatrixXd turned;  // Q_0^T Q_N
  std::vector<Eigen::Index> ends;  // of the diagonal blocks: exclusive
  Eigen::MatrixXd frames;  // Q_0 .. Q_N side by side
};

// Over the turns Q_0 turns into the ordered invariant subspaces. `from`: Q_0 to start from, or empty: both states of
// one mode after the other. `cells`: Phi_1 .. Phi_N, n x n each, side by side.
[[nodiscard]] QrSweep qr_sweep(const Eigen::MatrixXd& cells, const Eigen::MatrixXd& from);

// Bases of the blocks' invariant subspaces over the turn: in the frame Q_i the columns of V_i, unit upper triangular by
// blocks, with R_i V_(i-1) = V_i diag(blocks of R_i). Columns of V and rows of V^-1 make oblique projectors.
struct SubspaceBases {
  Eigen::MatrixXd right;  // V_0 .. V_(N-1), n x n each, side by side
  Eigen::MatrixXd left;  // V_1^-1 .. V_N^-1
};
// To a tenth; empty where they do not settle.
[[nodiscard]] std::optional<SubspaceBases> subspace_bases(const QrSweep& sweep);

}  // namespace hb
