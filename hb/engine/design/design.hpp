// Design as constrained minimisation over a box,
//     minimise f(x)   subject to   g_j(x) <= 0,   lower <= x <= upper,   f one function or max_k f_k,
// for functions that cost a whole analysis, have kinks (worst cases) and do not exist everywhere (linkages that do not
// close). Any design found best is one that was computed: its conditions hold as computed, not to a tolerance.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hb {

struct DesignValues {
  double goal = 0;  // f
  Eigen::VectorXd conditions;  // g, of order 1 where far from being met
  Eigen::VectorXd parts = {};  // f_k; empty where f is one function
};

struct DesignGradient {
  Eigen::VectorXd goal;  // df/dx_i
  Eigen::MatrixXd conditions;  // dg_j/dx_i
  Eigen::MatrixXd parts = {};  // df_k/dx_i
};

struct DesignProblem {
  Eigen::VectorXd lower, upper, start;  // finite, lower < upper, start inside
  int num_conditions = 0, num_parts = 0;
  // Empty where there is no such design.
  std::function<std::optional<DesignValues>(const Eigen::VectorXd& x)> evaluate;
  // At a design that was evaluated. No function, or empty: differences of `evaluate` are taken instead.
  std::function<std::optional<DesignGradient>(const Eigen::VectorXd& x)> gradient;
};

enum class DesignAlgorithm {
  automatic,  // global search by DIRECT, then SLSQP, then COBYLA unless SLSQP ended at a minimum
  direct,  // global, deterministic: DIRECT-L on an exact penalty, then COBYLA
  mlsl,  // global, low-discrepancy starts, BOBYQA from each on an exact penalty, then COBYLA
  cobyla,  // local, linear models, no derivatives
  bobyqa,  // local, quadratic models, no derivatives; for two variables or more and no conditions
  slsqp,  // local, with derivatives
  mma,  // local, with derivatives
};

struct DesignOptions {
  DesignAlgorithm algorithm = DesignAlgorithm::automatic;
  double tolerance = 1e-5;  // of each variable, relative to its bounds' distance (on its scale)
  int max_evaluations = 600;  // analyses, those of differences included, gradients not
  std::uint64_t seed = 1;  // of mlsl
  std::function<bool()> stop = {};  // asked before each analysis: true ends the search as if no analysis were left
  bool only_local = false;  // from the start, without the global search of automatic, direct and mlsl
  std::function<void(int evaluations, bool feasible, double goal)> progress;  // best so far, after each analysis
};

enum class DesignStatus {
  optimal,  // a local minimum to the tolerance, the best of what was searched
  stopped,  // feasible, but the evaluations ran out first
  infeasible,  // no design found that meets all conditions; x is the one that violates them least
};

// One design computed on the way.
struct DesignTrial {
  Eigen::VectorXd x;
  std::optional<DesignValues> values;
  bool for_slopes = false;  // a neighbour that only a difference asked for
};

struct DesignResult {
  DesignStatus status = DesignStatus::infeasible;
  Eigen::VectorXd x;
  DesignValues values;
  std::vector<DesignTrial> trials;  // in their order
  int num_missing = 0;  // trials where there was no design
  int num_for_slopes = 0;  // trials that are DesignTrial::for_slopes
  int num_gradients = 0;  // that the problem gave
  std::string evidence;  // one sentence: what was done
  bool out_of_analyses = false;  // as many as allowed were done
};

// Throws std::invalid_argument naming a wrong field, and when no trial at all has values.
[[nodiscard]] DesignResult optimise(const DesignProblem& problem, const DesignOptions& options = {});

// What holds a design where it is: with the problem's gradient, else by central differences (one-sided at bounds),
//     sum_k mu_k df_k + sum_j lambda_j dg_j - sum_i below_i e_i + sum_i above_i e_i ~ 0,   sum_k mu_k = 1,
// in the least-squares sense, all multipliers >= 0, zero for what is not active. lambda_j is what the goal gains per
// unit by which condition j is relaxed.
struct DesignSensitivity {
  DesignGradient gradient;
  Eigen::VectorXd upward;  // df/dx_i towards larger x_i: of the active parts the largest
  Eigen::VectorXd weights;  // mu_k
  Eigen::VectorXd multipliers;  // lambda_j
  Eigen::VectorXd below, above;  // of the bounds
  double left_over = 0;  // length of the left side above, x scaled by the bounds' distance
  double residual = 0;  // the same over the largest |df_k|
};

// `active`: a condition within this of 0 counts as active, parts and bounds likewise relative to f and their distance.
// `step` relative to the bounds' distance. Empty where a neighbour has no values.
[[nodiscard]] std::optional<DesignSensitivity> design_sensitivity(const DesignProblem& problem,
                                                                  const Eigen::VectorXd& x, double active = 1e-3,
                                                                  double step = 1e-3);

// min |A x - b| over x >= 0 (Lawson and Hanson).
[[nodiscard]] Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

[[nodiscard]] const char* to_string(DesignAlgorithm algorithm);

}  // namespace hb
