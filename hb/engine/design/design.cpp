#include "hb/engine/design/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <nlopt.hpp>
#include <stdexcept>

#include "hb/engine/design/design_search.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Search = DesignSearch;

// An exception thrown inside a callback, to be thrown on behind NLopt's C code.
struct Waiting {
  std::exception_ptr exception;
};

struct Objective {
  Search* search;
  Waiting* waiting;
  bool penalised;
};

struct Condition {
  Search* search;
  Waiting* waiting;
  std::size_t number;
};

template <class Data, class Function>
double guarded(const Data& data, Function&& function) {
  try {
    return function();
  } catch (...) {
    data.waiting->exception = std::current_exception();
    throw nlopt::forced_stop();
  }
}

double objective(const std::vector<double>& u, std::vector<double>& slope, void* pointer) {
  const auto& data = *static_cast<Objective*>(pointer);
  return guarded(data, [&] {
    if (!slope.empty()) data.search->goal_slope(u, slope);
    return data.penalised ? data.search->penalised(u) : data.search->goal(u);
  });
}

double condition(const std::vector<double>& u, std::vector<double>& slope, void* pointer) {
  const auto& data = *static_cast<Condition*>(pointer);
  return guarded(data, [&] {
    if (!slope.empty()) data.search->condition_slope(u, data.number, slope);
    return data.search->condition(u, data.number);
  });
}

// With one more variable s, minimised: restoration subject to g_j(u) <= s, the epigraph of max f_k subject to
// f_k(u) <= s and g_j(u) <= 0, smooth where the largest of several has a kink.
double last(const std::vector<double>& us, std::vector<double>& slope, void*) {
  if (!slope.empty()) {
    std::ranges::fill(slope, 0.0);
    slope.back() = 1;
  }
  return us.back();
}

std::vector<double> without_last(const std::vector<double>& us) { return {us.begin(), us.end() - 1}; }

double condition_with_slack(const std::vector<double>& us, std::vector<double>&, void* pointer) {
  const auto& data = *static_cast<Condition*>(pointer);
  return guarded(data, [&] { return data.search->condition(without_last(us), data.number) - us.back(); });
}

double condition_beside(const std::vector<double>& us, std::vector<double>& slope, void* pointer) {
  const auto& data = *static_cast<Condition*>(pointer);
  return guarded(data, [&] {
    if (!slope.empty()) {
      data.search->condition_slope(without_last(us), data.number, slope);
      slope.back() = 0;
    }
    return data.search->condition(without_last(us), data.number);
  });
}

double part_below(const std::vector<double>& us, std::vector<double>& slope, void* pointer) {
  const auto& data = *static_cast<Condition*>(pointer);
  return guarded(data, [&] {
    if (!slope.empty()) {
      data.search->part_slope(without_last(us), data.number, slope);
      slope.back() = -1;
    }
    return data.search->part(without_last(us), data.number) - us.back();
  });
}

std::vector<Condition> conditions_of(Search& search, Waiting& waiting) {
  std::vector<Condition> conditions;
  for (std::size_t j = 0; j < search.num_conditions(); ++j) conditions.push_back({&search, &waiting, j});
  return conditions;
}

// Says at its end how many analyses the method took, also where they run out.
class Said {
 public:
  Said(Search& search, std::string method)
      : search_(search), method_(std::move(method)), before_(search.evaluations()) {}
  ~Said() { search_.say(method_, search_.evaluations() - before_); }
  Said(const Said&) = delete;
  Said& operator=(const Said&) = delete;

 private:
  Search& search_;
  std::string method_;
  int before_;
};

// NLopt's failures that leave a result: rounding limits progress. Everything else is ours.
bool run(const Waiting& waiting, nlopt::opt& opt, std::vector<double>& u) {
  double value = 0;
  try {
    const nlopt::result code = opt.optimize(u, value);
    return code == nlopt::SUCCESS || code == nlopt::FTOL_REACHED || code == nlopt::XTOL_REACHED ||
           code == nlopt::STOPVAL_REACHED;
  } catch (const nlopt::roundoff_limited&) {
    return true;
  } catch (const nlopt::forced_stop&) {
    if (waiting.exception) std::rethrow_exception(waiting.exception);
    throw;
  } catch (const std::runtime_error&) {  // NLopt's generic failure: singular model; the trials stand
    return false;
  }
}

void bound(nlopt::opt& opt, std::size_t n) {
  opt.set_lower_bounds(std::vector<double>(n, 0.0));
  opt.set_upper_bounds(std::vector<double>(n, 1.0));
}

