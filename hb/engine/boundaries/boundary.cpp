#include "hb/engine/boundaries/boundary.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/boundaries/boundary_location.hpp"
#include "hb/engine/boundaries/finite_growth.hpp"
#include "hb/engine/boundaries/leading_pair.hpp"
#include "hb/engine/boundaries/strands.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

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

namespace {

// Narrows down where the verdict changes between a and b.
class Location {
 public:
  Location(const SystemAt& at, const StabilitySample& a, const StabilitySample& b, const SweepOptions& options)
      : at_(at), low_(a.x), high_(b.x), sharp_(options.stability), rough_(options.stability) {
    found_.boundary.unstable_above = is_unstable(b);
    const StabilitySample &stable = is_unstable(b) ? a : b, &unstable = is_unstable(b) ? b : a;
    by_sign_ = stable.stability.verdict == Verdict::stable;
    lock_ = lock_of(unstable);
    settled_ = stable.stability.verdict == Verdict::undecided ? nan : stable.x;
    whole_ = b.x - a.x;
    const double size = std::max(std::abs(low_), std::abs(high_));
    wanted_ = options.tolerance * size;
    promised_ = std::max(promised_of_boundaries, options.tolerance) * size;
    // The boundary is no better known than the growth rate; where its sign decides its verdict may stay open.
    sharp_.tolerance = std::min(sharp_.tolerance, 0.1 * promised_of_boundaries);
    sharp_.growth_suffices = by_sign_;
    constexpr double rough = 1e-9;
    rough_.tolerance = std::max(rough_.tolerance, rough);
    rough_.growth_suffices = rough_.as_found = true;
    notice_kind(unstable);
    parabolic_ = true;
    parabolic_ = !by_sign_ || lock_ != 0 || value(unstable) != growth(unstable);
    f_low_ = value(a);
    f_high_ = value(b);
    certain_low_ = low_;
    certain_high_ = high_;
    g_low_ = growth(a);
    g_high_ = growth(b);
  }

  BoundaryLocation run(std::optional<std::array<double, 2>> expected) {
    for (int k = 0; expected && k < 2; ++k)
      if (!look((*expected)[static_cast<std::size_t>(k)])) break;
    const int half = static_cast<int>(std::ceil(std::log2((high_ - low_) / (2 * wanted_))));
    const int most = std::max(half, 0) + 1;
    kappa1_ = 0.2 / (high_ - low_);
    for (int step = 0; step <= most && high_ - low_ > 2 * wanted_; ++step)
      if (!look(next(wanted_ * std::exp2(most - step)))) break;
    set_error();
    for (const double away : {wanted_, 0.5 * promised_})
      if (!by_sign_ && found_.boundary.error > 2 * away) confirm(away);
    return found_;
  }

 private:
  // Where the stable end is certain the sign of the growth rate decides, which is better known than its bound says.
  // Where it is not (no damping), a growth of a tenth of its bar counts: bars are bounds, an order above the error
  // (chosen by experiment).
  double growth(const StabilitySample& s) const {
    const double growth = s.stability.growth_rate;
    return by_sign_ || growth > 0.1 * s.stability.growth_error ? growth : std::min(growth, 0.0);
  }

  // Of the growth's sign; where two lock or collide analytic in x, whether they are locked or apart: without damping Q
  // of (B2), with damping |c| - cosh 2 pi m of (B11), hb/engine/README.md.
  double value(const StabilitySample& s) const {
    const double g = growth(s);
    if (!parabolic_) return g;
    if (!by_sign_ && g > 0) return std::pow(g / s.speed, 2);
    const auto [apart, mean] = nearest_pair(s);
    if (by_sign_ && lock_ == 0) return off_locks(apart, mean, g);
    if (!by_sign_) return -0.25 * apart.imag() * apart.imag();
    const double beyond = std::cosh(pi * apart.real()) * std::cos(pi * apart.imag()) - std::cosh(two_pi * mean);
    return std::isfinite(beyond) && (beyond > 0) == (g > 0) ? beyond : g;
  }

