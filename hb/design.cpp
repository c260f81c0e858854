#include "hb/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <nlopt.hpp>
#include <stdexcept>

namespace hb {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Penalty per unit of violation, in units of the goal's scale: large enough for conditions scaled to order 1
// (a choice; the local methods that follow do not depend on it).
constexpr double penalty_weight = 30;
// Conditions are held this far on the safe side while searching, so that rounding does not decide feasibility.
constexpr double safety = 1e-7;
// Half the distance of central differences, relative to the variable's scale: their error, step^2, beside the
// functions' own noise over the step.
constexpr double difference_step = 1e-4;

struct OutOfEvaluations {};

// A variable on [0, 1]: logarithmic where its bounds are positive and a decade or more apart.
struct Scale {
  double lower, upper;
  bool logarithmic;

  double value(double u) const {
    if (u <= 0) return lower;
    if (u >= 1) return upper;
    const double x = logarithmic ? lower * std::pow(upper / lower, u) : lower + u * (upper - lower);
    return std::clamp(x, lower, upper);
  }
  double place(double x) const {
    const double u = logarithmic ? std::log(x / lower) / std::log(upper / lower) : (x - lower) / (upper - lower);
    return std::clamp(u, 0.0, 1.0);
  }
};

double violation(const DesignValues& values) {
  return values.conditions.size() == 0 ? 0 : std::max(0.0, values.conditions.maxCoeff());
}

bool usable(const std::optional<DesignValues>& values) {
  return values && std::isfinite(values->goal) && values->conditions.allFinite();
}

class Search {
 public:
  Search(const DesignProblem& problem, const DesignOptions& options) : problem_(problem), options_(options) {
    for (Index i = 0; i < problem.lower.size(); ++i) {
      const double a = problem.lower(i), b = problem.upper(i);
      scales_.push_back({a, b, a > 0 && b / a >= 10});
    }
  }

  std::size_t size() const { return scales_.size(); }
  std::size_t num_conditions() const { return static_cast<std::size_t>(problem_.num_conditions); }
  int left() const { return options_.max_evaluations - static_cast<int>(result_.trials.size()); }
  bool feasible() const { return best_ && violation(best_->values) <= 0; }
  bool any() const { return best_.has_value(); }

  std::vector<double> start() const { return place(problem_.start); }
  std::vector<double> best_place() const { return place(best_ ? best_->x : problem_.start); }

  // Each design is analysed once.
  const std::optional<DesignValues>& at(const std::vector<double>& u) {
    const auto known = seen_.find(u);
    if (known != seen_.end()) return known->second;
    if (left() <= 0) throw OutOfEvaluations();
    Eigen::VectorXd x(static_cast<Index>(u.size()));
    for (std::size_t i = 0; i < u.size(); ++i) x(static_cast<Index>(i)) = scales_[i].value(u[i]);
    const std::optional<DesignValues> found = problem_.evaluate(x);
    if (found && found->conditions.size() != problem_.num_conditions)
      throw std::invalid_argument(
          fmt::format("evaluate: found {} conditions, allowed {}", found->conditions.size(), problem_.num_conditions));
    const bool known_values = usable(found);
    if (known_values)
      note(x, *found);
    else
      ++result_.num_missing;
    result_.trials.push_back({x, known_values ? found : std::nullopt});
    if (options_.progress && best_)
      options_.progress(static_cast<int>(result_.trials.size()), feasible(), best_->values.goal);
    return seen_.emplace(u, known_values ? found : std::nullopt).first->second;
  }

  // Goal over its scale at the first design; where there is no design, worse than all that were seen.
  double goal(const std::vector<double>& u) {
    const std::optional<DesignValues>& values = at(u);
    return values ? values->goal / scale() : worst_goal_ / scale() + 1;
  }
  double condition(const std::vector<double>& u, std::size_t j) {
    const std::optional<DesignValues>& values = at(u);
    return (values ? values->conditions(static_cast<Index>(j)) : worst_violation_ + 1) + safety;
  }
  double largest_condition(const std::vector<double>& u) {
    double largest = -HUGE_VAL;
    for (std::size_t j = 0; j < num_conditions(); ++j) largest = std::max(largest, condition(u, j));
    return largest;
  }
  double penalised(const std::vector<double>& u) {
    double sum = goal(u);
    for (std::size_t j = 0; j < num_conditions(); ++j) sum += penalty_weight * std::max(0.0, condition(u, j));
    return sum;
  }

