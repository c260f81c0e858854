// Products and QR factors of the small square matrices that are propagated over the cells of a turn: plain loops whose
// length the compiler knows for n = 1..10; any n works.
#pragma once

#include <Eigen/Core>
#include <type_traits>
#include <utility>

namespace hb {

// f(n) with n known to the compiler where it is one of 1..10.
template <class Function, int... sizes>
void with_size(Eigen::Index n, const Function& f, std::integer_sequence<int, sizes...>) {
  if (!((n == sizes + 1 && (f(std::integral_constant<Eigen::Index, sizes + 1>()), true)) || ...)) f(n);
}
template <class Function>
void with_size(Eigen::Index n, const Function& f) {
  with_size(n, f, std::make_integer_sequence<int, 10>());
}

// C = A B; n x n, columns contiguous. C is none of A, B.
void multiply(Eigen::Index n, const double* A, const double* B, double* C);
void multiply(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::MatrixXd& C);
// The same with A the n columns from `first` of n x n matrices side by side.
void multiply_columns(const Eigen::MatrixXd& matrices, Eigen::Index first, const Eigen::MatrixXd& B,
                      Eigen::MatrixXd& C);

// A = Q R by Householder reflections; A is overwritten by R.
void orthogonalise(Eigen::MatrixXd& A, Eigen::MatrixXd& Q);

}  // namespace hb
