#include "hb/engine/boundaries/curve_point.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/boundaries/finite_growth.hpp"
#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/surface_search.hpp"

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

// The line along which a point is looked for: x or y, whichever is more across the curve.
struct Line {
  bool along_x;
  double fixed, low, top, expected;  // expected: where the curve should cross it
  double step;  // the first one away from there
  bool unstable_above;
  SystemAt at;

  CurvePoint point(const StabilityBoundary& b) const {
    return {{along_x ? b.x : fixed, along_x ? fixed : b.x, b.error, along_x}, b.kind, b.unstable_above, b.converged};
  }
};

// Outward from the expected place to the side that has the other verdict, past places without a sure one.
std::optional<CurvePoint> point_by_verdict(const Line& line, const SweepOptions& options) {
  using Sample = std::optional<StabilitySample>;
  const auto sample = [&](double t) -> Sample {
    const std::optional<ScaledSystem> system = line.at(t);
    if (!system) return std::nullopt;
    return StabilitySample{t, system->speed, with_certain_verdict(*system, options.stability)};
  };
  const auto sure = [](const StabilitySample& s) { return s.stability.verdict != Verdict::undecided; };
  // The first place that is unstable, or not; `before`: the last one before it that surely has the other verdict.
  const auto outward = [&](bool unstable, Sample& before) -> Sample {
    const double direction = unstable == line.unstable_above ? 1 : -1;
    double t = line.expected;
    for (double step = line.step;; step *= 4) {
      const double next = std::clamp(t + direction * step, line.low, line.top);
      if (next == t) return std::nullopt;
      Sample there = sample(next);
      if (!there || (sure(*there) && is_unstable(*there) == unstable)) return there;
      if (sure(*there)) before = std::move(there);
      t = next;
    }
  };
  Sample here = sample(line.expected), nothing;
  if (!here) return std::nullopt;
  const bool first_unstable = is_unstable(*here);
  if (!sure(*here)) here = std::nullopt;
  const Sample there = outward(!first_unstable, here);
  if (there && !here) here = outward(first_unstable, nothing);
  if (!there || !here) return std::nullopt;
  const bool ascending = here->x < there->x;
  return line.point(locate_boundary(line.at, ascending ? *here : *there, ascending ? *there : *here, options));
}

// By the search for bands and gaps that verdicts do not show, near the expected place.
std::optional<CurvePoint> point_by_search(const Line& line, SweepOptions options) {
  options.stability.leading_only = false;
  constexpr double steps = 16;
  const auto a = stability_sample(line.at, std::max(line.low, line.expected - steps * line.step), options.stability);
  const auto b = stability_sample(line.at, std::min(line.top, line.expected + steps * line.step), options.stability);
  if (!a || !b || !(a->x < b->x)) return std::nullopt;
  std::optional<StabilityBoundary> nearest;
  for (const StabilityBoundary& found : search_interval(line.at, *a, *b, nullptr, nullptr, options).boundaries) {
    if (found.unstable_above != line.unstable_above) continue;
    if (!nearest || std::abs(found.x - line.expected) < std::abs(nearest->x - line.expected)) nearest = found;
  }
  if (!nearest) return std::nullopt;
  return line.point(*nearest);
}

// The zero of the surface nearest to the expected place; `open`: it is not known.
std::optional<CurvePoint> point_by_surface(const Line& line, const SweepOptions& options,
                                           const DiscriminantSurface& surface, bool& open) {
  const MapLine whole{line.along_x, line.fixed, line.low, line.top};
  const auto zeros = surface_zeros(surface, whole);
  open = !zeros;
  const SurfaceZero* nearest = nullptr;
  if (zeros)
    for (const SurfaceZero& zero : *zeros) {
      if ((zero.slope > 0) != line.unstable_above) continue;
      if (!nearest || std::abs(zero.place - line.expected) < std::abs(nearest->place - line.expected)) nearest = &zero;
    }
  if (!nearest) return std::nullopt;
  const auto boundary = boundary_at(surface, line.at, whole, *nearest, options.tolerance);
  open = !boundary;
  if (!boundary) return std::nullopt;
  return line.point(*boundary);
}

}  // namespace

std::optional<CurvePoint> point_between(const MapSystemAt& at, const CurveStretch& s, double wide, double high,
                                        const SweepOptions& options, const DiscriminantSurface* surface) {
  const auto scaled = [&](const CurvePoint& p) { return Vector{p.place.x / wide, p.place.y / high}; };
  const Vector p1 = scaled(s.a), p2 = scaled(s.b), d = p2 - p1, left{-d.y, d.x};
  const int side = unstable_side(s, left);
  if (side == 0) return std::nullopt;
  const Vector straight = (p1 + p2) * 0.5, curved = middle_of_cubic(s, scaled);
  const bool along_x = std::abs(d.y) >= std::abs(d.x);
  const double low = along_x ? s.low_x : s.low_y, top = along_x ? s.high_x : s.high_y, unit = along_x ? wide : high;
  const double fixed =
      along_x ? std::clamp(curved.y * high, std::min(s.a.place.y, s.b.place.y), std::max(s.a.place.y, s.b.place.y))
              : std::clamp(curved.x * wide, std::min(s.a.place.x, s.b.place.x), std::max(s.a.place.x, s.b.place.x));
  const Line line{along_x,
                  fixed,
                  low,
                  top,
                  std::clamp((along_x ? curved.x : curved.y) * unit, low, top),
                  unit * std::max(0.3 * (curved - straight).length(), 1e-3 * d.length()),
                  (along_x ? left.x : left.y) * side > 0,
                  [&at, along_x, fixed](double t) { return along_x ? at(t, fixed) : at(fixed, t); }};
  if (surface) {
    bool open = false;
    const std::optional<CurvePoint> point = point_by_surface(line, options, *surface, open);
    if (!open) return point;
  }
  std::optional<CurvePoint> point = point_by_verdict(line, options);
  if (!point && s.crowded) point = point_by_search(line, options);
  return point;
}

std::vector<BoundaryCurve> pieces_of_one_kind(const std::vector<CurvePoint>& points, bool closed) {
  const std::size_t n = points.size() - (closed ? 1 : 0);
  const auto kind = [&](std::size_t k) { return points[k % n].kind; };
  std::size_t start = 0;
  while (closed && start < n && kind(start) == kind(start + n - 1)) ++start;
  if (start == n) start = 0;  // one kind all round
  std::vector<BoundaryCurve> pieces(1);
  for (std::size_t k = start; k < start + n; ++k) {
    if (!pieces.back().points.empty() && kind(k) != pieces.back().kind) pieces.emplace_back();
    pieces.back().kind = kind(k);
    pieces.back().points.push_back(points[k % n].place);
  }
  if (BoundaryCurve& whole = pieces.front(); closed && whole.points.size() == n) {
    whole.closed = true;
    whole.points.push_back(whole.points.front());
  }
  return pieces;
}

}  // namespace hb
