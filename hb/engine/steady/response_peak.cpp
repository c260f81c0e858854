#include "hb/engine/steady/response_peak.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/constants.hpp"

namespace hb {

namespace {

using Eigen::Index;

constexpr Index N = 13;  // Chebyshev points

// f(c + r t) = sum a_k T_k(t), from its values at the roots t_j = cos(pi (2 j + 1)/(2 N)) of T_N.
Eigen::VectorXd coefficients(const Eigen::VectorXd& values) {
  Eigen::VectorXd a(N);
  for (Index k = 0; k < N; ++k) {
    double sum = 0;
    for (Index j = 0; j < N; ++j)
      sum += values(j) * std::cos(pi * static_cast<double>(k) * (2 * static_cast<double>(j) + 1) / (2 * N));
    a(k) = sum * (k == 0 ? 1.0 : 2.0) / N;
  }
  return a;
}

// Coefficients of the derivative with respect to t: b_(k-1) = b_(k+1) + 2 k a_k, b_0 halved.
Eigen::VectorXd derivative(const Eigen::VectorXd& a) {
  const Index n = a.size();
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  for (Index k = n - 1; k >= 1; --k) b(k - 1) = (k + 1 < n ? b(k + 1) : 0) + 2 * static_cast<double>(k) * a(k);
  b(0) /= 2;
  return b;
}

// Clenshaw.
double evaluate(const Eigen::VectorXd& a, double t) {
  double b1 = 0, b2 = 0;
  for (Index k = a.size() - 1; k >= 1; --k) {
    const double b = a(k) + 2 * t * b1 - b2;
    b2 = b1;
    b1 = b;
  }
  return a(0) + t * b1 - b2;
}

// Zero of the derivative in [-1, 1] at which f is largest; NaN if there is none with a maximum.
double largest_at(const Eigen::VectorXd& a) {
  const Eigen::VectorXd b = derivative(a);
  constexpr int cells = 64;
  double best = std::numeric_limits<double>::quiet_NaN(), best_value = -HUGE_VAL;
  for (int i = 0; i < cells; ++i) {
    double low = -1 + 2.0 * i / cells, high = -1 + 2.0 * (i + 1) / cells;
    if (!(evaluate(b, low) > 0) || evaluate(b, high) > 0) continue;
    for (int step = 0; step < 60 && high - low > eps; ++step) {
      const double middle = 0.5 * (low + high);
      (evaluate(b, middle) > 0 ? low : high) = middle;
    }
    const double value = evaluate(a, 0.5 * (low + high));
    if (value > best_value) {
      best_value = value;
      best = 0.5 * (low + high);
    }
  }
  return best;
}

constexpr double pole_distance = 2e-7;  // relative: so near a pole has to show

// Of a pole seen from two distances.
bool same_residue(double a, double b) { return a >= 0.8 * b && a <= 1.25 * b; }

// f = c/|x - x0| near x0: then (x0 - l)/(r - x0) = f(r)/f(l), and f(l) f(r)/(f(l) + f(r)) (r - l) = c whatever l, r.
std::optional<ResponsePeak> locate_pole(const ResponseAt& value, double a, double x, double b) {
  double distance = 0.25 * std::min(x - a, b - x), last = 0;
  for (int step = 0; step < 12; ++step) {
    const double l = x - distance, r = x + distance;
    const std::optional<double> fl = value(l), fr = value(r);
    if (!fl || !fr) return std::nullopt;
    const double residue = *fl * *fr / (*fl + *fr) * (r - l);
    const bool constant = step > 0 && same_residue(residue, last);
    if (step > 1 && !constant) return std::nullopt;
    const double next = l + (r - l) * *fr / (*fl + *fr);
    if (distance <= pole_distance * std::abs(x) && constant) return ResponsePeak{next, HUGE_VAL, distance, false};
    x = next;
    last = residue;
    distance *= 0.03;
  }
  return std::nullopt;
}

// From ever smaller distances; what the last step changed is the error. Rough values so near a pole may be off by some
// tenths.
ResponsePeak refined_pole(const ResponseAt& value, ResponsePeak pole, double tolerance) {
  constexpr int most_steps = 6;
  constexpr double least = 1e4 * eps;  // relative
  double distance = std::max(pole.error, least * std::abs(pole.x)), last = 0;
  pole.error = distance;
  for (int step = 0; step < most_steps && !pole.converged; ++step, distance *= 0.2) {
    const double l = pole.x - distance, r = pole.x + distance;
    const std::optional<double> fl = value(l), fr = value(r);
    if (!fl || !fr) return pole;
    const double residue = *fl * *fr / (*fl + *fr) * (r - l), next = l + (r - l) * *fr / (*fl + *fr);
    const double error = std::abs(next - pole.x) + 4 * eps * std::abs(pole.x);
    if (step > 0 && !(error < pole.error && same_residue(residue, last))) return pole;
    pole = {next, HUGE_VAL, step > 0 ? error : distance, step > 0 && error <= tolerance * std::abs(next)};
    last = residue;
  }
  return pole;
}

// The top at x lies between a and b.
struct Bracket {
  double a, x, b, fa, fx, fb;
  std::optional<ResponsePeak> pole;  // found instead

