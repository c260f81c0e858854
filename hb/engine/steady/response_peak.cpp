#include "hb/engine/steady/response_peak.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "hb/engine/steady/response_interpolant.hpp"
#include "lib/constants.hpp"
#include "lib/zero_between.hpp"

namespace hb {

namespace {

constexpr double pole_distance = 2e-6;  // relative: so near a pole has to show
constexpr double pole_rounding = 64 * eps;  // of its place, which that of the system moves

double height(const FourierSeries& response) { return fourier::max_abs(response, 0).value; }

// q = A/(x - x0) + B beside a pole: x0 from three places, A along what q changes between them; the next place lies as
// far beside it as the last one was off, but no nearer than `nearest`, where a pole has to show. Empty where they do
// not come to agree to the tolerance.
std::optional<ResponsePeak> locate_pole(const ResponseAt& value, double about, double distance, double nearest,
                                        double tolerance) {
  constexpr int most_steps = 6;
  struct Seen {
    double x;
    FourierSeries q;
  };
  std::vector<Seen> seen;
  const auto look = [&](double x) {
    std::optional<FourierSeries> q = value(x);
    if (q) seen.push_back({x, *std::move(q)});
    return q.has_value();
  };
  if (!look(about - distance) || !look(about + 0.7 * distance) || !look(about + 0.2 * distance)) return std::nullopt;
  double x0 = about, changed = 3 * distance;
  for (int step = 0; step < most_steps; ++step) {
    const Seen *p = &seen.end()[-3], *q = &seen.end()[-2], *r = &seen.end()[-1];
    const FourierSeries A = fourier::difference(r->q, q->q);
    const double first = fourier::mean_product(A, fourier::difference(p->q, q->q)),
                 second = fourier::mean_product(A, fourier::difference(q->q, r->q));
    // (r - x0)/(p - x0)
    const double ratio = first / second * (r->x - q->x) / (q->x - p->x), next = (r->x - ratio * p->x) / (1 - ratio);
    const double change = std::abs(next - x0), error = change + pole_rounding * std::abs(next);
    if (!(change <= std::max(0.5 * changed, tolerance * std::abs(next)))) return std::nullopt;
    const bool shown = step > 0 && std::abs(r->x - next) <= 2 * nearest;
    if (shown && error <= tolerance * std::abs(next)) return ResponsePeak{next, HUGE_VAL, error, true};
    x0 = next;
    changed = change;
    const double beside = std::max(change, nearest);
    if (!look(x0 + (step % 2 == 0 ? beside : -beside))) return std::nullopt;
  }
  return std::nullopt;
}

// g = 1/f^2: beside a resonance about c ((x - x0)^2 + w^2).
double flattened(double f) { return 1 / (f * f); }

// The least g, at x, lies between a and b.
struct Bracket {
  double a, x, b, ga, gx, gb;
  std::optional<ResponsePeak> pole;  // found instead
  double width = 0;  // of the resonance, or of half of what is between a and b
  bool fine = false;  // by fine responses
  bool ended = false;  // narrower ones do not tell where the least lies

