// Points along a rod at which the exact model's integrals are taken: Gauss-Legendre on (0, l), with the Ritz shapes
// and the integral from joint 0 as matrices.
#pragma once

#include <Eigen/Core>

namespace hb {

struct RodQuadrature {
  double length = 0;  // l
  Eigen::VectorXd x, weight;  // Q points and weights
  Eigen::MatrixXd s, s1, s2;  // Q x I: sin(i pi x/l) and its first two derivatives in x
  // Q x Q: (integral g)_k is the integral from 0 to x_k of the polynomial through the values g at the points.
  Eigen::MatrixXd integral;
  Eigen::MatrixXd weighted_integral;  // W integral, W = diag(weight)

  // 2I + 16 points: with slopes up to 0.3 the integrals of the exact model are then right to rounding.
  RodQuadrature(double l, Eigen::Index num_modes, Eigen::Index num_points = 0);

  Eigen::Index num_modes() const { return s.cols(); }
  Eigen::Index num_points() const { return x.size(); }
};

}  // namespace hb
