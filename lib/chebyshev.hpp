// Interpolation on [-1, 1] by Chebyshev polynomials through the Lobatto nodes (Trefethen, Approximation Theory and
// Approximation Practice, 2013, chapters 2 and 3).
#pragma once

#include <Eigen/Core>

namespace hb {

// t_k = -cos(k pi/n), k = 0..n; 0 for n = 0. Kept per thread, as the next.
[[nodiscard]] const Eigen::VectorXd& lobatto_nodes(Eigen::Index n);

// T_0(t) .. T_n(t).
[[nodiscard]] Eigen::VectorXd chebyshev(double t, Eigen::Index n);

// (n+1) x (n+1): values at the nodes, a row vector, times this are the coefficients of T_0 .. T_n.
[[nodiscard]] const Eigen::MatrixXd& to_coefficients(Eigen::Index n);

// The same where all values are one: exactly that one.
[[nodiscard]] Eigen::MatrixXd first_value(Eigen::Index n);

}  // namespace hb