bool epigraph(Search& search, nlopt::algorithm algorithm, const char* name, double first_step) {
  const std::size_t n = search.size();
  nlopt::opt opt(algorithm, static_cast<unsigned>(n + 1));
  std::vector<double> us = search.best_place();
  us.push_back(search.goal(us));
  std::vector<double> low(n, 0.0), high(n, 1.0);
  low.push_back(-HUGE_VAL);
  high.push_back(HUGE_VAL);
  opt.set_lower_bounds(low);
  opt.set_upper_bounds(high);
  opt.set_min_objective(last, nullptr);
  Waiting waiting;
  std::vector<Condition> conditions = conditions_of(search, waiting), parts;
  for (std::size_t k = 0; k < search.num_parts(); ++k) parts.push_back({&search, &waiting, k});
  for (Condition& p : parts) opt.add_inequality_constraint(part_below, &p, 0.0);
  for (Condition& c : conditions) opt.add_inequality_constraint(condition_beside, &c, 0.0);
  opt.set_xtol_abs(search.options().tolerance);
  opt.set_initial_step(first_step);
  const Said said(search, fmt::format("{} on the epigraph", name));
  return run(waiting, opt, us);
}

bool local(Search& search, nlopt::algorithm algorithm, const char* name, double first_step) {
  if (search.num_parts() > 1 && algorithm != nlopt::LN_BOBYQA) return epigraph(search, algorithm, name, first_step);
  const std::size_t n = search.size();
  nlopt::opt opt(algorithm, static_cast<unsigned>(n));
  bound(opt, n);
  Waiting waiting;
  Objective goal{&search, &waiting, false};
  opt.set_min_objective(objective, &goal);
  std::vector<Condition> conditions = conditions_of(search, waiting);
  for (Condition& c : conditions) opt.add_inequality_constraint(condition, &c, 0.0);
  opt.set_xtol_abs(search.options().tolerance);
  opt.set_initial_step(first_step);
  std::vector<double> u = search.best_place();
  const Said said(search, name);
  return run(waiting, opt, u);
}

bool penalised_search(Search& search, nlopt::algorithm algorithm, const char* name, int budget) {
  const std::size_t n = search.size();
  nlopt::opt opt(algorithm, static_cast<unsigned>(n));
  bound(opt, n);
  Waiting waiting;
  Objective goal{&search, &waiting, true};
  opt.set_min_objective(objective, &goal);
  if (budget > 0) opt.set_maxeval(budget);
  opt.set_xtol_abs(search.options().tolerance);
  opt.set_initial_step(0.1);
  if (algorithm == nlopt::G_MLSL) {
    nlopt::srand(static_cast<unsigned long>(search.options().seed));
    nlopt::opt inner(nlopt::LN_BOBYQA, static_cast<unsigned>(n));
    inner.set_xtol_abs(1e-3);
    inner.set_initial_step(0.1);
    opt.set_local_optimizer(inner);
    opt.set_population(4);
  }
  std::vector<double> u = search.best_place();
  const Said said(search, name);
  return run(waiting, opt, u);
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
  opt.set_min_objective(last, nullptr);
  Waiting waiting;
  std::vector<Condition> conditions = conditions_of(search, waiting);
  for (Condition& c : conditions) opt.add_inequality_constraint(condition_with_slack, &c, 0.0);
  opt.set_xtol_abs(search.options().tolerance);
  opt.set_stopval(-1e-3);
  const Said said(search, "COBYLA on the largest violation");
  run(waiting, opt, us);
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
  if (options.algorithm == DesignAlgorithm::bobyqa && (n < 2 || problem.num_conditions > 0))
    throw std::invalid_argument(fmt::format(
        "algorithm: found bobyqa for {} variables and {} conditions, allowed 2 variables or more and no conditions", n,
        problem.num_conditions));
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
  if (!search.options().only_local) {
    if (algorithm == DesignAlgorithm::automatic || algorithm == DesignAlgorithm::direct)
      penalised_search(search, nlopt::GN_DIRECT_L_NOSCAL, "DIRECT-L on a penalty", global);
    if (algorithm == DesignAlgorithm::mlsl) penalised_search(search, nlopt::G_MLSL, "MLSL on a penalty", global);
  }
  // All but MMA find back from a small violation by themselves.
  constexpr double small = 1e-2;
  const double tolerated = algorithm == DesignAlgorithm::mma ? 0 : small;
  if (search.num_conditions() > 0 && search.least_violation() > tolerated) restore(search);
  switch (algorithm) {
    case DesignAlgorithm::bobyqa:
      return settle(search, nlopt::LN_BOBYQA, "BOBYQA");
    case DesignAlgorithm::slsqp:
      return settle(search, nlopt::LD_SLSQP, "SLSQP");
    case DesignAlgorithm::mma:
      return settle(search, nlopt::LD_MMA, "MMA");
    case DesignAlgorithm::automatic:
      // Derivatives see the smooth part around, COBYLA the kinks.
      if (search.least_violation() <= small) {
        local(search, nlopt::LD_SLSQP, "SLSQP", 0.05);
        if (search.stationary()) return true;
      }
      if (search.num_conditions() > 0 && !search.feasible()) restore(search);
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
