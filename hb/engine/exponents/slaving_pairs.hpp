// What a pair of a fast and a slow mode feels of itself in the invariance equations of slaving, with the first
// harmonics of what modulates it, and the inverse of that; hb/engine/README.md (E27).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace hb::slaving {

class PairInverse {
 public:
  static constexpr Eigen::Index band = 2;  // harmonics of K_jj and alpha that count

  // Harmonics 0 .. H, H >= band, of so many pairs. One per thread at a time: its numbers are in memory that the thread
  // keeps.
  PairInverse(Eigen::Index num_pairs, Eigen::Index H);

  // Of each pair harmonics 0 .. band of K_jj and of alpha, real parts, then imaginary ones, as rows; G_jj and the mean
  // of beta.
  struct Equations {
    Eigen::MatrixXd fast, slow;  // pairs x 2 (band + 1)
    Eigen::VectorXd fast_damping, slow_damping;
  };
  void factorise(const Equations& of);

  // Of harmonic k of pair q r1 at stride k + q, r2 at stride k + pairs + q.
  struct Residuals {
    const double *re, *im;
    Eigen::Index stride;
  };
  // What takes the residuals away: of harmonic k real parts of A, of weight C, then imaginary parts, a number per pair
  // each.
  void solve(const Residuals& of, const double* weight, double* step) const;

 private:
  static constexpr Eigen::Index central = 4 * band - 2;  // real unknowns of harmonics 0 .. band - 1

  double* block(Eigen::Index first, Eigen::Index width, Eigen::Index k, Eigen::Index away) const;
  template <int width>
  void factorise(const Equations& of, Eigen::Index first);
  template <int width>
  void solve(const Residuals& of, const double* weight, double* step, Eigen::Index first) const;

  Eigen::Index pairs_, H_;
  double* blocks_;  // of all groups of pairs after each other
  std::vector<double> central_;  // inverses of what is left of harmonics 0 .. band - 1
};

}  // namespace hb::slaving