  // Two that meet off the locks: with Q = ((s_1 - s_2)/2)^2 of (B2) and m < 0 their mean growth m + Re sqrt(Q) is zero,
  // and has the sign of
  //     Re Q - m^2 + (Im Q)^2/(4 m^2) = (r^2 - m^2)(1 + y^2/m^2),      sqrt(Q) = r + i y,
  // which is analytic in x. One that grows by itself: its growth.
  static double off_locks(std::complex<double> apart, double m, double g) {
    const std::complex<double> Q = 0.25 * apart * apart;
    const double shared = std::pow(Q.imag() / (2 * m), 2), f = Q.real() - m * m + shared;
    const bool tells = m < 0 && shared <= std::abs(Q.real()) + m * m && (f > 0) == (g > 0);
    return tells ? f : g;
  }

  // The two that may lock are near each other, and their mean is near the lock: s_1 - s_2 and the mean of their growth.
  std::pair<std::complex<double>, double> nearest_pair(const StabilitySample& s) const {
    std::vector<std::complex<double>> away;
    for (const std::vector<Exponent>* list : {&s.stability.exponents, &s.stability.uncertain})
      for (const Exponent& e : *list)
        away.emplace_back(e.value.real() / s.speed, folded((e.value - locked_) / s.speed).imag());
    std::pair<std::complex<double>, double> pair = {0, 0};
    double least = HUGE_VAL;
    for (std::size_t a = 0; a < away.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const double half = 0.5 * std::abs((away[a] - away[b]).imag()),
                     off = 0.5 * std::abs((away[a] + away[b]).imag());
        if (const double far = off + 0.25 * half; far < least) {
          least = far;
          pair = {away[a] - away[b], 0.5 * (away[a] + away[b]).real()};
        }
      }
    return pair;
  }

  // ITP: I. F. D. Oliveira, R. H. C. Takahashi, ACM Trans. Math. Softw. 47 (2020) 5, doi:10.1145/3423597.
  double next(double reach) {
    const double middle = 0.5 * (low_ + high_), width = high_ - low_;
    const double radius = std::max(0.0, reach - 0.5 * width);
    double x = middle;
    if (f_low_ != f_high_) {
      const auto [zero, error] = interpolated();
      // Beyond the zero by more than it is wrong, so that it is bracketed from both sides.
      const double delta = std::max(0.7 * wanted_, std::min(kappa1_ * width * width, 0.1 * error));
      const double sign = middle > zero ? 1 : middle < zero ? -1 : 0;
      const double truncated = delta <= std::abs(middle - zero) ? zero + sign * delta : middle;
      x = std::abs(truncated - middle) <= radius ? truncated : middle - sign * radius;
    }
    return x > low_ && x < high_ ? x : middle;
  }

  // Where the value is zero: x as a parabola of it through both ends and the one before, where they ascend or descend,
  // with its distance from the secant's zero; else that.
  std::pair<double, double> interpolated() {
    const double secant = (f_high_ * low_ - f_low_ * high_) / (f_high_ - f_low_);
    if (parabolic_) return by_parabola(secant);
    const double before = (f_before_ - f_low_) / (f_high_ - f_low_);
    const bool monotonic = before_ < low_ ? before < 0 : before_ > high_ && before > 1;
    if (!monotonic) return {secant, HUGE_VAL};
    const double a = (high_ - low_) / (f_high_ - f_low_), b = (before_ - high_) / (f_before_ - f_high_);
    const double x = low_ - a * f_low_ + (b - a) / (f_before_ - f_low_) * f_low_ * f_high_;
    if (!(x > low_ && x < high_)) return {secant, HUGE_VAL};
    return {x, std::abs(x - secant)};
  }

