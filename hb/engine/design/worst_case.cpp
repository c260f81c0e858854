#include "hb/engine/design/worst_case.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hb/engine/design/design.hpp"

namespace hb {

namespace {

// Brent's bounded search, golden sections and parabolas (Algorithms for Minimization without Derivatives, 1973, ch. 5),
// of the maximum in [a, b] from a first point inside. False if the function is NaN on the way.
bool brent(const std::function<double(double)>& f, double a, double b, double x, double fx, double tolerance,
           WorstCase& found) {
  constexpr double golden = 0.3819660112501051;
  constexpr int most = 60;
  double w = x, v = x, fw = fx, fv = fx, step = 0, last = 0;
  for (int k = 0; k < most; ++k) {
    const double middle = 0.5 * (a + b), small = tolerance * std::abs(x) + 1e-300;
    if (std::abs(x - middle) <= 2 * small - 0.5 * (b - a)) break;
    bool parabola = false;
    if (std::abs(last) > small) {
      const double r = (x - w) * (fx - fv), q0 = (x - v) * (fx - fw);
      double p = (x - v) * q0 - (x - w) * r, q = 2 * (q0 - r);
      if (q > 0) p = -p;
      q = std::abs(q);
      if (std::abs(p) < std::abs(0.5 * q * last) && p > q * (a - x) && p < q * (b - x)) {
        last = step;
        step = p / q;
        if (x + step - a < 2 * small || b - x - step < 2 * small) step = x < middle ? small : -small;
        parabola = true;
      }
    }
    if (!parabola) {
      last = x < middle ? b - x : a - x;
      step = golden * last;
    }
    const double u = x + (std::abs(step) >= small ? step : step > 0 ? small : -small);
    const double fu = f(u);
    if (std::isnan(fu)) return false;
    if (fu >= fx) {
      (u >= x ? a : b) = x;
      v = w, fv = fw;
      w = x, fw = fx;
      x = u, fx = fu;
    } else {
      (u < x ? a : b) = u;
      if (fu >= fw || w == x) {
        v = w, fv = fw;
        w = u, fw = fu;
      } else if (fu >= fv || v == x || v == w) {
        v = u, fv = fu;
      }
    }
  }
  if (fx > found.value) found = {x, fx};
  return true;
}

}  // namespace

WorstCase worst_case(const std::function<double(double)>& f, const std::vector<double>& x,
                     const std::vector<double>& values, const WorstCaseOptions& options) {
  const WorstCase none{x.front(), std::numeric_limits<double>::quiet_NaN()};
  if (std::ranges::any_of(values, [](double value) { return std::isnan(value); })) return none;
  const auto largest = std::ranges::max_element(values);
  const double lowest = *std::ranges::min_element(values), contested = *largest - options.contest * (*largest - lowest);
  WorstCase found{x[static_cast<std::size_t>(largest - values.begin())], *largest};
  const std::size_t n = x.size();
  for (std::size_t k = 0; k < n; ++k) {
    if (values[k] < contested) continue;
    const bool first = k == 0, last = k + 1 == n;
    if ((!first && values[k - 1] > values[k]) || (!last && values[k + 1] > values[k])) continue;
    const double a = x[first ? k : k - 1], b = x[last ? k : k + 1];
    if (!(a < b)) continue;
    double start = x[k], at_start = values[k];
    if (first || last) {
      // Falling away from an end: the end is the maximum.
      const double near = first ? a + 0.02 * (b - a) : b - 0.02 * (b - a), at_near = f(near);
      if (std::isnan(at_near)) return none;
      if (at_near <= values[k]) continue;
      start = near;
      at_start = at_near;
    }
    if (!brent(f, a, b, start, at_start, options.tolerance, found)) return none;
  }
  return found;
}

WorstPoint worst_point(const std::function<double(const Eigen::VectorXd&)>& f, const Eigen::VectorXd& x,
                       const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  const WorstPoint start{x, f(x)};
  if (!std::isfinite(start.value)) return start;
  DesignProblem problem;
  problem.lower = lower;
  problem.upper = upper;
  problem.start = x;
  problem.evaluate = [&](const Eigen::VectorXd& y) { return DesignValues{-f(y), {}}; };
  DesignOptions options;
  options.algorithm = DesignAlgorithm::bobyqa;
  options.tolerance = 1e-6;  // of the box: its square of the value
  options.max_evaluations = 200;
  const DesignResult found = optimise(problem, options);
  return -found.values.goal > start.value ? WorstPoint{found.x, -found.values.goal} : start;
}

}  // namespace hb
