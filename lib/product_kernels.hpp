// Eigen's products of matrices of run-time size, instantiated once for the whole project: every file that multiplies
// would compile them anew, a tenth of its time. Read with the precompiled headers; without those nothing changes.
#pragma once

#include <Eigen/Core>
#include <complex>

// A B of one scalar type, A and B stored by columns (0) or by rows (1).
#define HB_MATRIX_PRODUCT(Scalar, A, B) \
  template struct Eigen::internal::general_matrix_matrix_product<Eigen::Index, Scalar, A, false, Scalar, B, false, 0, 1>
// A x, x of the other storage.
#define HB_VECTOR_PRODUCT(Scalar, A, x)                                                                         \
  template struct Eigen::internal::general_matrix_vector_product<                                               \
      Eigen::Index, Scalar, Eigen::internal::const_blas_data_mapper<Scalar, Eigen::Index, A>, A, false, Scalar, \
      Eigen::internal::const_blas_data_mapper<Scalar, Eigen::Index, x>, false, 0>
#define HB_PRODUCTS(prefix, Scalar)       \
  prefix HB_MATRIX_PRODUCT(Scalar, 0, 0); \
  prefix HB_MATRIX_PRODUCT(Scalar, 0, 1); \
  prefix HB_MATRIX_PRODUCT(Scalar, 1, 0); \
  prefix HB_MATRIX_PRODUCT(Scalar, 1, 1); \
  prefix HB_VECTOR_PRODUCT(Scalar, 0, 1); \
  prefix HB_VECTOR_PRODUCT(Scalar, 1, 0)

HB_PRODUCTS(extern, double);
HB_PRODUCTS(extern, std::complex<double>);
