// Floquet exponents from the maps over the cells of a turn, by QR sweeps, never from the product itself: tiny and huge
// multipliers keep their digits.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "hb/engine/exponents/radau_turn.hpp"

namespace hb {

// Per radian of crank angle, real part descending; imaginary part in (-1/2, 1/2].
struct TurnExponents {
  std::vector<std::complex<double>> s;  // those above the rounding of the maps
  std::vector<double> error;  // effect on each of a relative change `cell_error` of every cell map, amplified by the
                              // turn's transient growth; defective pairs get the square root that they need
  double others_below = -HUGE_VAL;  // upper bound on Re s of the others
  Eigen::MatrixXd subspaces;  // orthogonal, 2m x 2m: leading columns span the leading invariant subspaces at tau = 0
};

// With `leading_only` the product is taken at once, without sweeps: exponents far below the leading one are lost.
// `subspaces` of nearly the same maps save sweeps.
[[nodiscard]] TurnExponents turn_exponents(const TurnMaps& maps, double cell_error, bool leading_only = false,
                                           const Eigen::MatrixXd& subspaces = {});

}  // namespace hb
