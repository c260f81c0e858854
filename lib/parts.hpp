// Complex numbers as the real ones that stand in memory: what is real multiplies them several at a time.
#pragma once

#include <Eigen/Core>
#include <cassert>
#include <cmath>

namespace hb {

// Real and imaginary parts in turn, two rows for each of z.
inline Eigen::Map<Eigen::ArrayXXd> parts(Eigen::MatrixXcd& z) {
  return {reinterpret_cast<double*>(z.data()), 2 * z.rows(), z.cols()};
}
inline Eigen::Map<const Eigen::ArrayXXd> parts(const Eigen::MatrixXcd& z) {
  return {reinterpret_cast<const double*>(z.data()), 2 * z.rows(), z.cols()};
}

// Row i of z times the real factor i.
inline Eigen::MatrixXcd with_rows_times(const Eigen::MatrixXd& factors, const Eigen::MatrixXcd& z) {
  assert(factors.size() == z.rows());
  Eigen::ArrayXd of_parts(2 * z.rows());
  for (Eigen::Index i = 0; i < z.rows(); ++i) of_parts.segment<2>(2 * i).setConstant(factors(i));
  Eigen::MatrixXcd products(z.rows(), z.cols());
  for (Eigen::Index k = 0; k < z.cols(); ++k) parts(products).col(k) = of_parts * parts(z).col(k);
  return products;
}

// sum over `count` columns from the first of |z_ij| by squares (lib/modulus.hpp), for each row.
inline Eigen::VectorXd sums_of_moduli(const Eigen::MatrixXcd& z, Eigen::Index first, Eigen::Index count) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(z.rows());
  double* const sum = sums.data();
  for (Eigen::Index j = first; j < first + count; ++j) {
    const double* const of = parts(z).col(j).data();
    for (Eigen::Index i = 0; i < z.rows(); ++i)
      sum[i] += std::sqrt(of[2 * i] * of[2 * i] + of[2 * i + 1] * of[2 * i + 1]);
  }
  return sums;
}

}  // namespace hb
