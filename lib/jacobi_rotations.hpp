// Small symmetric matrices side by side, diagonalised by Jacobi's rotations: an operation serves several of them.
#pragma once

#include <Eigen/Core>

namespace hb {

// Where symmetric n x n matrices keep their entry (i, j) = (j, i): the column of an array with n (n + 1)/2 columns and
// a row for each matrix.
[[nodiscard]] inline Eigen::Index symmetric_entry(Eigen::Index n, Eigen::Index i, Eigen::Index j) {
  return i < j ? i * (2 * n - i - 1) / 2 + j : j * (2 * n - j - 1) / 2 + i;
}

// Of each row A becomes V^T A V, diagonal, its entries ascending, and B becomes V^T B V with the same V, V^T V = 1.
// What is left of A beside the diagonal, at most 1e-8 of the distance of the two eigenvalues, is set to zero:
// eigenvalues to rounding, V to 1e-8. False where eigenvalues are too near to each other for that.
[[nodiscard]] bool diagonalise_all(Eigen::Index n, Eigen::Ref<Eigen::ArrayXXd> A, Eigen::Ref<Eigen::ArrayXXd> B);

}  // namespace hb