  // Without damping one end may be the middle of a narrow band: as if Q were largest there. The zero, and a twentieth
  // of its distance from there.
  std::pair<double, double> from_vertex() const {
    const bool low_is_vertex = f_low_ > 0;
    const double f = low_is_vertex ? f_low_ : f_high_, far = low_is_vertex ? f_high_ : f_low_;
    const double vertex = low_is_vertex ? low_ : high_, other = low_is_vertex ? high_ : low_;
    const double away = std::sqrt(f / (f - far)) * (other - vertex);
    return {vertex + away, 0.05 * std::abs(away)};
  }

  // Q is nearly a parabola of x: its zero between the ends, with the distance from the one before.
  std::pair<double, double> by_parabola(double secant) {
    constexpr double narrow = 0.1;
    if (std::isnan(before_) && !by_sign_ && std::max(f_low_, f_high_) < -narrow * std::min(f_low_, f_high_)) {
      const std::pair<double, double> zero = from_vertex();
      expected_zero_ = zero.first;
      return zero;
    }
    const double slope = (f_high_ - f_low_) / (high_ - low_);
    const double bend = ((f_before_ - f_high_) / (before_ - high_) - slope) / (before_ - low_);
    // f_low + (x - low) (slope + bend (x - high)) = 0, x = low + t
    const double b = slope - bend * (high_ - low_), root = std::sqrt(b * b - 4 * bend * f_low_);
    double zero = secant;
    for (const double t : {-2 * f_low_ / (b + root), -2 * f_low_ / (b - root)})
      if (t > 0 && t < high_ - low_) zero = low_ + t;
    const double moved = std::abs(zero - (std::isnan(expected_zero_) ? secant : expected_zero_));
    expected_zero_ = zero;
    return {zero, moved};
  }

  // Growth per x between the nearest places on both sides where it is certain.
  double slope() const { return std::abs((g_high_ - g_low_) / (certain_high_ - certain_low_)); }

  // First roughly. That suffices far from the boundary, and where the error moves it by less than is promised.
  std::optional<StabilitySample> sample_at(double x) const {
    constexpr double far = 30;
    const std::optional<ScaledSystem> system = at_(x);
    if (!system) return std::nullopt;
    if (by_sign_) {
      const StabilitySample sample{x, system->speed, with_finite_growth(*system, rough_)};
      const double error = sample.stability.growth_error;
      if (std::abs(sample.stability.growth_rate) > far * error || error <= 0.25 * promised_ * slope()) return sample;
    }
    return StabilitySample{x, system->speed, with_finite_growth(*system, sharp_)};
  }

  void notice_kind(const StabilitySample& s) {
    if (const Exponent* leading = leading_exponent(s.stability)) locked_ = leading->value;
    if (leading_resolved(s.stability)) found_.boundary.kind = boundary_kind(s.stability, s.speed);
  }

  // False if there is no answer at x.
  bool look(double x) {
    if (!(x > low_ && x < high_)) return false;
    const std::optional<StabilitySample> sample = sample_at(x);
    if (!sample || !std::isfinite(sample->stability.growth_rate)) return false;
    narrow(*sample);
    return true;
  }

  void narrow(const StabilitySample& sample) {
    const double f = value(sample), g = growth(sample);
    const bool above = (f > 0) == found_.boundary.unstable_above;  // x lies on b's side
    before_ = above ? high_ : low_;
    f_before_ = above ? f_high_ : f_low_;
    (above ? high_ : low_) = sample.x;
    (above ? f_high_ : f_low_) = f;
    if (f > 0) notice_kind(sample);
    growth_error_ = std::max(sample.stability.growth_error, largest_error_);
    if (std::abs(g) > 4 * sample.stability.growth_error) {
      (above ? certain_high_ : certain_low_) = sample.x;
      (above ? g_high_ : g_low_) = g;
      (above ? found_.above : found_.below) = sample;
    } else {
      largest_error_ = growth_error_;
    }
    if (sample.stability.verdict == Verdict::bounded && above != found_.boundary.unstable_above) {
      settled_ = sample.x;
      (above ? found_.above : found_.below) = sample;
    }
  }

