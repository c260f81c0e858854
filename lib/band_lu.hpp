// LU factors of a real band matrix with row pivoting.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace hb::dense {

// P A = L U of a square matrix with A_ij = 0 for |i - j| > half_width; U has twice as many diagonals above. Work:
// about 4 n half_width^2 flops.
class BandLu {
 public:
  BandLu(Eigen::Index n, Eigen::Index half_width);
  Eigen::Index size() const { return n_; }

  // Of A until factorised, |i - j| <= half_width.
  double& operator()(Eigen::Index i, Eigen::Index j) { return at(i, j); }
  void factorise();
  // The smallest |u_ii|; 0 where A is singular.
  double smallest_pivot() const { return smallest_pivot_; }
  // b <- A^-1 b.
  void solve_in_place(Eigen::VectorXd& b) const;

 private:
  // Row i holds columns i - half_width .. i + 2 half_width; factorised 1/u_ii on the diagonal.
  double& at(Eigen::Index i, Eigen::Index j) { return rows_[std::size_t(i * width_ + j - i + half_)]; }
  double at(Eigen::Index i, Eigen::Index j) const { return rows_[std::size_t(i * width_ + j - i + half_)]; }

  // `half` is the half width, known to the compiler where it is small.
  template <class Half>
  void substitute(Half half, double* x) const;

  Eigen::Index n_, half_, width_;
  std::vector<double> rows_;
  std::vector<Eigen::Index> pivot_;  // row exchanged with each
  double smallest_pivot_ = 0;
};

}  // namespace hb::dense