  bool narrow(const ResponseAt& rough, double tolerance);
};

// Golden sections with parabolas until the parabola describes what is between: a width to interpolate over. False where
// there is no response.
bool Bracket::narrow(const ResponseAt& rough, double tolerance) {
  const double f_low = fa, f_high = fb, width = b - a;
  constexpr double golden = 0.3819660112501051;
  constexpr int max_steps = 60;
  double last_width = HUGE_VAL;
  double next_pole = 10;  // growth at which a pole is suspected
  for (int step = 0; step < max_steps; ++step) {
    if (b - a <= 1e-3 * tolerance * std::abs(x)) break;
    const double p = (x - a) * (fx - fb), q = (b - x) * (fx - fa);
    double y = x - 0.5 * ((x - a) * p - (b - x) * q) / (p + q);
    const double margin = 0.05 * (b - a);
    const bool shrinks = b - a <= 0.6 * last_width;
    last_width = b - a;
    const bool parabola = std::isfinite(y) && y > a + margin && y < b - margin && shrinks;
    if (!parabola || std::abs(y - x) <= margin) y = b - x > x - a ? x + golden * (b - x) : x - golden * (x - a);
    const std::optional<double> fy = rough(y);
    if (!fy) return false;
    if (*fy > fx) {
      (y > x ? a : b) = x;
      (y > x ? fa : fb) = fx;
      x = y;
      fx = *fy;
    } else {
      (y > x ? b : a) = y;
      (y > x ? fb : fa) = *fy;
    }
    if (fx >= next_pole * std::max(f_low, f_high)) {
      next_pole *= 10;
      if ((pole = locate_pole(rough, a, x, b))) return true;
    }
    // Ends that have come near the top: the function is about parabolic between.
    if (fx - std::min(fa, fb) <= 0.1 * std::abs(fx) && b - a <= 0.25 * width) break;
  }
  return true;
}

// Chebyshev interpolation over ever narrower intervals round the top.
std::optional<ResponsePeak> interpolate_top(const ResponseAt& value, const Bracket& top, double low, double high,
                                            double tolerance) {
  double c = top.x, r = std::min({0.5 * (top.b - top.a), c - low, high - c});
  ResponsePeak peak{top.x, top.fx, 0.5 * (top.b - top.a), false};
  constexpr int max_rounds = 12;
  for (int round = 0; round < max_rounds; ++round) {
    r = std::min({r, c - low, high - c});
    if (!(r > 4 * eps * std::abs(c))) break;
    Eigen::VectorXd values(N);
    for (Index j = 0; j < N; ++j) {
      const double t = std::cos(pi * (2 * static_cast<double>(j) + 1) / (2 * N));
      const std::optional<double> f = value(c + r * t);
      if (!f) return std::nullopt;
      values(j) = *f;
    }
    const Eigen::VectorXd coefs = coefficients(values);
    const double t = largest_at(coefs);
    if (!std::isfinite(t)) {
      // The top lies beside: move to the better end.
      Index best;
      values.maxCoeff(&best);
      const double moved = c + (best == 0 ? r : best == N - 1 ? -r : 0);
      if (moved == c) r *= 0.5;
      c = moved;
      continue;
    }
    // Truncation by the last coefficients, noise by rounding; both differentiate to at most N^2 times themselves.
    const double tail = coefs.tail(2).cwiseAbs().maxCoeff();
    const double curvature = std::abs(evaluate(derivative(derivative(coefs)), t));
    const double noise = 4 * eps * values.cwiseAbs().maxCoeff();
    const double slope_error = std::max(tail, noise) * static_cast<double>(N);
    const double error = r * slope_error / curvature;
    const double at = c + r * t;
    if (std::isfinite(error) && (round == 0 || error < peak.error)) peak = {at, evaluate(coefs, t), error, false};
    peak.converged = peak.error <= tolerance * std::abs(peak.x);
    if (peak.converged && std::abs(t) <= 0.5) return peak;
    const bool truncated = tail > 8 * noise;
    c = at;
    if (truncated) {
      r *= 0.4;
    } else if (std::abs(t) <= 0.5) {
      return peak;  // rounding is the limit
    }
  }
  return peak;
}

}  // namespace

std::optional<ResponsePeak> locate_peak(const ResponseAt& rough, const ResponseAt& value, double low, double inside,
                                        double high, double tolerance) {
  const std::optional<double> f_low = rough(low), f_inside = rough(inside), f_high = rough(high);
  if (!f_low || !f_inside || !f_high) return std::nullopt;
  Bracket top{low, inside, high, *f_low, *f_inside, *f_high, std::nullopt};
  if (!top.narrow(rough, tolerance)) return std::nullopt;
  return top.pole ? refined_pole(value, *top.pole, tolerance) : interpolate_top(value, top, low, high, tolerance);
}

}  // namespace hb