  // Central differences, one-sided (second order) at a bound.
  template <class Function>
  void gradient(const std::vector<double>& u, Function&& function, std::vector<double>& slope) {
    slope.resize(u.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
      const auto moved = [&](double step) {
        std::vector<double> v = u;
        v[i] += step;
        return function(v);
      };
      constexpr double h = difference_step;
      if (u[i] - h < 0) {
        slope[i] = (-3 * function(u) + 4 * moved(h) - moved(2 * h)) / (2 * h);
      } else if (u[i] + h > 1) {
        slope[i] = (3 * function(u) - 4 * moved(-h) + moved(-2 * h)) / (2 * h);
      } else {
        slope[i] = (moved(h) - moved(-h)) / (2 * h);
      }
    }
  }

  DesignResult finish(bool converged) {
    if (!best_)
      throw std::invalid_argument(fmt::format("evaluate: none of the {} designs tried exists", result_.trials.size()));
    result_.x = best_->x;
    result_.values = best_->values;
    result_.status = !feasible() ? DesignStatus::infeasible : converged ? DesignStatus::optimal : DesignStatus::stopped;
    for (const auto& [what, analyses] : said_)
      result_.evidence += fmt::format("{}{} ({} analyses)", result_.evidence.empty() ? "" : ", then ", what, analyses);
    if (left() <= 0) result_.evidence += ", stopped by the number of analyses";
    return std::move(result_);
  }
  // What was run; the same again only adds its analyses.
  void say(const std::string& what, int analyses) {
    if (said_.empty() || said_.back().first != what) said_.emplace_back(what, 0);
    said_.back().second += analyses;
  }
  int evaluations() const { return static_cast<int>(result_.trials.size()); }
  const DesignOptions& options() const { return options_; }

  std::exception_ptr waiting;  // thrown inside a callback, to be thrown on behind NLopt

 private:
  struct Best {
    VectorXd x;
    DesignValues values;
  };

  // Feasible before infeasible, then the lower goal; among infeasible the smaller violation.
  static bool better(const DesignValues& a, const DesignValues& b) {
    const double va = violation(a), vb = violation(b);
    if (va <= 0 && vb <= 0) return a.goal < b.goal;
    return va < vb;
  }
  void note(const VectorXd& x, const DesignValues& values) {
    if (!scale_) scale_ = std::max(std::abs(values.goal), std::numeric_limits<double>::min());
    worst_goal_ = std::max(worst_goal_, values.goal);
    worst_violation_ = std::max(worst_violation_, violation(values));
    if (!best_ || better(values, best_->values)) best_ = Best{x, values};
  }
  std::vector<double> place(const VectorXd& x) const {
    std::vector<double> u;
    for (std::size_t i = 0; i < scales_.size(); ++i) u.push_back(scales_[i].place(x(static_cast<Index>(i))));
    return u;
  }
  double scale() const { return scale_.value_or(1); }

