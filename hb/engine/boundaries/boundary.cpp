#include "hb/engine/boundaries/boundary.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/boundaries/finite_growth.hpp"

namespace hb {

namespace {

// What is promised of a boundary, relative; the bracket goes below it.
constexpr double boundary_tolerance = 1e-10;

// Of both lists; null if there is none.
const Exponent* leading_exponent(const Stability& stability) {
  const Exponent* leading = nullptr;
  for (const std::vector<Exponent>* list : {&stability.exponents, &stability.uncertain})
    if (!list->empty() && (!leading || list->front().value.real() > leading->value.real())) leading = &list->front();
  return leading;
}

}  // namespace

bool leading_resolved(const Stability& stability) {
  const Exponent* leading = leading_exponent(stability);
  if (!leading || !(leading->value.real() >= stability.growth_rate - stability.growth_error)) return false;
  if (leading == stability.exponents.data()) return true;
  // A real multiplier stays real until it meets another one, a complex one complex until it meets its conjugate.
  for (const std::vector<Exponent>* list : {&stability.exponents, &stability.uncertain})
    for (const Exponent& other : *list)
      if (&other != leading && !(std::abs(other.value - leading->value) > 2 * (other.error + leading->error)))
        return false;
  return std::isfinite(leading->error);
}

BoundaryKind boundary_kind(const Stability& stability, double speed) {
  if (!leading_resolved(stability)) return BoundaryKind::complex;
  const double frequency = std::abs(leading_exponent(stability)->value.imag());
  const double slack = 1e-7 * speed;
  if (frequency <= slack) return BoundaryKind::plus_one;
  if (std::abs(frequency - speed / 2) <= slack) return BoundaryKind::minus_one;
  return BoundaryKind::complex;
}

const char* to_string(BoundaryKind kind) {
  switch (kind) {
    case BoundaryKind::plus_one:
      return "+1";
    case BoundaryKind::minus_one:
      return "-1";
    case BoundaryKind::complex:
      return "complex";
  }
  return "";
}

// ITP: I. F. D. Oliveira, R. H. C. Takahashi, ACM Trans. Math. Softw. 47 (2020) 5, doi:10.1145/3423597.
StabilityBoundary locate_boundary(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                                  const SweepOptions& options) {
  double low = a.x, high = b.x;
  const bool unstable_above = is_unstable(b);
  // Where the stable end is certain the sign of the growth rate decides, which is better known than its bound says.
  // Where it is not (no damping), a growth of a tenth of its bar counts: bars are bounds, an order above the error
  // (chosen by experiment).
  const bool by_sign = (unstable_above ? a : b).stability.verdict == Verdict::stable;
  const auto value = [&](const StabilitySample& s) {
    const double growth = s.stability.growth_rate;
    return by_sign || growth > 0.1 * s.stability.growth_error ? growth : std::min(growth, 0.0);
  };
  double f_low = value(a), f_high = value(b);
  StabilityBoundary boundary;
  boundary.unstable_above = unstable_above;
  const auto notice_kind = [&](const StabilitySample& s) {
    if (leading_resolved(s.stability)) boundary.kind = boundary_kind(s.stability, s.speed);
  };
  notice_kind(unstable_above ? b : a);
  const double wanted = options.tolerance * std::max(std::abs(low), std::abs(high));
  // The boundary is no better known than the growth rate; where its sign decides its verdict may stay open.
  StabilityOptions sharp = options.stability;
  sharp.tolerance = std::min(sharp.tolerance, 0.1 * boundary_tolerance);
  sharp.growth_suffices = by_sign;
  const double kappa1 = 0.2 / (high - low);
  const int half = static_cast<int>(std::ceil(std::log2((high - low) / (2 * wanted))));
  const int most = std::max(half, 0) + 1;
  // Nearest certain growth rates on both sides: how an error of the growth rate moves the boundary.
  double certain_low = low, certain_high = high, g_low = f_low, g_high = f_high, growth_error = 0;
  double largest_error = 0;  // of growth rates that are not certain
  for (int step = 0; step <= most && high - low > 2 * wanted; ++step) {
    const double middle = 0.5 * (low + high);
    const double radius = std::max(0.0, wanted * std::exp2(most - step) - 0.5 * (high - low));
    const double delta = kappa1 * (high - low) * (high - low);
    double x = middle;
    if (f_low != f_high) {
      const double secant = (f_high * low - f_low * high) / (f_high - f_low);
      const double sign = middle > secant ? 1 : middle < secant ? -1 : 0;
      const double truncated = delta <= std::abs(middle - secant) ? secant + sign * delta : middle;
      x = std::abs(truncated - middle) <= radius ? truncated : middle - sign * radius;
    }
    if (!(x > low && x < high)) x = middle;
    if (!(x > low && x < high)) break;
    const std::optional<ScaledSystem> system = at(x);
    if (!system) break;
    const StabilitySample sample{x, system->speed, with_finite_growth(*system, sharp)};
    if (!std::isfinite(sample.stability.growth_rate)) break;
    const double f = value(sample);
    const bool above = (f > 0) == unstable_above;  // x lies on b's side
    (above ? high : low) = x;
    (above ? f_high : f_low) = f;
    if (f > 0) notice_kind(sample);
    growth_error = sample.stability.growth_error;
    if (std::abs(f) > 4 * growth_error) {
      (above ? certain_high : certain_low) = x;
      (above ? g_high : g_low) = f;
    } else {
      largest_error = std::max(largest_error, growth_error);
    }
  }
  boundary.x = 0.5 * (low + high);
  boundary.error = 0.5 * (high - low);
  const double slope = std::abs((g_high - g_low) / (certain_high - certain_low));
  if (by_sign && slope > 0) boundary.error += std::min(growth_error / slope, certain_high - certain_low);
  // Without damping growth begins like the root of the distance: what is below its error e reaches (e/g)^2 of the way
  // from the boundary to where it is g.
  if (const double g = unstable_above ? g_high : g_low; !by_sign && g > 0) {
    const double certain = unstable_above ? certain_high : certain_low, part = std::min(5 * largest_error / g, 1.0);
    boundary.error += part * part * std::abs(certain - boundary.x);
  }
  boundary.converged = boundary.error <= boundary_tolerance * std::max(std::abs(low), std::abs(high));
  return boundary;
}

}  // namespace hb
