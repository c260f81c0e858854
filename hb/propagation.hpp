// Propagation of x'' + beta(tau) x' + alpha(tau) x = 0 over one turn by Radau IIA collocation (stiffly accurate,
// R(infinity) = 0: unresolved fast modes vanish instead of faking a multiplier of 1), and exponents from the product of
// cell maps by QR sweeps, never from the product itself: tiny and huge multipliers keep their digits.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <vector>

#include "lib/fourier.hpp"

namespace hb {

// Maps of the scaled state (W x, x') over consecutive cells of one turn; W = diag(scale).
struct TurnMaps {
  std::vector<Eigen::MatrixXd> cells;  // 2m x 2m
  Eigen::VectorXd scale;
  double damping_trace = 0;  // mean over the turn of tr beta: minus the sum of all exponents (Liouville)
};

// s = 8 stages, order 15. alpha and beta have m*m components (column-major).
[[nodiscard]] TurnMaps radau_turn(const FourierSeries& alpha, const FourierSeries& beta, Eigen::Index num_modes,
                                  Eigen::Index num_cells);

// Floquet exponents per radian of crank angle, real part descending; imaginary part in (-1/2, 1/2].
struct TurnExponents {
  std::vector<std::complex<double>> s;  // those above the rounding of the maps
  std::vector<double> error;  // effect on each of a relative change `cell_error` of every cell map, amplified by the
                              // turn's transient growth; defective pairs get the square root that they need
  double others_below = -HUGE_VAL;  // upper bound on Re s of the others
};
// With `leading_only` the product is taken at once, without sweeps: exponents far below the leading one are lost.
[[nodiscard]] TurnExponents turn_exponents(const TurnMaps& maps, double cell_error, bool leading_only = false);

}  // namespace hb
