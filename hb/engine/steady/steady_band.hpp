// Direct solution of the block Hill system of few modes and few harmonics of K: elimination in a band.
#pragma once

#include "hb/engine/steady/steady_elimination.hpp"
#include "lib/band_lu.hpp"

namespace hb::steady {

// Real unknowns [x_0, Re x_1, Im x_1, Re x_2, ...], I to each; row k holds
//     sum_l (A_{k-l} + K_{k+l}) Re x_l + i (A_{k-l} - K_{k+l}) Im x_l,      0 <= l <= H,
// zero for |k - l| > P: a band of 2 I (P + 1) - 1 diagonals to either side, pivoted among its rows.
class BandInverse : public EliminatedInverse {
 public:
  explicit BandInverse(Operator& A);
  // Where the band is narrower than the blocks that it would be cut into.
  static bool suits(const Operator& A);

 private:
  void substitute(const Spectrum& rhs, Spectrum& z) const override;

  dense::BandLu factors_;
  mutable Eigen::VectorXd unknowns_;
};

}  // namespace hb::steady
