#include "hb/engine/design/design_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hb/engine/design/differences.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Penalty per unit of violation, in units of the goal's scale: large enough for conditions scaled to order 1
// (a choice; the local methods that follow do not depend on it).
constexpr double penalty_weight = 30;
// Conditions are held this far on the safe side while searching, so that rounding does not decide feasibility.
constexpr double safety = 1e-7;
// Half the distance of central differences on [0, 1]: their error, step^2, beside the functions' own noise over the
// step.
constexpr double difference_step = 1e-4;
// Residual of the first-order conditions at which the best design counts as a minimum (a choice: no direction is left
// in which the goal falls by more than this part of its steepest slope).
constexpr double stationary_residual = 1e-3;
// Known designs asked for in a row.
constexpr int most_revisits = 2000;

bool usable(const std::optional<DesignValues>& values) {
  return values && std::isfinite(values->goal) && values->conditions.allFinite() && values->parts.allFinite();
}

// What is evaluated while this is there counts as for slopes alone, however it ends.
class Differencing {
 public:
  explicit Differencing(bool& flag) : flag_(flag) { flag_ = true; }
  ~Differencing() { flag_ = false; }
  Differencing(const Differencing&) = delete;
  Differencing& operator=(const Differencing&) = delete;

 private:
  bool& flag_;
};

// Feasible before infeasible, then the lower goal; among infeasible the smaller violation.
bool better(const DesignValues& a, const DesignValues& b) {
  const double va = violation(a), vb = violation(b);
  if (va <= 0 && vb <= 0) return a.goal < b.goal;
  return va < vb;
}

}  // namespace

double DesignScale::value(double u) const {
  if (u <= 0) return lower;
  if (u >= 1) return upper;
  const double x = logarithmic ? lower * std::pow(upper / lower, u) : lower + u * (upper - lower);
  return std::clamp(x, lower, upper);
}

double DesignScale::place(double x) const {
  const double u = logarithmic ? std::log(x / lower) / std::log(upper / lower) : (x - lower) / (upper - lower);
  return std::clamp(u, 0.0, 1.0);
}

double DesignScale::slope(double x) const { return logarithmic ? x * std::log(upper / lower) : upper - lower; }

DesignScale design_scale(double lower, double upper) { return {lower, upper, lower > 0 && upper / lower >= 10}; }

double violation(const DesignValues& values) {
  return values.conditions.size() == 0 ? 0 : std::max(0.0, values.conditions.maxCoeff());
}

DesignSearch::DesignSearch(const DesignProblem& problem, const DesignOptions& options)
    : problem_(problem), options_(options), worst_goal_(-std::numeric_limits<double>::max() / 4) {
  for (Index i = 0; i < problem.lower.size(); ++i) scales_.push_back(design_scale(problem.lower(i), problem.upper(i)));
}

VectorXd DesignSearch::design(const std::vector<double>& u) const {
  VectorXd x(static_cast<Index>(u.size()));
  for (std::size_t i = 0; i < u.size(); ++i) x(static_cast<Index>(i)) = scales_[i].value(u[i]);
  return x;
}

std::vector<double> DesignSearch::place(const VectorXd& x) const {
  std::vector<double> u;
  for (std::size_t i = 0; i < scales_.size(); ++i) u.push_back(scales_[i].place(x(static_cast<Index>(i))));
  return u;
}

const std::optional<DesignValues>& DesignSearch::at(const std::vector<double>& u) {
  const auto known = seen_.find(u);
  if (known != seen_.end()) {
    // An algorithm that comes back to known designs only is not getting anywhere.
    if (++revisits_ > most_revisits) throw OutOfEvaluations();
    return known->second;
  }
  revisits_ = 0;
  if (left() <= 0) throw OutOfEvaluations();
  const VectorXd x = design(u);
  std::optional<DesignValues> found = problem_.evaluate(x);
  if (found && found->conditions.size() != problem_.num_conditions)
    throw std::invalid_argument(
        fmt::format("evaluate: found {} conditions, allowed {}", found->conditions.size(), problem_.num_conditions));
  if (found && found->parts.size() != problem_.num_parts)
    throw std::invalid_argument(
        fmt::format("evaluate: found {} parts of the goal, allowed {}", found->parts.size(), problem_.num_parts));
  if (!usable(found)) {
    found.reset();
    ++result_.num_missing;
  } else {
    note(x, *found);
  }
  result_.trials.push_back({x, found, differencing_});
  result_.num_for_slopes += differencing_;
  if (options_.progress && best_) options_.progress(evaluations(), feasible(), best_->values.goal);
  return seen_.emplace(u, std::move(found)).first->second;
}

void DesignSearch::note(const VectorXd& x, const DesignValues& values) {
  if (!scale_) scale_ = std::max(std::abs(values.goal), std::numeric_limits<double>::min());
  worst_goal_ = std::max(worst_goal_, values.goal);
  worst_violation_ = std::max(worst_violation_, violation(values));
  if (!best_ || better(values, best_->values)) best_ = Best{x, values};
}

