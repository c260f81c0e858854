#include "hb/engine/boundaries/curve_point.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/boundaries/finite_growth.hpp"

namespace hb {

namespace {

struct Vector {
  double x, y;
  Vector operator+(Vector v) const { return {x + v.x, y + v.y}; }
  Vector operator-(Vector v) const { return {x - v.x, y - v.y}; }
  Vector operator*(double s) const { return {x * s, y * s}; }
  double dot(Vector v) const { return x * v.x + y * v.y; }
  double length() const { return std::hypot(x, y); }
};

// Of the circle through p0, p1 and the next point: the directions to and from p1, weighted by the other's length.
std::optional<Vector> tangent(Vector to, Vector from) {
  const double u = to.length(), v = from.length();
  if (!(u > 0 && v > 0) || to.dot(from) <= 0) return std::nullopt;
  const Vector t = to * (v / u) + from * (u / v);
  return t * (1 / t.length());
}

// The middle of the cubic with unit tangents T1, T2 at both ends (hb/engine/README.md, (B8)). An end without a
// tangent has that of a parabola.
Vector middle_of_cubic(const CurveStretch& s, const std::function<Vector(const CurvePoint&)>& scaled) {
  const Vector p1 = scaled(s.a), p2 = scaled(s.b), d = p2 - p1;
  const double length = d.length();
  std::optional<Vector> t1, t2;
  if (s.before) t1 = tangent(p1 - scaled(*s.before), d);
  if (s.after) t2 = tangent(d, scaled(*s.after) - p2);
  const auto mirrored = [&](Vector t) { return d * (2 * t.dot(d) / (length * length)) - t; };
  if (!t1 && !t2) return (p1 + p2) * 0.5;
  if (!t1) t1 = mirrored(*t2);
  if (!t2) t2 = mirrored(*t1);
  return (p1 + p2) * 0.5 + (*t1 - *t2) * (length / 8);
}

// Which side of the stretch is unstable, as its two ends say: 1 left, -1 right, 0 unknown.
int unstable_side(const CurveStretch& s, Vector left) {
  int side = 0;
  for (const CurvePoint* p : {&s.a, &s.b}) {
    const double across = p->place.along_x ? left.x : left.y;
    if (std::abs(across) < 0.1 * left.length()) continue;
    const int here = (across > 0) == p->unstable_above ? 1 : -1;
    if (side != 0 && side != here) return 0;
    side = here;
  }
  return side;
}

}  // namespace

std::optional<CurvePoint> point_between(const MapSystemAt& at, const CurveStretch& s, double wide, double high,
                                        const SweepOptions& options) {
  const auto scaled = [&](const CurvePoint& p) { return Vector{p.place.x / wide, p.place.y / high}; };
  const Vector p1 = scaled(s.a), p2 = scaled(s.b), d = p2 - p1, left{-d.y, d.x};
  const int side = unstable_side(s, left);
  if (side == 0) return std::nullopt;
  const Vector straight = (p1 + p2) * 0.5, curved = middle_of_cubic(s, scaled);
  const bool along_x = std::abs(d.y) >= std::abs(d.x);
  const double low = along_x ? s.low_x : s.low_y, top = along_x ? s.high_x : s.high_y;
  const double fixed =
      along_x ? std::clamp(curved.y * high, std::min(s.a.place.y, s.b.place.y), std::max(s.a.place.y, s.b.place.y))
              : std::clamp(curved.x * wide, std::min(s.a.place.x, s.b.place.x), std::max(s.a.place.x, s.b.place.x));
  const SystemAt along = [&](double t) { return along_x ? at(t, fixed) : at(fixed, t); };
  const auto sample = [&](double t) -> std::optional<StabilitySample> {
    const std::optional<ScaledSystem> system = along(t);
    if (!system) return std::nullopt;
    return StabilitySample{t, system->speed, with_finite_growth(*system, options.stability)};
  };

  // Outward from the expected place to the side that has the other verdict.
  const bool unstable_above = (along_x ? left.x : left.y) * side > 0;
  const double unit = along_x ? wide : high;
  double t = std::clamp((along_x ? curved.x : curved.y) * unit, low, top);
  double step = unit * std::max(0.3 * (curved - straight).length(), 1e-3 * d.length());
  std::optional<StabilitySample> here = sample(t);
  if (!here) return std::nullopt;
  const bool first_unstable = is_unstable(*here);
  const double direction = first_unstable == unstable_above ? -1 : 1;
  for (;; step *= 4) {
    const double next = std::clamp(t + direction * step, low, top);
    if (next == t) return std::nullopt;
    std::optional<StabilitySample> there = sample(next);
    if (!there) return std::nullopt;
    if (is_unstable(*there) != first_unstable) {
      const StabilitySample &a = next < t ? *there : *here, &b = next < t ? *here : *there;
      const StabilityBoundary found = locate_boundary(along, a, b, options);
      const double x = along_x ? found.x : fixed, y = along_x ? fixed : found.x;
      return CurvePoint{{x, y, found.error, along_x}, found.kind, found.unstable_above, found.converged};
    }
    t = next;
    here = std::move(there);
  }
}

}  // namespace hb
