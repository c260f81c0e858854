#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "hb/design.hpp"
#include "hb/differences.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd nonnegative_least_squares(const MatrixXd& A, const VectorXd& b) {
  const Index n = A.cols();
  VectorXd x = VectorXd::Zero(n);
  std::vector<bool> free(static_cast<std::size_t>(n), false);
  const double floor = 1e-12 * (A.transpose() * b).cwiseAbs().maxCoeff();
  const auto solved = [&] {
    std::vector<Index> columns;
    for (Index j = 0; j < n; ++j)
      if (free[static_cast<std::size_t>(j)]) columns.push_back(j);
    VectorXd z = VectorXd::Zero(n);
    if (columns.empty()) return z;
    const MatrixXd part = A(Eigen::all, columns);
    const VectorXd values = part.completeOrthogonalDecomposition().solve(b);
    for (std::size_t k = 0; k < columns.size(); ++k) z(columns[k]) = values(static_cast<Index>(k));
    return z;
  };
  for (Index round = 0; round < 3 * n + 3; ++round) {
    const VectorXd slope = A.transpose() * (b - A * x);
    Index enters = -1;
    for (Index j = 0; j < n; ++j)
      if (!free[static_cast<std::size_t>(j)] && slope(j) > floor && (enters < 0 || slope(j) > slope(enters)))
        enters = j;
    if (enters < 0) break;
    free[static_cast<std::size_t>(enters)] = true;
    VectorXd z = solved();
    while (z.minCoeff() < 0) {
      double t = 1;
      for (Index j = 0; j < n; ++j)
        if (z(j) < 0) t = std::min(t, x(j) / (x(j) - z(j)));
      x += t * (z - x);
      for (Index j = 0; j < n; ++j) {
        if (free[static_cast<std::size_t>(j)] && z(j) < 0 && x(j) <= 1e-14 * x.cwiseAbs().maxCoeff()) {
          free[static_cast<std::size_t>(j)] = false;
          x(j) = 0;
        }
      }
      z = solved();
    }
    x = z;
  }
  return x;
}

std::optional<DesignSensitivity> design_sensitivity(const DesignProblem& problem, const VectorXd& x, double active,
                                                    double step) {
  const Index n = x.size(), m = problem.num_conditions;
  const auto at = [&](const VectorXd& y) -> OptionalVector {
    const std::optional<DesignValues> values = problem.evaluate(y);
    if (!values) return std::nullopt;
    VectorXd all(m + 1);
    all << values->goal, values->conditions;
    return all;
  };
  const OptionalVector here = at(x);
  if (!here || !here->allFinite()) return std::nullopt;
  const VectorXd width = problem.upper - problem.lower;
  MatrixXd slopes(m + 1, n);  // rows f, g; columns x_i
  std::optional<DesignGradient> gradient;
  if (problem.gradient) gradient = problem.gradient(x);
  if (gradient) {
    slopes << gradient->goal.transpose(), gradient->conditions;
  } else {
    const std::optional<MatrixXd> differences = difference_jacobian(at, x, problem.lower, problem.upper, step * width);
    if (!differences) return std::nullopt;
    slopes = *differences;
  }
  DesignSensitivity result;
  result.gradient = {slopes.row(0).transpose(), slopes.bottomRows(m)};
  slopes *= width.asDiagonal();  // x over the bounds' distance
  result.multipliers = VectorXd::Zero(m);
  result.below = result.above = VectorXd::Zero(n);
  // Columns of the least-squares problem: active conditions, then active bounds.
  std::vector<VectorXd> columns;
  std::vector<double*> places;
  std::vector<double> units;
  for (Index j = 0; j < m; ++j) {
    if (!(std::abs((*here)(j + 1)) <= active)) continue;
    columns.push_back(slopes.row(j + 1).transpose());
    places.push_back(&result.multipliers(j));
    units.push_back(1);
  }
  for (Index i = 0; i < n; ++i) {
    const double tolerance = active * width(i);
    if (x(i) - problem.lower(i) <= tolerance) {
      columns.push_back(-VectorXd::Unit(n, i));
      places.push_back(&result.below(i));
      units.push_back(1 / width(i));
    }
    if (problem.upper(i) - x(i) <= tolerance) {
      columns.push_back(VectorXd::Unit(n, i));
      places.push_back(&result.above(i));
      units.push_back(1 / width(i));
    }
  }
  const VectorXd df = slopes.row(0).transpose();
  VectorXd rest = df;
  if (!columns.empty()) {
    MatrixXd A(n, static_cast<Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) A.col(static_cast<Index>(k)) = columns[k];
    const VectorXd lambda = nonnegative_least_squares(A, -df);
    for (std::size_t k = 0; k < columns.size(); ++k) *places[k] = lambda(static_cast<Index>(k)) * units[k];
    rest += A * lambda;
  }
  result.residual = df.norm() > 0 ? rest.norm() / df.norm() : 0;
  return result;
}

}  // namespace hb
