// Propagation of x'' + beta(tau) x' + alpha(tau) x = 0 over one turn by Radau IIA collocation: stiffly accurate and
// R(infinity) = 0, so unresolved fast modes vanish instead of faking a multiplier of 1.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "lib/fourier/fourier.hpp"

namespace hb {

// Maps of the scaled state (W x, x') over consecutive cells of one turn, W = diag(scale).
struct TurnMaps {
  Eigen::Index num_cells = 0;  // N
  Eigen::MatrixXd cells;  // 2m x 2m N, one map beside the other
  Eigen::VectorXd scale;
  // hb/engine/README.md (E11): size of the terms that the entries of a cell's map are the sum of. Rounding errors are
  // about half of epsilon times that.
  Eigen::MatrixXd terms;
  double damping_trace = 0;  // mean over the turn of tr beta: minus the sum of all exponents (Liouville)
  double damping = HUGE_VAL;  // largest sum of a row of bounds on |h beta|

  Eigen::Index num_states() const { return cells.rows(); }
};

// A number of cells that both of them take, at least `least`; fixed numbers not far apart, whose tables are kept.
[[nodiscard]] Eigen::Index radau_cells(Eigen::Index least);

// s = 8 stages, order 15. alpha and beta have m*m components (column-major); num_cells is one of radau_cells.
[[nodiscard]] TurnMaps radau_turn(const FourierSeries& alpha, const FourierSeries& beta, Eigen::Index num_modes,
                                  Eigen::Index num_cells);
// The same with s = 4 stages, order 7, for a few digits: as many cells take a third of the time.
[[nodiscard]] TurnMaps rough_radau_turn(const FourierSeries& alpha, const FourierSeries& beta, Eigen::Index num_modes,
                                        Eigen::Index num_cells);

// One oscillator's phase and damping come out to so much of a turn (measured), and the cells for that.
[[nodiscard]] double oscillator_error(double frequency, double num_cells);
[[nodiscard]] double oscillator_cells(double frequency, double error);
// Cells of rough_radau_turn over which it damps an oscillator by no more than `error` per radian.
[[nodiscard]] double rough_oscillator_cells(double frequency, double error);

}  // namespace hb
