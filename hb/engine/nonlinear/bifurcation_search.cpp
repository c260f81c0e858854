#include "hb/engine/nonlinear/bifurcation_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace hb::nonlinear {

namespace {

enum class Kind { plus, minus, pair };

// omega of the motion's own period.
double base_frequency(const BranchPoint& point) { return point.motion.speed / point.motion.turns; }

Kind kind_of(const Exponent& exponent, double omega) {
  const double turn = std::abs(exponent.value.imag()) / omega;
  constexpr double real = 1e-12;
  return turn <= real ? Kind::plus : turn >= 0.5 - real ? Kind::minus : Kind::pair;
}

// Real parts of one kind, descending; of a pair one.
std::vector<double> real_parts(const BranchPoint& point, Kind kind) {
  std::vector<double> result;
  if (!point.stability) return result;
  const double omega = base_frequency(point);
  for (const auto* list : {&point.stability->exponents, &point.stability->uncertain})
    for (const Exponent& exponent : *list)
      if (kind_of(exponent, omega) == kind && (kind != Kind::pair || exponent.value.imag() > 0))
        result.push_back(exponent.value.real());
  std::sort(result.begin(), result.end(), std::greater<>());
  return result;
}

struct Crossing {
  BranchPoint point;
  double parameter_error = HUGE_VAL;
};

// Zero of a function of the point that has different signs at a and b, by the Illinois variant of the secant rule
// (M. Dowell, P. Jarratt, BIT 11 (1971) 168, doi:10.1007/BF01934364), until `error`, how far the parameter of a point
// is from that of the zero, is within the tolerance.
std::optional<Crossing> locate(BranchTracer& tracer, const BranchPoint& a, const BranchPoint& b, bool with_exponents,
                               const std::function<double(const BranchPoint&)>& value, double tolerance,
                               const std::function<double(const BranchPoint&, double slope, double width)>& error) {
  double low = a.arc, high = b.arc, at_low = value(a), at_high = value(b);
  Unknowns direction = combination(1, tangent_of(a), 1, tangent_of(b));
  std::optional<Crossing> best;
  int side = 0;
  constexpr int most_steps = 60;
  for (int step = 0; step < most_steps && high - low > 1e-14 * (1 + high); ++step) {
    double s = (low * at_high - high * at_low) / (at_high - at_low);
    const double width = high - low;
    if (!(s > low && s < high) || step % 8 == 7) s = low + width / 2;
    Trace trace = tracer.trace(between(a, b, s - a.arc), direction, false, with_exponents);
    if (trace.status != CorrectionStatus::converged || (with_exponents && !trace.point.stability)) return best;
    trace.point.arc = s;
    const double now = value(trace.point);
    if (std::isnan(now)) return best;
    const double slope = (at_high - at_low) / width;
    const bool lower = (now < 0) == (at_low < 0);
    (lower ? low : high) = s;
    const double estimate = error(trace.point, slope, std::min(high - low, std::abs(now / slope)));
    if (!best || estimate < best->parameter_error) best = Crossing{trace.point, estimate};
    if (estimate <= tolerance || now == 0) break;
    if (lower) {
      at_low = now;
      if (side == -1) at_high /= 2;
      side = -1;
    } else {
      at_high = now;
      if (side == 1) at_low /= 2;
      side = 1;
    }
  }
  return best;
}

// p turns: dp/ds = 0 there, and a point beside it is off by (dp/ds)^2/(2 d2p/ds2).
std::optional<Crossing> locate_fold(BranchTracer& tracer, const BranchPoint& a, const BranchPoint& b,
                                    double tolerance) {
  return locate(
      tracer, a, b, false, [](const BranchPoint& point) { return point.parameter_tangent; }, tolerance,
      [](const BranchPoint& point, double slope, double) {
        const double t = point.parameter_tangent;
        return t * t / std::abs(slope);
      });
}

// The exponent that is `rank`-th of its kind from the right passes the axis. Where there are fewer of the kind, the one
// asked for counts as stable: the search then ends where two of them meet and turn into another kind, which is no
// bifurcation.
std::optional<Crossing> locate_exponent(BranchTracer& tracer, const BranchPoint& a, const BranchPoint& b, Kind kind,
                                        std::size_t rank, double tolerance) {
  const auto value = [=](const BranchPoint& point) {
    const std::vector<double> parts = real_parts(point, kind);
    return rank < parts.size() ? parts[rank] : -1e-2 * base_frequency(point);
  };
  const auto bar = [](const BranchPoint& point) {
    const double error = point.stability->growth_error;
    return std::isfinite(error) ? error : 0;
  };
  std::optional<Crossing> crossing =
      locate(tracer, a, b, true, value, tolerance, [&](const BranchPoint& point, double slope, double width) {
        return std::abs(point.parameter_tangent) * (width + bar(point) / std::abs(slope));
      });
  if (!crossing) return std::nullopt;
  constexpr double passed = 1e-3;
  const double left = std::abs(value(crossing->point));
  const bool passes = left <= passed * std::max(std::abs(value(a)), std::abs(value(b))) + bar(crossing->point);
  return passes ? crossing : std::nullopt;
}

}  // namespace

std::optional<UnstableCount> unstable_count(const BranchPoint& point) {
  if (!point.stability || !std::isfinite(point.stability->growth_rate)) return std::nullopt;
  const double omega = base_frequency(point);
  UnstableCount count;
  for (const auto* list : {&point.stability->exponents, &point.stability->uncertain})
    for (const Exponent& exponent : *list) {
      const double growth = exponent.value.real();
      if (!(std::abs(growth) > exponent.error)) return std::nullopt;
      if (growth < 0) continue;
      switch (kind_of(exponent, omega)) {
        case Kind::plus:
          ++count.plus;
          break;
        case Kind::minus:
          ++count.minus;
          break;
        case Kind::pair:
          if (exponent.value.imag() > 0) ++count.pairs;
          break;
      }
    }
  return count;
}

std::vector<Bifurcation> bifurcations_between(BranchTracer& tracer, const BranchPoint& a, const BranchPoint& b,
                                              double tolerance) {
  std::vector<Bifurcation> found;
  const double allowed = tolerance * std::max(std::abs(a.motion.parameter), std::abs(b.motion.parameter));
  const auto add = [&](BifurcationKind kind, std::optional<Crossing> crossing) {
    if (crossing)
      found.push_back(
          {kind, crossing->parameter_error + crossing->point.motion.parameter_error, std::move(crossing->point), 0});
  };
  const bool fold = (a.parameter_tangent < 0) != (b.parameter_tangent < 0);
  if (fold) add(BifurcationKind::fold, locate_fold(tracer, a, b, allowed));
  const auto before = unstable_count(a), after = unstable_count(b);
  if (before && after) {
    const auto exponent = [&](Kind kind, BifurcationKind name, int from, int to) {
      for (int rank = std::min(from, to); rank < std::max(from, to); ++rank)
        add(name, locate_exponent(tracer, a, b, kind, std::size_t(rank), allowed));
    };
    // At a fold one multiplier passes +1 anyway.
    if (!fold) exponent(Kind::plus, BifurcationKind::branch_point, before->plus, after->plus);
    exponent(Kind::minus, BifurcationKind::period_doubling, before->minus, after->minus);
    exponent(Kind::pair, BifurcationKind::neimark_sacker, before->pairs, after->pairs);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Bifurcation& x, const Bifurcation& y) { return x.point.arc < y.point.arc; });
  return found;
}

}  // namespace hb::nonlinear
