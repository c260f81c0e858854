// Floquet exponents from the maps over the cells of a turn, by QR sweeps, never from the product itself: tiny and huge
// multipliers keep their digits. Derivation: hb/engine/README.md, "QR sweeps".
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "hb/engine/exponents/radau_turn.hpp"

namespace hb {

// Per radian of crank angle, real part descending; imaginary part in (-1/2, 1/2].
struct TurnExponents {
  std::vector<std::complex<double>> s;  // those above the rounding of the maps
  std::vector<double> error;  // estimate of what the errors of the cell maps do to each: to first order where it is
                              // simple, else discs that it shares; defective pairs get the square root that they need
  double others_below = -HUGE_VAL;  // upper bound on Re s of the others
  Eigen::MatrixXd subspaces;  // orthogonal, 2m x 2m: leading columns span the leading invariant subspaces at tau = 0
};

// Each cell map has the rounding errors of `maps`, and a change of up to `given` (2m x 2m, entry by entry) alike in all
// cells. With `leading_only` the product is taken at once, without sweeps: exponents far below the leading one are
// lost. `subspaces` of nearly the same maps save sweeps.
[[nodiscard]] TurnExponents turn_exponents(const TurnMaps& maps, const Eigen::MatrixXd& given,
                                           bool leading_only = false, const Eigen::MatrixXd& subspaces = {});

// The same without errors, to compare others with: each infinite, so is others_below.
[[nodiscard]] TurnExponents turn_values(const TurnMaps& maps, bool leading_only = false);

}  // namespace hb
