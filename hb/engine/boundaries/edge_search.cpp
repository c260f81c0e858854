#include "hb/engine/boundaries/edge_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hb {

StabilityOptions rough_exponents(StabilityOptions options) {
  constexpr double rough_tolerance = 1e-9;
  options.tolerance = std::max(options.tolerance, rough_tolerance);
  return options;
}

EdgeSearch::EdgeSearch(const SweepOptions& options, int num_modes)
    : options_(options), located_(options), num_modes_(num_modes) {
  options_.stability = rough_exponents(options.stability);
  options_.stability.leading_only = located_.stability.leading_only = true;
}

std::vector<StabilityBoundary> EdgeSearch::boundaries(const SystemAt& along, const StabilitySample& a,
                                                      const StabilitySample& b) const {
  const auto tracks = track_modes({{a.x, a.speed, &a.stability}, {b.x, b.speed, &b.stability}}, num_modes_);
  const Tracked first{a, tracks[0]}, last{b, tracks[1]};
  std::vector<Tracked> stations = {first};
  for (StabilitySample& s : look_between(along, a, b, tracks[0], tracks[1], options_)) {
    stations.push_back(tracked(std::move(s), first, last));
  }
  if (stations.size() == 1 && !is_unstable(a) && !is_unstable(b)) {
    for (StabilitySample& s : look_at_centres(along, first, last)) {
      stations.push_back(tracked(std::move(s), first, last));
    }
  }
  stations.push_back(last);
  // Two tongues side by side leave a gap of the first verdict.
  for (std::size_t k = 1; stations.size() > 3 && k + 2 < stations.size(); ++k) {
    const Tracked &p = stations[k], &q = stations[k + 1];
    if (!(p.sample.x < q.sample.x)) continue;
    std::vector<StabilitySample> gap = look_between(along, p.sample, q.sample, p.modes, q.modes, options_);
    if (gap.empty()) continue;
    stations.insert(stations.begin() + static_cast<std::ptrdiff_t>(k) + 1, tracked(std::move(gap.front()), p, q));
    ++k;
  }
  std::vector<StabilityBoundary> result;
  for (std::size_t k = 0; k + 1 < stations.size(); ++k) {
    const Tracked &p = stations[k], &q = stations[k + 1];
    if (is_unstable(p.sample) == is_unstable(q.sample)) continue;
    const StabilityBoundary boundary = located(along, p.sample, q.sample);
    if (stations.size() > 2) {
      result.push_back(boundary);
      continue;
    }
    // The stable part up to the boundary may hold a further tongue.
    const bool rising = is_unstable(q.sample);
    const Tracked& stable = rising ? p : q;
    const double room = boundary.x - stable.sample.x;
    const double near = boundary.x - std::copysign(std::max(4 * boundary.error, 1e-9 * std::abs(room)), room);
    std::vector<StabilityBoundary> further;
    if (std::abs(room) > 1e-3 * std::abs(b.x - a.x)) {
      if (std::optional<StabilitySample> s = stability_sample(along, near, options_.stability); s && !is_unstable(*s)) {
        const Tracked edge = tracked(std::move(*s), p, q);
        const Tracked &low = rising ? stable : edge, &high = rising ? edge : stable;
        const StabilitySample* before = &low.sample;
        std::vector<StabilitySample> peaks =
            look_between(along, low.sample, high.sample, low.modes, high.modes, options_);
        peaks.push_back(high.sample);
        for (const StabilitySample& peak : peaks) {
          if (is_unstable(*before) != is_unstable(peak)) {
            further.push_back(located(along, *before, peak));
          }
          before = &peak;
        }
      }
    }
    if (rising) {
      result = std::move(further);
      result.push_back(boundary);
    } else {
      result.push_back(boundary);
      result.insert(result.end(), further.begin(), further.end());
    }
  }
  return result;
}

StabilityBoundary EdgeSearch::located(const SystemAt& along, const StabilitySample& p, const StabilitySample& q) const {
  StabilityBoundary boundary = locate_boundary(along, p, q, located_);
  // At the boundary itself rounding may hide that the exponent is locked: a little inside it shows.
  const StabilitySample& unstable = is_unstable(p) ? p : q;
  if (boundary.kind == BoundaryKind::complex) {
    const double room = unstable.x - boundary.x;
    for (const double away : {1e-6, 1e-5, 1e-4}) {
      const double step = std::min(std::abs(room), away * std::max(std::abs(p.x), std::abs(q.x)));
      const std::optional<StabilitySample> inside =
          stability_sample(along, boundary.x + std::copysign(step, room), options_.stability);
      if (!inside || !is_unstable(*inside) || !leading_resolved(inside->stability)) continue;
      boundary.kind = boundary_kind(inside->stability, inside->speed);
      break;
    }
    // One oscillator leaves at +1 or -1 only.
    if (num_modes_ == 1) boundary.kind = boundary_kind(unstable.stability, unstable.speed);
  }
  return boundary;
}

