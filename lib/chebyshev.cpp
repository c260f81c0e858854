#include "lib/chebyshev.hpp"

#include <cmath>
#include <map>
#include <numbers>

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

VectorXd computed_nodes(Index n) {
  VectorXd nodes(n + 1);
  for (Index k = 0; k <= n; ++k) nodes(k) = n == 0 ? 0 : std::sin(std::numbers::pi * double(2 * k - n) / double(2 * n));
  return nodes;
}

MatrixXd computed_coefficients(Index n) {
  if (n == 0) return MatrixXd::Ones(1, 1);
  // c_j = 2/n sum'' f(t_k) T_j(t_k), both ends of both sums halved.
  MatrixXd D(n + 1, n + 1);
  const VectorXd& nodes = lobatto_nodes(n);
  for (Index k = 0; k <= n; ++k) D.row(k) = chebyshev(nodes(k), n).transpose() * (2.0 / double(n));
  D.row(0) *= 0.5;
  D.row(n) *= 0.5;
  D.col(0) *= 0.5;
  D.col(n) *= 0.5;
  return D;
}

template <class Table>
const Table& kept(Index n, Table (*compute)(Index)) {
  thread_local std::map<Index, Table> tables;
  const auto found = tables.find(n);
  return found != tables.end() ? found->second : tables.emplace(n, compute(n)).first->second;
}

}  // namespace

const VectorXd& lobatto_nodes(Index n) { return kept(n, computed_nodes); }

const MatrixXd& to_coefficients(Index n) { return kept(n, computed_coefficients); }

VectorXd chebyshev(double t, Index n) {
  VectorXd T(n + 1);
  T(0) = 1;
  if (n > 0) T(1) = t;
  for (Index k = 2; k <= n; ++k) T(k) = 2 * t * T(k - 1) - T(k - 2);
  return T;
}

MatrixXd first_value(Index n) {
  MatrixXd D = MatrixXd::Zero(n + 1, n + 1);
  D(0, 0) = 1;
  return D;
}

}  // namespace hb