  // Looks at both sides of the boundary for places with sure verdicts.
  void confirm(double away) {
    const double x = found_.boundary.x;
    for (const double side : {-1.0, 1.0}) {
      const bool unstable = found_.boundary.unstable_above == (side > 0);
      const double sure = !unstable ? settled_ : side > 0 ? certain_high_ : certain_low_;
      if (std::abs(sure - x) <= away) continue;
      const std::optional<StabilitySample> sample = sample_at(x + side * away);
      if (!sample || !std::isfinite(sample->stability.growth_rate)) return;
      if (unstable && sample->stability.growth_rate > 4 * sample->stability.growth_error) {
        (side > 0 ? certain_high_ : certain_low_) = sample->x;
        (side > 0 ? g_high_ : g_low_) = growth(*sample);
      }
      if (!unstable && sample->stability.verdict == Verdict::bounded) settled_ = sample->x;
    }
    set_error();
  }

  // Without damping growth begins like the root of the distance: what is below its error e reaches (e/g)^2 of the way
  // from the boundary to where it is g. An error as large as g leaves open all between places with sure verdicts.
  double beyond_growth() const {
    const bool above = found_.boundary.unstable_above;
    const double g = above ? g_high_ : g_low_;
    if (!(g > 0)) return 0;
    const double x = found_.boundary.x, grown = std::abs((above ? certain_high_ : certain_low_) - x);
    const double part = std::pow(5 * largest_error_ / g, 2), between = std::max(grown, std::abs(settled_ - x));
    return part < 0.5 ? std::min(part / (1 - part) * grown, between) : between;
  }

  void set_error() {
    found_.boundary.x = 0.5 * (low_ + high_);
    found_.boundary.error = 0.5 * (high_ - low_);
    const bool known = slope() > 0;
    if (by_sign_ && known) found_.boundary.error += std::min(growth_error_ / slope(), certain_high_ - certain_low_);
    if (!by_sign_) found_.boundary.error += std::isnan(settled_) ? whole_ : beyond_growth();
    found_.boundary.converged =
        found_.boundary.error <= promised_of_boundaries * std::max(std::abs(low_), std::abs(high_));
  }

  const SystemAt& at_;
  double low_, high_, f_low_ = 0, f_high_ = 0;
  double before_ = nan, f_before_ = 0;  // the end that was left last
  StabilityOptions sharp_, rough_;
  bool by_sign_ = false;
  double lock_ = 0;  // sign of the multipliers that leave, 0: complex ones
  bool parabolic_ = false;  // two that meet tell where to look, not a single one
  double expected_zero_ = nan;  // as Q foretold it last
  std::complex<double> locked_;  // leading exponent of the nearest place where it grows
  double wanted_ = 0, promised_ = 0;  // half of the bracket; error of the boundary
  double kappa1_ = 0;
  // Nearest certain growth rates on both sides: how an error of the growth rate moves the boundary.
  double certain_low_ = 0, certain_high_ = 0, g_low_ = 0, g_high_ = 0;
  double settled_ = 0;  // without damping: nearest place where it is bounded; NaN: none
  double whole_ = 0;  // distance of the places given
  double growth_error_ = 0;  // of the last growth rate
  double largest_error_ = 0;  // of growth rates that are not certain
  BoundaryLocation found_;
};

}  // namespace

BoundaryLocation locate(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                        const SweepOptions& options, std::optional<std::array<double, 2>> expected) {
  return Location(at, a, b, options).run(expected);
}

StabilityBoundary locate_boundary(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                                  const SweepOptions& options) {
  return locate(at, a, b, options, std::nullopt).boundary;
}

}  // namespace hb
