// Products of small matrices over the cells of a turn, each known to an error.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "hb/engine/exponents/inexact_eigenvalues.hpp"

namespace hb {

// How errors of the cells add up, hb/engine/README.md (E14): rounding errors are independent from cell to cell for the
// most part, what is wrong with the coefficients is alike in all of them. tools/attack puts it to the test.
struct CellErrors {
  Eigen::Index joined = 1;  // cells per summand
  double variance = 0;  // sum of the variances of rounding errors, in units of the machine epsilon squared
  double deviation = 0;  // sum of their standard deviations
  double given = 0;  // sum of the effects of wrong coefficients

  void add(double rounding_variance, double coefficient) {
    variance += rounding_variance / double(joined);
    deviation += std::sqrt(rounding_variance);
    given += coefficient;
  }
  // `real`: of something without phase, so that what is alike in the cells does not turn and cancel.
  [[nodiscard]] double total(bool real) const;
};

// D_N .. D_1 = e^log_size M, |M| = 1.
struct SizedProduct {
  Eigen::MatrixXd M;
  double log_size = 0;
};
// Of p x p factors side by side, p = factors.rows().
[[nodiscard]] SizedProduct sized_product(const Eigen::MatrixXd& factors);

// M = closing D_N .. D_1.
struct CellChain {
  Eigen::MatrixXd factors;  // D_1 .. D_N, p x p each, side by side
  // Of the entries of D_i: squares of what the standard deviations of its cells add up to, in units of the machine
  // epsilon squared.
  Eigen::MatrixXd rounding;
  Eigen::MatrixXd given;  // bound on the effect of wrong coefficients on the entries of D_i
  Eigen::MatrixXd closing;
  Eigen::Index joined = 1;  // cells in each factor

  Eigen::Index size() const { return factors.rows(); }
  Eigen::Index num_cells() const { return factors.cols() / factors.rows(); }
};

// The same product of fewer factors (E26): up to four cells each while that loses nothing, where `damping` bounds what
// one damps. `rounding` and `given` may be empty.
[[nodiscard]] CellChain joined(CellChain chain, double damping);

// |M| = 1 but for its size, kept apart as a logarithm.
struct ChainProduct {
  Eigen::MatrixXd M;
  double log_size = 0;
  double change = 0;  // of M, sum_i |D_N .. D_(i+1)| |dD_i| |D_(i-1) .. D_1|
  // Of tr M, sum_i |tr D_N .. D_(i+1) dD_i D_(i-1) .. D_1|, where the eigenvalues are complex and where they are real.
  double trace_change = 0, real_trace_change = 0;
  double log_bound = 0;  // log of the product of |D_i| + |dD_i|
};
[[nodiscard]] ChainProduct product_of(const CellChain& chain);

// Eigenvalues of the product, over e^log_size, in frames that move with its eigenvectors (E13): growth inside the turn
// that is taken back before its end does not count as it does in norms of partial products. Those that are not known
// apart share a disc. Empty where eigenvectors are too close.
[[nodiscard]] std::optional<InexactEigenvalues> framed_eigenvalues(const CellChain& chain, const ChainProduct& product);

// Relative change of the eigenvalue mu of the product to first order,
//     sum_i |w_i dD_i v_(i-1)|/|w_i D_i v_(i-1)|,     v and w its right and left vectors,
// carried through the cells. No other eigenvalue lies within ten times `radius`.
[[nodiscard]] double first_order_change(const CellChain& chain, const ChainProduct& product, std::complex<double> mu,
                                        double radius);

}  // namespace hb