// An exponent does not tell the side of the resonance k Omega = 2 omega on which it lies: omega and k Omega - omega
// fold to one number. Its distance d from k Omega/2 does not need the side: beside a tongue of centre x0 and
// half-width w, d^2 = c^2 ((x - x0)^2 - w^2), a parabola whose vertex is the centre.
std::optional<StabilitySample> EdgeSearch::at_centre(const SystemAt& along, const Tracked& a, const Tracked& b,
                                                     std::size_t mode, double k) const {
  const auto squared = [&](const StabilitySample& s) {
    double nearest = HUGE_VAL;
    for (const Exponent& e : s.stability.exponents) {
      if (e.mode != static_cast<int>(mode)) continue;
      const double turn = std::abs(e.value.imag()) / s.speed - 0.5 * k;
      nearest = std::min(nearest, std::abs(turn - std::round(turn)));
    }
    return nearest * nearest;
  };
  struct Point {
    double x, f;
  };
  std::array<Point, 3> best = {Point{a.sample.x, squared(a.sample)}, Point{b.sample.x, squared(b.sample)}, {}};
  const double low = a.sample.x, high = b.sample.x;
  const double p = std::sqrt(best[0].f), q = std::sqrt(best[1].f);
  double x = low + (high - low) * p / (p + q);
  constexpr int most = 24;
  int failures = 0;
  double last = std::min(best[0].f, best[1].f);
  for (int step = 0; step < most; ++step) {
    if (!(x > low && x < high)) return std::nullopt;
    std::optional<StabilitySample> s = stability_sample(along, x, options_.stability);
    if (!s) return std::nullopt;
    if (is_unstable(*s)) return s;
    const double f = squared(*s);
    // Locked but stable: damping wins. No closer, more than once: no resonance here.
    if (!(f > 1e-24) || (!(f < 0.5 * last) && ++failures == 3)) return std::nullopt;
    last = std::min(f, last);
    (step == 0 ? best[2] : *std::max_element(best.begin(), best.end(), [](const Point& u, const Point& v) {
      return u.f < v.f;
    })) = {x, f};
    const auto& [u, v, w] = best;
    const double uv = (u.f - v.f) / (u.x - v.x), vw = (v.f - w.f) / (v.x - w.x), c = (uv - vw) / (u.x - w.x);
    x = 0.5 * (u.x + v.x - uv / c);
    if (!(c > 0)) return std::nullopt;
  }
  return std::nullopt;
}

// Tongues of single modes between two stable ends, beside what look_between finds.
std::vector<StabilitySample> EdgeSearch::look_at_centres(const SystemAt& along, const Tracked& a,
                                                         const Tracked& b) const {
  std::vector<StabilitySample> found;
  ResonanceStrength strength(along, a.sample.x, b.sample.x, options_.max_order);
  for (std::size_t m = 0; m < a.modes.size(); ++m) {
    const double p = 2 * a.modes[m].frequency / a.sample.speed, q = 2 * b.modes[m].frequency / b.sample.speed;
    if (!(std::abs(p - q) < 8)) continue;
    // The side may be mistaken near a line: lines a little beyond the ends count.
    constexpr double slack = 0.35;
    for (double k = std::max(1.0, std::ceil(std::min(p, q) - slack));
         k <= std::min<double>(std::max(p, q) + slack, options_.max_order); ++k) {
      const double needed = std::max(std::sqrt(std::abs(a.modes[m].damping() * b.modes[m].damping())),
                                     options_.least_growth * a.sample.speed);
      if (!(strength(m, m, k) >= needed)) continue;
      if (std::optional<StabilitySample> s = at_centre(along, a, b, m, k)) found.push_back(std::move(*s));
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const StabilitySample& u, const StabilitySample& v) { return u.x < v.x; });
  return found;
}

EdgeSearch::Tracked EdgeSearch::tracked(StabilitySample sample, const Tracked& p, const Tracked& q) {
  const double fraction = (sample.x - p.sample.x) / (q.sample.x - p.sample.x);
  std::vector<ModeState> modes =
      modes_by_continuity(sample.stability, sample.speed, interpolated(p.modes, q.modes, fraction));
  return {std::move(sample), std::move(modes)};
}

}  // namespace hb
