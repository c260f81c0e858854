#include "tools/attack/true_bands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace hb::attack {

namespace {

using cplx = std::complex<double>;

bool unstable(const Stability& s) { return s.verdict == Verdict::unstable; }
bool decided(const Stability& s) { return s.verdict != Verdict::undecided; }

// Exponents per radian of crank angle.
std::vector<cplx> per_radian(const Stability& stability, double speed) {
  std::vector<cplx> s;
  for (const Exponent& e : stability.exponents) s.push_back(e.value / speed);
  return s;
}

double turn(double angle) { return std::remainder(angle, 1.0); }

// Two exponents that may meet: their mean, and the square of half their difference, which has no branch where they do.
struct Pair {
  cplx mean;
  cplx square;
};
Pair pair_of(cplx a, cplx b) {
  const cplx half(0.5 * (a.real() - b.real()), 0.5 * turn(a.imag() - b.imag()));
  return {b + half, half * half};
}

// Of the exponents the two nearest to `mean` modulo i.
Pair nearest_pair(std::vector<cplx> s, cplx mean) {
  std::partial_sort(s.begin(), s.begin() + 2, s.end(), [&](cplx a, cplx b) {
    const auto distance = [&](cplx z) { return std::hypot(z.real() - mean.real(), turn(z.imag() - mean.imag())); };
    return distance(a) < distance(b);
  });
  return pair_of(s[0], s[1]);
}

// Of b's exponents for each of a's the nearest one, each once.
std::vector<cplx> matched(const std::vector<cplx>& a, std::vector<cplx> b) {
  std::vector<cplx> result;
  for (const cplx s : a) {
    const auto nearest = std::min_element(b.begin(), b.end(), [&](cplx p, cplx q) {
      return std::hypot(p.real() - s.real(), turn(p.imag() - s.imag())) <
             std::hypot(q.real() - s.real(), turn(q.imag() - s.imag()));
    });
    result.push_back(*nearest);
    b.erase(nearest);
  }
  return result;
}

}  // namespace

SingleVerdicts::SingleVerdicts(const std::function<SystemOnLine(double)>& system, double from, double to)
    : system_(system), from_(from), to_(to) {}

const Stability& SingleVerdicts::at(double x) {
  const auto found = known_.find(x);
  if (found != known_.end()) return found->second;
  const SystemOnLine here = system_(x);
  return known_.emplace(x, analyse_stability(here.system, here.speed, {.tolerance = 1e-10})).first->second;
}

// Where the phases of two exponents pass each other between a and b the square of half their difference is nearly a
// parabola: three points give its top.
void SingleVerdicts::follow_meetings(double a, double b) {
  const std::vector<cplx> at_a = per_radian(at(a), speed(a)), all_b = per_radian(at(b), speed(b));
  if (at_a.size() < 2 || all_b.size() != at_a.size()) return;
  const std::vector<cplx> at_b = matched(at_a, all_b);
  constexpr int most_steps = 5;
  for (std::size_t p = 0; p < at_a.size(); ++p)
    for (std::size_t q = 0; q < p; ++q) {
      const double before = turn(at_a[p].imag() - at_a[q].imag()), after = turn(at_b[p].imag() - at_b[q].imag());
      if (!(before * after <= 0) || std::abs(before) + std::abs(after) > 0.3 || before == after) continue;
      const Pair start = pair_of(at_a[p], at_a[q]), end = pair_of(at_b[p], at_b[q]);
      std::array<double, 3> x = {a, b, a + (b - a) * before / (before - after)};
      std::array<double, 3> f = {start.square.real(), end.square.real(), 0};
      for (int step = 0; step < most_steps; ++step) {
        if (!(x[2] > a && x[2] < b)) break;
        const Stability& here = at(x[2]);
        if (unstable(here) || here.exponents.size() != at_a.size()) break;
        const double t = (x[2] - a) / (b - a);
        const cplx moved(end.mean.real() - start.mean.real(), turn(end.mean.imag() - start.mean.imag()));
        f[2] = nearest_pair(per_radian(here, speed(x[2])), start.mean + t * moved).square.real();
        // The parabola through the three, and its top.
        const double u = (f[1] - f[0]) / (x[1] - x[0]), v = (f[2] - f[1]) / (x[2] - x[1]);
        const double curvature = (v - u) / (x[2] - x[0]);
        const double top = 0.5 * (x[0] + x[1]) - u / (2 * curvature);
        if (!std::isfinite(top) || std::abs(top - x[2]) < 1e-12 * x[2]) break;
        const std::size_t drop = f[0] < f[1] ? 0 : 1;
        x[drop] = x[2];
        f[drop] = f[2];
        x[2] = top;
      }
    }
}