  const DesignProblem& problem_;
  const DesignOptions& options_;
  std::vector<Scale> scales_;
  std::map<std::vector<double>, std::optional<DesignValues>> seen_;
  std::optional<double> scale_;
  double worst_goal_ = -std::numeric_limits<double>::max() / 4, worst_violation_ = 0;
  std::optional<Best> best_;
  std::vector<std::pair<std::string, int>> said_;
  DesignResult result_;
};

struct Objective {
  Search* search;
  double (Search::*value)(const std::vector<double>&);
};

// NLopt's C code is between us and the callback: an exception waits in `search` until it is left.
template <class Function>
double guarded(Search& search, const std::vector<double>& u, std::vector<double>& slope, Function&& function) {
  try {
    if (!slope.empty()) search.gradient(u, function, slope);
    return function(u);
  } catch (...) {
    search.waiting = std::current_exception();
    throw nlopt::forced_stop();
  }
}

double objective(const std::vector<double>& u, std::vector<double>& slope, void* data) {
  const auto& [search, value] = *static_cast<Objective*>(data);
  return guarded(*search, u, slope, [&](const std::vector<double>& v) { return (search->*value)(v); });
}

struct Condition {
  Search* search;
  std::size_t number;
};

double condition(const std::vector<double>& u, std::vector<double>& slope, void* data) {
  const auto& [search, number] = *static_cast<Condition*>(data);
  return guarded(*search, u, slope, [&](const std::vector<double>& v) { return search->condition(v, number); });
}

// Restoration: minimise s over (u, s) subject to g_j(u) <= s.
double slack(const std::vector<double>& us, std::vector<double>& slope, void*) {
  if (!slope.empty()) {
    std::fill(slope.begin(), slope.end(), 0.0);
    slope.back() = 1;
  }
  return us.back();
}

double condition_with_slack(const std::vector<double>& us, std::vector<double>& slope, void* data) {
  const auto& [search, number] = *static_cast<Condition*>(data);
  return guarded(*search, us, slope, [&](const std::vector<double>& v) {
    return search->condition({v.begin(), v.end() - 1}, number) - v.back();
  });
}

// NLopt's failures that leave a result: rounding limits progress. Everything else is ours.
bool run(Search& search, nlopt::opt& opt, std::vector<double>& u) {
  double value = 0;
  try {
    const nlopt::result code = opt.optimize(u, value);
    return code == nlopt::SUCCESS || code == nlopt::FTOL_REACHED || code == nlopt::XTOL_REACHED ||
           code == nlopt::STOPVAL_REACHED;
  } catch (const nlopt::roundoff_limited&) {
    return true;
  } catch (const nlopt::forced_stop&) {
    if (search.waiting) std::rethrow_exception(search.waiting);
    throw;
  } catch (const std::runtime_error&) {  // NLopt's generic failure: singular model; the trials stand
    return false;
  }
}

void bound(nlopt::opt& opt, std::size_t n) {
  opt.set_lower_bounds(std::vector<double>(n, 0.0));
  opt.set_upper_bounds(std::vector<double>(n, 1.0));
}

bool local(Search& search, nlopt::algorithm algorithm, const char* name, double first_step) {
  const std::size_t n = search.size();
  nlopt::opt opt(algorithm, static_cast<unsigned>(n));
  bound(opt, n);
  Objective goal{&search, &Search::goal};
  opt.set_min_objective(objective, &goal);
  std::vector<Condition> conditions;
  for (std::size_t j = 0; j < search.num_conditions(); ++j) conditions.push_back({&search, j});
  for (Condition& c : conditions) opt.add_inequality_constraint(condition, &c, 0.0);
  opt.set_xtol_abs(search.options().tolerance);
  opt.set_initial_step(first_step);
  std::vector<double> u = search.best_place();
  const int before = search.evaluations();
  const bool converged = run(search, opt, u);
  search.say(name, search.evaluations() - before);
  return converged;
}

bool penalised_search(Search& search, nlopt::algorithm algorithm, const char* name, int budget) {
  const std::size_t n = search.size();
  nlopt::opt opt(algorithm, static_cast<unsigned>(n));
  bound(opt, n);
  Objective goal{&search, &Search::penalised};
  opt.set_min_objective(objective, &goal);
  if (budget > 0) opt.set_maxeval(budget);
  opt.set_xtol_abs(search.options().tolerance);
  opt.set_initial_step(0.1);
  if (algorithm == nlopt::G_MLSL_LDS) {
    nlopt::srand(static_cast<unsigned long>(search.options().seed));
    nlopt::opt inner(nlopt::LN_BOBYQA, static_cast<unsigned>(n));
    inner.set_xtol_abs(1e-3);
    inner.set_initial_step(0.1);
    opt.set_local_optimizer(inner);
    opt.set_population(4);
  }
  std::vector<double> u = search.best_place();
  const int before = search.evaluations();
  const bool converged = run(search, opt, u);
  search.say(name, search.evaluations() - before);
  return converged;
}

void restore(Search& search) {
  const std::size_t n = search.size();
  nlopt::opt opt(nlopt::LN_COBYLA, static_cast<unsigned>(n + 1));
  std::vector<double> us = search.best_place();
  us.push_back(search.largest_condition(us));
  std::vector<double> low(n, 0.0), high(n, 1.0), step(n, 0.1);
  low.push_back(-1);
  high.push_back(std::max(0.0, us.back()));
  step.push_back(std::max(0.1 * us.back(), 0.01));
  opt.set_lower_bounds(low);
  opt.set_upper_bounds(high);
  opt.set_initial_step(step);
  opt.set_min_objective(slack, nullptr);
  std::vector<Condition> conditions;
  for (std::size_t j = 0; j < search.num_conditions(); ++j) conditions.push_back({&search, j});
  for (Condition& c : conditions) opt.add_inequality_constraint(condition_with_slack, &c, 0.0);
  opt.set_xtol_abs(search.options().tolerance);
  opt.set_stopval(-1e-3);
  const int before = search.evaluations();
  run(search, opt, us);
  search.say("COBYLA on the largest violation", search.evaluations() - before);
}

void validate(const DesignProblem& problem, const DesignOptions& options) {
  const Index n = problem.lower.size();
  if (n < 1 || problem.upper.size() != n || problem.start.size() != n)
    throw std::invalid_argument(fmt::format("lower, upper, start: found sizes {}, {}, {}, allowed equal and >= 1", n,
                                            problem.upper.size(), problem.start.size()));
  for (Index i = 0; i < n; ++i) {
    const double a = problem.lower(i), b = problem.upper(i), x = problem.start(i);
    if (!(a < b) || !std::isfinite(b - a))
      throw std::invalid_argument(fmt::format("lower[{}], upper[{}]: found {}, {}, allowed lower < upper", i, i, a, b));
    if (!(a <= x && x <= b))
      throw std::invalid_argument(fmt::format("start[{}]: found {}, allowed {} to {}", i, x, a, b));
  }
  if (!problem.evaluate) throw std::invalid_argument("evaluate: found nothing, allowed a function");
  if (!(options.tolerance > 0))
    throw std::invalid_argument(fmt::format("tolerance: found {}, allowed > 0", options.tolerance));
  if (options.max_evaluations < 1)
    throw std::invalid_argument(fmt::format("max_evaluations: found {}, allowed >= 1", options.max_evaluations));
}

// Anew from the best design, with other first steps, until that moves it no more.
bool settle(Search& search, nlopt::algorithm algorithm, const char* name) {
  constexpr int most = 12;
  for (int round = 0; round < most; ++round) {
    const std::vector<double> before = search.best_place();
    const double first_step = round % 3 == 0 ? 0.05 : round % 3 == 1 ? 0.01 : 0.002;
    const bool converged = local(search, algorithm, name, first_step);
    const std::vector<double> after = search.best_place();
    double moved = 0;
    for (std::size_t i = 0; i < after.size(); ++i) moved = std::max(moved, std::abs(after[i] - before[i]));
    if (round > 0 && converged && moved <= search.options().tolerance) return true;
  }
  return false;
}

bool search_all(Search& search, DesignAlgorithm algorithm) {
  const int n = static_cast<int>(search.size());
  (void)search.at(search.start());
  const int global = std::min(search.left() / 3, 20 + 40 * n);
  switch (algorithm) {
    case DesignAlgorithm::automatic:
    case DesignAlgorithm::direct:
      penalised_search(search, nlopt::GN_DIRECT_L_NOSCAL, "DIRECT-L on a penalty", global);
      break;
    case DesignAlgorithm::mlsl:
      penalised_search(search, nlopt::G_MLSL_LDS, "MLSL on a penalty", global);
      break;
    default:
      break;
  }
  if (!search.feasible() && search.num_conditions() > 0) restore(search);
  switch (algorithm) {
    case DesignAlgorithm::bobyqa:
      // BOBYQA needs two variables, and stops at the penalty's kinks.
      if (n > 1) penalised_search(search, nlopt::LN_BOBYQA, "BOBYQA on a penalty", 0);
      return settle(search, nlopt::LN_COBYLA, "COBYLA");
    case DesignAlgorithm::slsqp:
      return settle(search, nlopt::LD_SLSQP, "SLSQP");
    case DesignAlgorithm::mma:
      return settle(search, nlopt::LD_MMA, "MMA");
    case DesignAlgorithm::automatic:
      // Differences see the smooth part around, COBYLA the kinks.
      if (search.feasible()) local(search, nlopt::LD_SLSQP, "SLSQP", 0.05);
      break;
    default:
      break;
  }
  return settle(search, nlopt::LN_COBYLA, "COBYLA");
}

}  // namespace

DesignResult optimise(const DesignProblem& problem, const DesignOptions& options) {
  validate(problem, options);
  Search search(problem, options);
  bool converged = false;
  try {
    converged = search_all(search, options.algorithm);
  } catch (const OutOfEvaluations&) {
    converged = false;
  }
  return search.finish(converged);
}

const char* to_string(DesignAlgorithm algorithm) {
  switch (algorithm) {
    case DesignAlgorithm::automatic:
      return "automatic";
    case DesignAlgorithm::direct:
      return "direct";
    case DesignAlgorithm::mlsl:
      return "mlsl";
    case DesignAlgorithm::cobyla:
      return "cobyla";
    case DesignAlgorithm::bobyqa:
      return "bobyqa";
    case DesignAlgorithm::slsqp:
      return "slsqp";
    case DesignAlgorithm::mma:
      return "mma";
  }
  return "";
}

}  // namespace hb
