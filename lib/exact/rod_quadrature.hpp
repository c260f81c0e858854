// Points along a rod at which the exact model's integrals are taken: Gauss-Legendre on (0, l), with the Ritz shapes
// and the integral from joint 0.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace hb {

struct RodQuadrature {
  double length = 0;  // l
  Eigen::VectorXd x, weight;  // Q points and weights
  // sin(i pi x/l) and its first two derivatives in x.
  struct Shape {
    double s = 0, s1 = 0, s2 = 0;
  };
  std::vector<Shape> shapes;  // I of each point, one point after the other
  // Q x Q: (integral g)_k is the integral from 0 to x_k of the polynomial through the values g at the points.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> integral;
  Eigen::MatrixXd weighted_integral;  // W integral, W = diag(weight)

  // 2I + 16 points: with slopes up to 0.3 the integrals of the exact model are then right to rounding.
  RodQuadrature(double l, Eigen::Index num_modes, Eigen::Index num_points = 0);

  Eigen::Index num_modes() const { return static_cast<Eigen::Index>(shapes.size()) / num_points(); }
  Eigen::Index num_points() const { return x.size(); }
  const Shape* shapes_at(Eigen::Index point) const { return shapes.data() + point * num_modes(); }
};

}  // namespace hb
