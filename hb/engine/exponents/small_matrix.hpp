// Products and QR factors of the small square matrices that are propagated over the cells of a turn: plain loops whose
// length the compiler knows for n = 1..10; any n works.
#pragma once

#include <Eigen/Core>

namespace hb {

// C = A B; n x n, columns contiguous. C is none of A, B.
void multiply(Eigen::Index n, const double* A, const double* B, double* C);
void multiply(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::MatrixXd& C);
// The same with A the n columns from `first` of n x n matrices side by side.
void multiply_columns(const Eigen::MatrixXd& matrices, Eigen::Index first, const Eigen::MatrixXd& B,
                      Eigen::MatrixXd& C);

// A = Q R by Householder reflections; A is overwritten by R.
void orthogonalise(Eigen::MatrixXd& A, Eigen::MatrixXd& Q);

}  // namespace hb
