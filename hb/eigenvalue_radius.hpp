// How far the eigenvalues of an inexact matrix may be from the computed ones.
#pragma once

#include <Eigen/Core>
#include <complex>

namespace hb {

// A distance r from `mu` such that no matrix within `change` of M (2-norm) has an eigenvalue on the circle of radius r
// about mu, checked at eight points of it with a factor of two between them: such a matrix has as many eigenvalues
// inside as M. Defective ones get the root that they need. Infinite if none was found.
[[nodiscard]] double eigenvalue_radius(const Eigen::MatrixXd& M, std::complex<double> mu, double change);

}  // namespace hb