  // Whether g and gx differ by more than errors of heights; where not, fine responses may tell, once.
  bool differ(double g, const PeakResponses& at) const {
    return std::abs(g - gx) > 4 * (fine ? at.fine_error : at.rough_error) * gx;
  }
  bool to_fine(const PeakResponses& at);
  bool narrow(const PeakResponses& at, double most_width, double tolerance);
};

std::optional<double> flattened_at(const ResponseAt& value, double x) {
  const std::optional<FourierSeries> q = value(x);
  if (!q) return std::nullopt;
  return flattened(height(*q));
}

// False where that has been done, or there is none.
bool Bracket::to_fine(const PeakResponses& at) {
  if (fine) return false;
  fine = true;
  const std::optional<double> low = flattened_at(at.fine, a), inside = flattened_at(at.fine, x),
                              high = flattened_at(at.fine, b);
  if (!low || !inside || !high) return false;
  ga = *low;
  gx = *inside;
  gb = *high;
  return true;
}

// By parabolas, or golden sections where these do not shrink the bracket, until that is no wider than `most_width` and
// the vertex moves by less than half of the width w, or until heights differ by their errors alone. False where there
// is no response, or where fine ones do not have the least g inside.
bool Bracket::narrow(const PeakResponses& at, double most_width, double tolerance) {
  constexpr double golden = 0.3819660112501051, near_pole = 1e-5;
  constexpr int max_steps = 60;
  double last_width = HUGE_VAL, tried = HUGE_VAL;
  for (int step = 0; step < max_steps; ++step) {
    width = 0.5 * (b - a);
    if (b - a <= 1e-3 * tolerance * std::abs(x)) break;
    if (!fine && !differ(std::min(ga, gb), at) && !to_fine(at)) return false;
    const double c = ((gb - gx) / (b - x) - (gx - ga) / (x - a)) / (b - a);
    const double slope = (gx - ga) / (x - a) + c * (x - a), vertex = x - slope / (2 * c), w = std::sqrt(gx / c);
    if (step > 0 && b - a <= most_width && std::abs(vertex - x) <= 0.5 * w) {
      width = std::min(width, w);
      break;
    }
    // So near a pole, or a resonance as narrow.
    if (w <= near_pole * std::abs(x) && w < 0.1 * tried && std::abs(vertex - x) <= 2 * w) {
      tried = w;
      const double nearest = std::min(pole_distance * std::abs(x), 0.1 * std::min(vertex - a, b - vertex));
      if ((pole = locate_pole(at.fine, vertex, std::max(w, nearest), nearest, tolerance))) return true;
    }
    const bool shrinks = b - a <= 0.6 * last_width;
    last_width = b - a;
    double y = vertex;
    if (!(vertex > a && vertex < b && (shrinks || w < 0.05 * (b - a))))
      y = b - x > x - a ? x + golden * (b - x) : x - golden * (x - a);
    const std::optional<double> gy = flattened_at(fine ? at.fine : at.rough, y);
    if (!gy) return false;
    if (!differ(*gy, at)) {
      if (to_fine(at)) continue;
      ended = true;
      break;
    }
    if (*gy < gx) {
      (y > x ? a : b) = x;
      (y > x ? ga : gb) = gx;
      x = y;
      gx = *gy;
    } else {
      (y > x ? b : a) = y;
      (y > x ? gb : ga) = *gy;
    }
    if (fine && gx > std::min(ga, gb)) return false;
  }
  return true;
}

// Where |q| is largest over the turn: its value there does not tell the angle to more than half of the digits.
double angle_of_top(const FourierSeries& q) {
  constexpr double most_moved = 1e-4;
  double angle = fourier::max_abs(q, 0).crank_angle;
  const FourierSeries slope = fourier::derivative(q), bend = fourier::derivative(q, 2);
  for (int step = 0; step < 2; ++step)
    if (const double moved = fourier::evaluate(slope, angle)(0) / fourier::evaluate(bend, angle)(0);
        std::abs(moved) < most_moved)
      angle -= moved;
  return angle;
}

// d/dx max_tau |q|: the slope of q at the angle where it is largest.
double rise(const ResponseInterpolant& response, double x) {
  const FourierSeries q = response(x);
  const double angle = angle_of_top(q), slope = fourier::evaluate(response.slope(x), angle)(0);
  return fourier::evaluate(q, angle)(0) < 0 ? -slope : slope;
}

// Within c -+ r, where it rises no longer; empty where it is largest at an end, on the side returned by `beside`.
std::optional<ResponsePeak> highest(const ResponseInterpolant& response, double c, double r, double error,
                                    int& beside) {
  constexpr int parts = 16;
  const double step = 2 * r / parts;
  int best = 0;
  double value = -HUGE_VAL;
  for (int k = 0; k <= parts; ++k)
    if (const double f = height(response(c - r + step * k)); f > value) {
      value = f;
      best = k;
    }
  beside = best == 0 ? -1 : best == parts ? 1 : 0;
  if (beside != 0) return std::nullopt;
  const double top = c - r + step * best, h = 0.25 * step;
  const double x =
      zero_between(top - step, top + step, eps * std::abs(c), [&](double at) { return rise(response, at); });
  const auto turned = [&](double within) { return rise(response, x - within) - rise(response, x + within); };
  // Two angles may be as high there: then the slope jumps, and it is the heights that tell.
  constexpr double nearer = 0.125;
  const double all = turned(h), jump = (turned(nearer * h) - nearer * all) / (1 - nearer);
  // Slopes whose errors hide how they change do not tell that the top lies here.
  constexpr double above = 4;
  const double slope_error = response.slope_error(x, error);
  if (!(all > above * slope_error)) return ResponsePeak{x, height(response(x)), HUGE_VAL, false};
  const double x_error = (jump > 0.25 * all ? 2 * error / jump : 2 * h * slope_error / all) + 4 * eps * std::abs(x);
  return ResponsePeak{x, height(response(x)), x_error, false};
}

// Interpolation over ever narrower intervals round the top, or round a pole that shows: what is known then, the best of
// it, if anything.
std::optional<ResponsePeak> interpolate_top(const PeakResponses& at, const Bracket& top, double tolerance) {
  constexpr double near_pole = 0.1, beside_pole = 0.1;
  constexpr int most_rounds = 6;
  double c = top.x, r = top.width, last_pole = HUGE_VAL;
  std::optional<ResponsePeak> best;
  for (int round = 0; round < most_rounds; ++round) {
    r = std::min({r, c - top.a, top.b - c});
    if (!(r > 4 * eps * std::abs(c))) break;
    std::vector<FourierSeries> fine;
    for (const double x : ResponseInterpolant::places(c, r)) {
      std::optional<FourierSeries> q = at.fine(x);
      if (!q) return best;
      fine.push_back(*std::move(q));
    }
    const ResponseInterpolant response(c, r, fine);
    if (const std::optional<double> pole = response.pole()) {
      const double moved = std::abs(*pole - last_pole) + pole_rounding * std::abs(c);
      if (moved <= tolerance * std::abs(c)) return ResponsePeak{*pole, HUGE_VAL, moved, true};
      const double room = 0.1 * std::min(*pole - top.a, top.b - *pole),
                   nearest = std::min(pole_distance * std::abs(c), room);
      if (moved < std::min(near_pole * r, room))
        if (const auto found = locate_pole(at.fine, *pole, std::max(moved, nearest), nearest, tolerance)) return found;
      if (std::isfinite(moved) && moved > 0.5 * r) return best;  // a guess of the fit
      last_pole = *pole;
      r = std::clamp(3 * moved, 0.03 * r, r);
      c = *pole + beside_pole * r;
      continue;
    }
    const std::optional<FourierSeries> at_c = at.sure(c);
    if (!at_c) return best;
    const double error = response.error(*at_c);
    int beside = 0;
    const std::optional<ResponsePeak> found = highest(response, c, r, error, beside);
    if (!found) {
      // Where the interpolant may be trusted the top lies on that side.
      if (!(error < 0.1 * std::abs(height(response(c + r)) - height(response(c - r))))) return best;
      c += beside * r;
      continue;
    }
    if (best && found->error >= best->error) return best;
    best = *found;
    best->converged = best->error <= tolerance * std::abs(best->x);
    if (best->converged) return best;
    c = found->x;
    r = response.better_radius(error, *at_c);
  }
  return best;
}

}  // namespace

std::optional<ResponsePeak> locate_peak(const PeakResponses& responses, double low, double inside, double high,
                                        double tolerance) {
  const std::optional<double> g_low = flattened_at(responses.rough, low),
                              g_inside = flattened_at(responses.rough, inside),
                              g_high = flattened_at(responses.rough, high);
  if (!g_low || !g_inside || !g_high) return std::nullopt;
  Bracket top{low, inside, high, *g_low, *g_inside, *g_high, std::nullopt};
  constexpr int most_tries = 8;
  constexpr double narrower = 0.1;
  double most_width = HUGE_VAL;
  std::optional<ResponsePeak> best;
  for (int attempt = 0; attempt < most_tries; ++attempt) {
    if (!top.narrow(responses, most_width, tolerance)) return std::nullopt;
    if (top.pole) return top.pole;
    const std::optional<ResponsePeak> found = interpolate_top(responses, top, tolerance);
    if (found && found->converged) return found;
    const double half = 0.5 * (top.b - top.a);
    if (found && found->error < half && (!best || found->error < best->error)) best = found;
    if (half <= tolerance * std::abs(top.x) || top.ended) break;
    most_width = 2 * narrower * half;
  }
  return best ? best : ResponsePeak{top.x, 1 / std::sqrt(top.gx), std::max(top.x - top.a, top.b - top.x), false};
}

}  // namespace hb
