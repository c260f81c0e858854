#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "hb/engine/design/design.hpp"
#include "hb/engine/design/differences.hpp"
#include "lib/dense.hpp"

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
    const VectorXd values = dense::least_squares(part, b);
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

namespace {

using Values = std::function<OptionalVector(const VectorXd&)>;  // goal, conditions and parts

// Their slopes, rows f, g, f_k; columns x_i.
std::optional<MatrixXd> slopes_at(const DesignProblem& problem, const Values& at, const VectorXd& x, double step) {
  std::optional<DesignGradient> gradient;
  if (problem.gradient) gradient = problem.gradient(x);
  if (!gradient)
    return difference_jacobian(at, x, problem.lower, problem.upper, step * (problem.upper - problem.lower));
  const Index m = problem.num_conditions, p = problem.num_parts;
  MatrixXd slopes(1 + m + p, x.size());
  slopes.row(0) = gradient->goal.transpose();
  slopes.middleRows(1, m) = gradient->conditions;
  if (p > 0) slopes.bottomRows(p) = gradient->parts;
  return slopes;
}

// Columns of the least-squares problem of the multipliers.
struct Balance {
  std::vector<VectorXd> columns;
  std::vector<double*> places;  // where each multiplier belongs
  std::vector<double> units;
  double steepest = 0;  // of the parts of the goal, which come first

  void add(VectorXd column, double& place, double unit) {
    columns.push_back(std::move(column));
    places.push_back(&place);
    units.push_back(unit);
  }
};

// Weights of the parts and multipliers of conditions and bounds, with which the slopes balance best.
void balance_slopes(Balance& balance, std::size_t num_parts, DesignSensitivity& result) {
  auto& [columns, places, units, steepest] = balance;
  const Index n = columns.front().size();
  if (!(steepest > 0)) {
    for (std::size_t k = 0; k < num_parts; ++k) *places[k] = 1.0 / static_cast<double>(num_parts);
    return;
  }
  // Conditions and bounds as steep as the parts: nothing depends on their units.
  for (std::size_t k = num_parts; k < columns.size(); ++k) {
    const double norm = columns[k].norm();
    if (!(norm > 0)) continue;
    columns[k] *= steepest / norm;
    units[k] *= steepest / norm;
  }
  // |D z|^2 is least with sum mu_k = 1 in the direction in which |D z|^2 + c^2 (sum mu_k - 1)^2 is, whatever c: with
  // z = s z1 the latter is c^2 r^2/(c^2 + r^2) at the best s, which grows with r = |D z1|.
  MatrixXd A = MatrixXd::Zero(n + 1, static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    A.col(static_cast<Index>(k)).head(n) = columns[k];
    if (k < num_parts) A(n, static_cast<Index>(k)) = steepest;
  }
  VectorXd multipliers = nonnegative_least_squares(A, steepest * VectorXd::Unit(n + 1, n));
  multipliers /= multipliers.head(static_cast<Index>(num_parts)).sum();
  for (std::size_t k = 0; k < columns.size(); ++k) *places[k] = multipliers(static_cast<Index>(k)) * units[k];
  result.left_over = (A * multipliers).head(n).norm();
  result.residual = result.left_over / steepest;
}

}  // namespace

std::optional<DesignSensitivity> design_sensitivity(const DesignProblem& problem, const VectorXd& x, double active,
                                                    double step) {
  const Index n = x.size(), m = problem.num_conditions, p = problem.num_parts;
  const auto at = [&](const VectorXd& y) -> OptionalVector {
    const std::optional<DesignValues> values = problem.evaluate(y);
    if (!values) return std::nullopt;
    VectorXd all(1 + m + p);
    all << values->goal, values->conditions, values->parts;
    return all;
  };
  const OptionalVector here = at(x);
  if (!here || !here->allFinite()) return std::nullopt;
  const VectorXd width = problem.upper - problem.lower;
  const std::optional<MatrixXd> found = slopes_at(problem, at, x, step);
  if (!found) return std::nullopt;
  MatrixXd slopes = *found;
  DesignSensitivity result;
  result.gradient = {slopes.row(0).transpose(), slopes.middleRows(1, m), slopes.bottomRows(p)};
  result.upward = result.gradient.goal;
  result.weights = VectorXd::Zero(p);
  const double goal = (*here)(0);
  std::vector<Index> parts;  // active ones, as rows of the slopes
  for (Index k = 1 + m; k < 1 + m + p; ++k) {
    if (!(goal - (*here)(k) <= active * std::abs(goal))) continue;
    parts.push_back(k);
    result.upward = result.upward.cwiseMax(slopes.row(k).transpose());
  }
  slopes *= width.asDiagonal();  // x over the bounds' distance
  result.multipliers = VectorXd::Zero(m);
  result.below = result.above = VectorXd::Zero(n);
  // Active parts of the goal, conditions and bounds. One smooth goal is a part whose weight is 1.
  if (parts.empty()) parts.push_back(0);
  Balance balance;
  double one = 0;
  for (const Index k : parts) {
    balance.add(slopes.row(k).transpose(), k == 0 ? one : result.weights(k - 1 - m), 1);
    balance.steepest = std::max(balance.steepest, balance.columns.back().norm());
  }
  for (Index j = 0; j < m; ++j)
    if (std::abs((*here)(j + 1)) <= active) balance.add(slopes.row(j + 1).transpose(), result.multipliers(j), 1);
  for (Index i = 0; i < n; ++i) {
    const double tolerance = active * width(i);
    if (x(i) - problem.lower(i) <= tolerance) balance.add(-VectorXd::Unit(n, i), result.below(i), 1 / width(i));
    if (problem.upper(i) - x(i) <= tolerance) balance.add(VectorXd::Unit(n, i), result.above(i), 1 / width(i));
  }
  balance_slopes(balance, parts.size(), result);
  return result;
}

}  // namespace hb
