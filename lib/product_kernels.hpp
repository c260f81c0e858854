// Eigen's products of matrices of run-time size, instantiated once for the whole project: every file that multiplies
// would compile them anew, a tenth of its time. Read with the precompiled headers; without those nothing changes.
#pragma once

#include <Eigen/Core>
#include <complex>

// A B of one scalar type, A and B stored by columns (0) or by rows (1).
#define HB_MATRIX_PRODUCT(Scalar, A, B) \
  template struct Eigen::internal::general_matrix_matrix_product<Eigen::Index, Scalar, A, false, Scalar, B, false, 0, 1>
// A x with A of Left and x of Right, x of the other storage.
#define HB_VECTOR_PRODUCT(Left, A, Right, x)                                                               \
  template struct Eigen::internal::general_matrix_vector_product<                                          \
      Eigen::Index, Left, Eigen::internal::const_blas_data_mapper<Left, Eigen::Index, A>, A, false, Right, \
      Eigen::internal::const_blas_data_mapper<Right, Eigen::Index, x>, false, 0>
// The sizes of the blocks that a product is taken in.
#define HB_BLOCKING(Left, Right)                                                                      \
  template void Eigen::internal::evaluateProductBlockingSizesHeuristic<Left, Right, 1, Eigen::Index>( \
      Eigen::Index&, Eigen::Index&, Eigen::Index&, Eigen::Index)
#define HB_PRODUCTS(prefix, Scalar)               \
  prefix HB_MATRIX_PRODUCT(Scalar, 0, 0);         \
  prefix HB_MATRIX_PRODUCT(Scalar, 0, 1);         \
  prefix HB_MATRIX_PRODUCT(Scalar, 1, 0);         \
  prefix HB_MATRIX_PRODUCT(Scalar, 1, 1);         \
  prefix HB_VECTOR_PRODUCT(Scalar, 0, Scalar, 1); \
  prefix HB_VECTOR_PRODUCT(Scalar, 1, Scalar, 0); \
  prefix HB_BLOCKING(Scalar, Scalar)
#define HB_MIXED_PRODUCTS(prefix, Real, Complex) \
  prefix HB_VECTOR_PRODUCT(Complex, 1, Real, 0); \
  prefix HB_VECTOR_PRODUCT(Real, 1, Complex, 0); \
  prefix HB_BLOCKING(Complex, Real);             \
  prefix HB_BLOCKING(Real, Complex)

HB_PRODUCTS(extern, double);
HB_PRODUCTS(extern, std::complex<double>);
HB_MIXED_PRODUCTS(extern, double, std::complex<double>);