// Golden section towards the largest growth between a and b, or the smallest, until the verdict changes.
void SingleVerdicts::follow_growth(double a, double b, bool upward) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  const bool at_start = unstable(at(a));
  const auto height = [&](double x) { return (upward ? 1 : -1) * at(x).growth_rate; };
  double left = b - golden * (b - a), right = a + golden * (b - a);
  for (int step = 0; step < 40 && b - a > 1e-9 * b; ++step) {
    for (const double x : {left, right})
      if (decided(at(x)) && unstable(at(x)) != at_start) return;
    if (height(left) > height(right)) {
      b = right;
      right = left;
      left = b - golden * (b - a);
    } else {
      a = left;
      left = right;
      right = a + golden * (b - a);
    }
    // Nothing to be found where the growth no longer changes.
    if (step > 8 && std::abs(height(left) - height(right)) <= at(left).growth_error + at(right).growth_error) return;
  }
}

void SingleVerdicts::grid(int points) {
  std::vector<double> x;
  for (int k = 0; k <= points; ++k) x.push_back(from_ + (to_ - from_) * k / points);
  for (const double place : x) (void)at(place);
  for (std::size_t k = 0; k + 1 < x.size(); ++k) {
    const bool here = unstable(at(x[k])), next = unstable(at(x[k + 1]));
    if (here != next) continue;
    if (!here) follow_meetings(x[k], x[k + 1]);
    if (k == 0) continue;
    const double before = at(x[k - 1]).growth_rate, middle = at(x[k]).growth_rate, after = at(x[k + 1]).growth_rate;
    const double error = at(x[k]).growth_error;
    if (unstable(at(x[k - 1])) != here) continue;
    if (!here && middle > before + error && middle > after + error) follow_growth(x[k - 1], x[k + 1], true);
    if (here && middle <= before && middle <= after) follow_growth(x[k - 1], x[k + 1], false);
  }
}

std::vector<TrueBand> SingleVerdicts::bands() {
  std::vector<std::pair<double, bool>> points;
  for (const auto& [x, stability] : known_)
    if (decided(stability)) points.emplace_back(x, unstable(stability));
  std::vector<TrueBand> result;
  const auto change = [&](double a, double b) {  // verdicts differ
    const bool at_a = unstable(at(a));
    while (b - a > 1e-11 * b) {
      const double middle = 0.5 * (a + b);
      if (!(middle > a && middle < b) || !decided(at(middle))) break;
      (unstable(at(middle)) == at_a ? a : b) = middle;
    }
    return std::array<double, 2>{a, b};
  };
  bool inside = false;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto [x, grows] = points[k];
    if (grows && !inside) {
      TrueBand band{.from = x, .open_from = k == 0};
      if (k > 0) {
        const auto [a, b] = change(points[k - 1].first, x);
        band.from = 0.5 * (a + b);
        band.error_from = 0.5 * (b - a);
      }
      result.push_back(band);
    }
    if (!grows && inside) {
      const auto [a, b] = change(points[k - 1].first, x);
      result.back().to = 0.5 * (a + b);
      result.back().error_to = 0.5 * (b - a);
    }
    inside = grows;
  }
  if (inside) {
    result.back().to = points.back().first;
    result.back().open_to = true;
  }
  for (TrueBand& band : result)
    for (auto place = known_.lower_bound(band.from); place != known_.end() && place->first <= band.to; ++place)
      if (unstable(place->second) && place->second.growth_low > band.fastest) {
        band.fastest = place->second.growth_low;
        band.fastest_x = place->first;
      }
  return result;
}

}  // namespace hb::attack
