// What every search method shares: variables on [0, 1], each design analysed once and counted, the best so far, values
// and slopes as NLopt wants them.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hb/engine/design/design.hpp"

namespace hb {

struct OutOfEvaluations {};

// A variable on [0, 1]: logarithmic where its bounds are positive and a decade or more apart.
struct DesignScale {
  double lower, upper;
  bool logarithmic;

  double value(double u) const;
  double place(double x) const;
  double slope(double x) const;  // dx/du
};

[[nodiscard]] DesignScale design_scale(double lower, double upper);
// The largest excess over the conditions; 0 if all are met.
[[nodiscard]] double violation(const DesignValues& values);

class DesignSearch {
 public:
  DesignSearch(const DesignProblem& problem, const DesignOptions& options);

  std::size_t size() const { return scales_.size(); }
  std::size_t num_conditions() const { return static_cast<std::size_t>(problem_.num_conditions); }
  std::size_t num_parts() const { return static_cast<std::size_t>(problem_.num_parts); }
  int evaluations() const { return static_cast<int>(result_.trials.size()); }
  int left() const { return options_.stop && options_.stop() ? 0 : options_.max_evaluations - evaluations(); }
  bool feasible() const { return best_ && violation(best_->values) <= 0; }
  // Of the best design so far.
  double least_violation() const { return best_ ? violation(best_->values) : HUGE_VAL; }
  const DesignOptions& options() const { return options_; }
  std::vector<double> start() const { return place(problem_.start); }
  std::vector<double> best_place() const { return place(best_ ? best_->x : problem_.start); }

  // Throws OutOfEvaluations.
  const std::optional<DesignValues>& at(const std::vector<double>& u);

  // Goal over its scale at the first design; where there is no design, worse than all that were seen. Conditions are
  // held a little on the safe side.
  double goal(const std::vector<double>& u);
  double part(const std::vector<double>& u, std::size_t k);
  double condition(const std::vector<double>& u, std::size_t j);
  double largest_condition(const std::vector<double>& u);
  double penalised(const std::vector<double>& u);

  // d goal/du, d part_k/du and d condition_j/du: the problem's own gradient, else differences.
  void goal_slope(const std::vector<double>& u, std::vector<double>& slope);
  void part_slope(const std::vector<double>& u, std::size_t k, std::vector<double>& slope);
  void condition_slope(const std::vector<double>& u, std::size_t j, std::vector<double>& slope);

  // The best design satisfies the first-order conditions of a minimum.
  bool stationary();

  // What was run; the same again only adds its analyses.
  void say(const std::string& what, int analyses);
  DesignResult finish(bool converged);

 private:
  struct Best {
    Eigen::VectorXd x;
    DesignValues values;
  };
  void note(const Eigen::VectorXd& x, const DesignValues& values);
  Eigen::VectorXd design(const std::vector<double>& u) const;
  std::vector<double> place(const Eigen::VectorXd& x) const;
  const Eigen::MatrixXd& slopes(const std::vector<double>& u);
  void slope(const std::vector<double>& u, std::size_t row, std::vector<double>& slope);
  double scale() const { return scale_.value_or(1); }

  const DesignProblem& problem_;
  const DesignOptions& options_;
  std::vector<DesignScale> scales_;
  std::map<std::vector<double>, std::optional<DesignValues>> seen_;
  std::map<std::vector<double>, Eigen::MatrixXd> slopes_;  // rows: goal, conditions, parts; columns: u_i
  std::optional<double> scale_;
  int revisits_ = 0;
  bool differencing_ = false;  // what is evaluated is for slopes alone
  double worst_goal_, worst_violation_ = 0;
  std::optional<Best> best_;
  std::vector<std::pair<std::string, int>> said_;
  DesignResult result_;
};

}  // namespace hb