double DesignSearch::goal(const std::vector<double>& u) {
  const std::optional<DesignValues>& values = at(u);
  return values ? values->goal / scale() : worst_goal_ / scale() + 1;
}

double DesignSearch::part(const std::vector<double>& u, std::size_t k) {
  const std::optional<DesignValues>& values = at(u);
  return values ? values->parts(static_cast<Index>(k)) / scale() : worst_goal_ / scale() + 1;
}

double DesignSearch::condition(const std::vector<double>& u, std::size_t j) {
  const std::optional<DesignValues>& values = at(u);
  return (values ? values->conditions(static_cast<Index>(j)) : worst_violation_ + 1) + safety;
}

double DesignSearch::largest_condition(const std::vector<double>& u) {
  double largest = -HUGE_VAL;
  for (std::size_t j = 0; j < num_conditions(); ++j) largest = std::max(largest, condition(u, j));
  return largest;
}

double DesignSearch::penalised(const std::vector<double>& u) {
  double sum = goal(u);
  for (std::size_t j = 0; j < num_conditions(); ++j) sum += penalty_weight * std::max(0.0, condition(u, j));
  return sum;
}

const MatrixXd& DesignSearch::slopes(const std::vector<double>& u) {
  const auto known = slopes_.find(u);
  if (known != slopes_.end()) return known->second;
  const auto n = static_cast<Index>(size()), m = static_cast<Index>(num_conditions()),
             p = static_cast<Index>(num_parts());
  MatrixXd result(1 + m + p, n);
  std::optional<DesignGradient> gradient;
  if (problem_.gradient && at(u)) gradient = problem_.gradient(design(u));
  if (gradient && gradient->goal.allFinite() && gradient->conditions.allFinite() && gradient->parts.allFinite()) {
    ++result_.num_gradients;
    result.row(0) = gradient->goal.transpose() / scale();
    result.middleRows(1, m) = gradient->conditions;
    if (p > 0) result.bottomRows(p) = gradient->parts / scale();
    const VectorXd x = design(u);
    for (Index i = 0; i < n; ++i) result.col(i) *= scales_[static_cast<std::size_t>(i)].slope(x(i));
  } else {
    const auto values = [&](const VectorXd& v) -> OptionalVector {
      const std::vector<double> place(v.data(), v.data() + n);
      VectorXd all(1 + m + p);
      all(0) = goal(place);
      for (Index j = 0; j < m; ++j) all(1 + j) = condition(place, static_cast<std::size_t>(j));
      for (Index k = 0; k < p; ++k) all(1 + m + k) = part(place, static_cast<std::size_t>(k));
      return all;
    };
    const Differencing differencing(differencing_);
    result = *difference_jacobian(values, Eigen::Map<const VectorXd>(u.data(), n), VectorXd::Zero(n), VectorXd::Ones(n),
                                  VectorXd::Constant(n, difference_step));
  }
  return slopes_.emplace(u, std::move(result)).first->second;
}

void DesignSearch::slope(const std::vector<double>& u, std::size_t row, std::vector<double>& slope) {
  const MatrixXd& all = slopes(u);
  for (std::size_t i = 0; i < size(); ++i) slope[i] = all(static_cast<Index>(row), static_cast<Index>(i));
}

void DesignSearch::goal_slope(const std::vector<double>& u, std::vector<double>& slope) { this->slope(u, 0, slope); }

void DesignSearch::part_slope(const std::vector<double>& u, std::size_t k, std::vector<double>& slope) {
  this->slope(u, 1 + num_conditions() + k, slope);
}

void DesignSearch::condition_slope(const std::vector<double>& u, std::size_t j, std::vector<double>& slope) {
  this->slope(u, 1 + j, slope);
}

bool DesignSearch::stationary() {
  if (!feasible() || !problem_.gradient) return false;
  const std::optional<DesignSensitivity> sensitivity = design_sensitivity(problem_, best_->x);
  return sensitivity && sensitivity->residual <= stationary_residual;
}

void DesignSearch::say(const std::string& what, int analyses) {
  if (said_.empty() || said_.back().first != what) said_.emplace_back(what, 0);
  said_.back().second += analyses;
}

DesignResult DesignSearch::finish(bool converged) {
  if (!best_)
    throw std::invalid_argument(fmt::format("evaluate: none of the {} designs tried exists", result_.trials.size()));
  result_.x = best_->x;
  result_.values = best_->values;
  result_.status = !feasible() ? DesignStatus::infeasible : converged ? DesignStatus::optimal : DesignStatus::stopped;
  result_.evidence = "the start";
  for (const auto& [what, analyses] : said_)
    result_.evidence += fmt::format(", then {} ({} {})", what, analyses, analyses == 1 ? "analysis" : "analyses");
  result_.out_of_analyses = left() <= 0;
  if (result_.out_of_analyses) result_.evidence += ", stopped by the number of analyses";
  return std::move(result_);
}

}  // namespace hb
