// Direct solution of the block Hill system: half-spectrum block elimination.
#pragma once

#include <vector>

#include "hb/engine/steady/steady_elimination.hpp"
#include "lib/dense.hpp"

namespace hb::steady {

// Unknowns of the real core and of the complex blocks that `DirectInverse` would factorise, and its work in flops.
struct DirectCost {
  Eigen::Index core = 0, block = 0, num_blocks = 0;
  double flops = 0, bytes = 0;
};

// Eliminates harmonics H..c+1 in complex blocks of p harmonics from the outermost inward, then harmonics 0..c as a
// real core, where conjugates couple (c >= P):
//     S_g = A_gg - A_{g,g+1} S_{g+1}^-1 A_{g+1,g},   pivoting inside S_g (at least 16 unknowns).
// Harmonics of K that rounding-size refinement can make up for are left out of the factors; every solve refines.
class DirectInverse : public EliminatedInverse {
 public:
  explicit DirectInverse(Operator& A);
  static DirectCost cost(const WeightedSystem& system, Eigen::Index num_harmonics);

 private:
  void substitute(const Spectrum& rhs, Spectrum& z) const override;
  Eigen::MatrixXcd block(Eigen::Index row, Eigen::Index column, Eigen::Index rows, Eigen::Index columns) const;

  Eigen::Index P_ = 0;  // harmonics of K in the factors
  Eigen::Index c_ = 0, p_ = 0;  // last harmonic of the core, harmonics per block
  std::vector<dense::Lu<std::complex<double>>> S_;  // outermost last
  std::vector<Eigen::MatrixXcd> up_;  // S_g^-1 A_{g,g-1}
  std::vector<Eigen::MatrixXcd> down_;  // A_{g-1,g}
  dense::Lu<double> core_;
};

}  // namespace hb::steady
