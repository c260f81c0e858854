#include "hb/engine/boundaries/sweep.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

using Eigen::Index;

// What is promised of a boundary, relative; the bracket goes below it.
constexpr double boundary_tolerance = 1e-10;

double scale_of(double a, double b) { return std::max({std::abs(a), std::abs(b), std::abs(b - a)}); }

// Largest real part of the two modes.
double growth_of(const std::vector<ModeState>& modes, std::size_t i, std::size_t j) {
  return std::max(modes[i].growth, modes[j].growth);
}

// One parametric resonance, (omega_i + sign omega_j)/Omega = k.
struct Line {
  std::size_t i, j;
  double sign;
  double k;

  double detuning(const std::vector<ModeState>& modes, double speed) const {
    return std::abs(modes[i].frequency + sign * modes[j].frequency) / speed - k;
  }
};

struct Place {
  StabilitySample sample;
  std::vector<ModeState> modes;
};

class Search {
 public:
  Search(const SystemAt& at, const Place& a, const Place& b, const SweepOptions& options)
      : at_(at), a_(a), b_(b), options_(options), found_(is_unstable(a.sample)) {}

  // A sample on the other side of the verdict near the line, if there is one.
  std::optional<StabilitySample> along(const Line& line) {
    Place low = a_, high = b_;
    double s_low = line.detuning(low.modes, low.sample.speed), s_high = line.detuning(high.modes, high.sample.speed);
    const double damping = 0.5 * (low.modes[line.i].damping() + low.modes[line.j].damping());
    // A tongue that reaches instability locks its exponents over a detuning of at least twice the damping.
    const auto resolved = [&] {
      const double width = std::abs(s_high - s_low) * low.sample.speed;
      return width <= std::max(damping, options_.least_growth * low.sample.speed);
    };
    // Narrower than that already: the ends would show it.
    if (std::abs(s_high - s_low) * low.sample.speed <= 0.5 * damping &&
        std::max(growth_of(low.modes, line.i, line.j), growth_of(high.modes, line.i, line.j)) < -0.05 * damping)
      return std::nullopt;
    constexpr int max_steps = 60;
    int side = 0;
    double w_low = s_low, w_high = s_high;
    for (int step = 0; step < max_steps && !resolved(); ++step) {
      // Illinois: regula falsi whose stale end counts half.
      double x = low.sample.x + (high.sample.x - low.sample.x) * (w_low / (w_low - w_high));
      const double margin = 0.02 * (high.sample.x - low.sample.x);
      x = std::clamp(x, low.sample.x + margin, high.sample.x - margin);
      std::optional<Place> middle = place(x, low, high);
      if (!middle) return std::nullopt;
      if (is_unstable(middle->sample) != found_) return middle->sample;
      const double s = line.detuning(middle->modes, middle->sample.speed);
      if (!std::isfinite(s)) return std::nullopt;
      if (std::abs(s) <= 1e-9 * line.k) return highest(line, low, *middle, high);
      if ((s < 0) == (s_low < 0)) {
        low = std::move(*middle);
        s_low = w_low = s;
        if (side == -1) w_high *= 0.5;
        side = -1;
      } else {
        high = std::move(*middle);
        s_high = w_high = s;
        if (side == 1) w_low *= 0.5;
        side = 1;
      }
    }
    std::optional<Place> middle = place(0.5 * (low.sample.x + high.sample.x), low, high);
    if (!middle) return std::nullopt;
    if (is_unstable(middle->sample) != found_) return middle->sample;
    // A bump too low to matter, or none.
    const double chord = std::max(growth_of(low.modes, line.i, line.j), growth_of(high.modes, line.i, line.j));
    if (!(growth_of(middle->modes, line.i, line.j) > chord + 0.1 * damping)) return std::nullopt;
    return highest(line, low, *middle, high);
  }

  // Between a real multiplier above 1 and one below -1 both must come together and turn through the complex plane:
  // halved between the last +1 and the first -1 until that shows.
  std::optional<StabilitySample> turning() {
    const BoundaryKind first = boundary_kind(a_.sample.stability, a_.sample.speed);
    double low = a_.sample.x, high = b_.sample.x;
    while (high - low > 1e-12 * scale_of(low, high)) {
      const double x = 0.5 * (low + high);
      if (!(x > low && x < high)) break;
      std::optional<StabilitySample> middle = stability_sample(at_, x, options_.stability);
      if (!middle || !is_unstable(*middle)) return middle;
      const BoundaryKind kind = boundary_kind(middle->stability, middle->speed);
      if (kind == BoundaryKind::complex) break;
      (kind == first ? low : high) = x;
    }
    return std::nullopt;
  }

  // Least growth between two unstable ends whose exponents lie at different places: a stable gap may be between.
  std::optional<StabilitySample> lowest() {
    std::optional<Place> middle = place(0.5 * (a_.sample.x + b_.sample.x), a_, b_);
    if (!middle) return std::nullopt;
    return extremum(a_, *middle, b_, [](const Place& p) { return -p.sample.stability.growth_rate; });
  }

 private:
  std::optional<Place> place(double x, const Place& low, const Place& high) const {
    std::optional<StabilitySample> sample = stability_sample(at_, x, options_.stability);
    if (!sample) return std::nullopt;
    const double fraction = (x - low.sample.x) / (high.sample.x - low.sample.x);
    std::vector<ModeState> modes =
        modes_by_continuity(sample->stability, sample->speed, interpolated(low.modes, high.modes, fraction));
    return Place{std::move(*sample), std::move(modes)};
  }

  std::optional<StabilitySample> highest(const Line& line, const Place& low, const Place& middle, const Place& high) {
    return extremum(low, middle, high, [&](const Place& p) { return growth_of(p.modes, line.i, line.j); });
  }

  // Largest `value` by parabolas and golden sections, given up when the verdict changes or nothing more is gained.
  template <class Value>
  std::optional<StabilitySample> extremum(Place low, Place middle, Place high, const Value& value) {
    constexpr int max_steps = 30;
    constexpr double golden = 0.3819660112501051;
    double f_low = value(low), f_middle = value(middle), f_high = value(high);
    double last_width = HUGE_VAL;
    for (int step = 0; step < max_steps; ++step) {
      const double x0 = low.sample.x, x1 = middle.sample.x, x2 = high.sample.x;
      if (x2 - x0 <= 1e-12 * scale_of(x0, x2)) break;
      const double p = (x1 - x0) * (f_middle - f_high), q = (x2 - x1) * (f_middle - f_low);
      // Vertex of the parabola through the three.
      double x = x1 - 0.5 * ((x1 - x0) * p - (x2 - x1) * q) / (p + q);
      const bool shrinks = x2 - x0 <= 0.6 * last_width;
      last_width = x2 - x0;
      const double margin = 0.01 * (x2 - x0);
      if (!std::isfinite(x) || x <= x0 + margin || x >= x2 - margin || std::abs(x - x1) <= margin || !shrinks)
        x = x2 - x1 > x1 - x0 ? x1 + golden * (x2 - x1) : x1 - golden * (x1 - x0);
      std::optional<Place> next = place(x, low, high);
      if (!next) return std::nullopt;
      if (is_unstable(next->sample) != found_) return next->sample;
      const double f = value(*next);
      Place& worse = f > f_middle ? middle : *next;
      const double f_worse = std::min(f, f_middle);
      const bool right = (x > x1) == (f > f_middle);  // the better one lies right of the worse one
      if (f > f_middle) {
        (right ? low : high) = std::move(worse);
        (right ? f_low : f_high) = f_worse;
        middle = std::move(*next);
        f_middle = f;
      } else {
        (right ? low : high) = std::move(worse);
        (right ? f_low : f_high) = f_worse;
      }
      // What a parabola through the three could still add.
      const double gain = std::max(f_middle - std::min(f_low, f_high), 0.0);
      if (gain <= 1e-3 * std::abs(f_middle)) break;
    }
    return std::nullopt;
  }

  const SystemAt& at_;
  const Place &a_, &b_;
  const SweepOptions& options_;
  const bool found_;  // verdict that is known already: unstable?
};

}  // namespace

std::optional<StabilitySample> stability_sample(const SystemAt& at, double x, const StabilityOptions& options) {
  const std::optional<ScaledSystem> system = at(x);
  if (!system) return std::nullopt;
  StabilitySample sample{x, system->speed, analyse_stability(*system, options)};
  if (options.leading_only && !std::isfinite(sample.stability.growth_rate + sample.stability.growth_error)) {
    StabilityOptions all = options;
    all.leading_only = false;
    sample.stability = analyse_stability(*system, all);
  }
  return sample;
}

// Mode i at frequency w_i reaches mode j at w_i - k by harmonics that add up to k. In units of growth
// E_jl,m / (2 sqrt(w_j w_l)) the amplitudes on the way are
//     a_k(j) = E_ji,k + sum_{0<m<k} sum_l E_jl,k-m a_m(l) / delta_m(l),    delta_m(l) = |w_l^2 - (w_i - m)^2| / (2 w_l)
// with moduli throughout. delta is held above a quarter: a path through a resonance counts much, not infinitely.
Eigen::MatrixXd parametric_coupling(const ScaledSystem& system, Index mode, Index orders) {
  const Index I = system.num_modes(), H = system.K.num_harmonics();
  const Eigen::VectorXd w = system.mean_diagonal().cwiseAbs().cwiseSqrt().cwiseMax(0.25);
  Eigen::VectorXd unit(I);
  for (Index i = 0; i < I; ++i) unit(i) = 1 / std::sqrt(2 * w(i));
  std::vector<Eigen::MatrixXd> E;  // m = 1, 2, ..., H
  for (Index m = 1; m <= H; ++m) {
    const Eigen::Map<const Eigen::MatrixXcd> K(system.K.c.col(m).data(), I, I);
    E.push_back(unit.asDiagonal() * K.cwiseAbs() * unit.asDiagonal());
  }
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(I, orders), relative = a;  // relative: a/delta
  for (Index k = 1; k <= orders; ++k) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(I);
    if (k <= H) sum = E[static_cast<std::size_t>(k - 1)].col(mode);
    for (Index m = std::max<Index>(1, k - H); m < k; ++m)
      sum.noalias() += E[static_cast<std::size_t>(k - m - 1)] * relative.col(m - 1);
    a.col(k - 1) = sum;
    const double frequency = w(mode) - static_cast<double>(k);
    for (Index l = 0; l < I; ++l)
      relative(l, k - 1) = sum(l) / std::max(0.25, std::abs(w(l) * w(l) - frequency * frequency) / (2 * w(l)));
  }
  return a * system.speed;
}

double ResonanceStrength::operator()(std::size_t i, std::size_t j, double k) {
  if (of_mode_.empty()) {
    first_ = at_(a_);
    last_ = at_(b_);
    if (!first_ || !last_) return 0;
    of_mode_.resize(static_cast<std::size_t>(first_->num_modes()));
  }
  Eigen::MatrixXd& coupling = of_mode_[i];
  if (coupling.size() == 0) {
    coupling = parametric_coupling(*first_, static_cast<Index>(i), orders_)
                   .cwiseMax(parametric_coupling(*last_, static_cast<Index>(i), orders_));
  }
  // Paths that turn back are not in it (chosen by experiment on Mathieu's tongues).
  constexpr double safety = 3;
  return safety * coupling(static_cast<Index>(j), static_cast<Index>(k) - 1);
}

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

std::vector<StabilitySample> look_between(const SystemAt& at, const StabilitySample& a, const StabilitySample& b,
                                          const std::vector<ModeState>& modes_a, const std::vector<ModeState>& modes_b,
                                          const SweepOptions& options) {
  std::vector<StabilitySample> found;
  if (is_unstable(a) != is_unstable(b)) return found;
  const Place start{a, modes_a}, end{b, modes_b};
  Search search(at, start, end, options);
  if (is_unstable(a)) {
    const BoundaryKind kind_a = boundary_kind(a.stability, a.speed), kind_b = boundary_kind(b.stability, b.speed);
    if (kind_a != kind_b) {
      const bool turns = kind_a != BoundaryKind::complex && kind_b != BoundaryKind::complex;
      if (std::optional<StabilitySample> gap = turns ? search.turning() : search.lowest())
        found.push_back(std::move(*gap));
    }
    return found;
  }
  // Lines that cross the interval.
  const std::size_t I = std::min(modes_a.size(), modes_b.size());
  std::vector<Line> lines;
  for (std::size_t i = 0; i < I; ++i) {
    for (std::size_t j = i; j < I; ++j) {
      for (const double sign : {1.0, -1.0}) {
        if (i == j && sign < 0) continue;
        Line line{i, j, sign, 0};
        const double first = line.detuning(modes_a, a.speed), last = line.detuning(modes_b, b.speed);
        if (!std::isfinite(first) || !std::isfinite(last)) continue;
        const double high = std::min(std::max(first, last), options.max_order + 0.5);
        for (line.k = std::max(1.0, std::floor(std::min(first, last)) + 1); line.k < high; ++line.k)
          lines.push_back(line);
      }
    }
  }
  if (lines.empty()) return found;
  // Those strong enough to overcome the damping.
  const double highest =
      std::max_element(lines.begin(), lines.end(), [](const Line& p, const Line& q) { return p.k < q.k; })->k;
  ResonanceStrength strength(at, a.x, b.x, static_cast<int>(highest));
  for (const Line& line : lines) {
    const double needed = std::max(std::sqrt(std::abs(modes_a[line.i].damping() * modes_a[line.j].damping())),
                                   options.least_growth * a.speed);
    if (!(strength(line.i, line.j, line.k) >= needed)) continue;
    if (std::optional<StabilitySample> sample = search.along(line)) found.push_back(std::move(*sample));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const StabilitySample& p, const StabilitySample& q) { return p.x < q.x; });
  return found;
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
  // The boundary is no better known than the growth rate.
  StabilityOptions sharp = options.stability;
  sharp.tolerance = std::min(sharp.tolerance, boundary_tolerance);
  const double kappa1 = 0.2 / (high - low);
  const int half = static_cast<int>(std::ceil(std::log2((high - low) / (2 * wanted))));
  const int most = std::max(half, 0) + 1;
  // Nearest certain growth rates on both sides: how an error of the growth rate moves the boundary.
  double certain_low = low, certain_high = high, g_low = f_low, g_high = f_high, growth_error = 0;
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
    const std::optional<StabilitySample> sample = stability_sample(at, x, sharp);
    if (!sample || !std::isfinite(sample->stability.growth_rate)) break;
    const double f = value(*sample);
    const bool above = (f > 0) == unstable_above;  // x lies on b's side
    (above ? high : low) = x;
    (above ? f_high : f_low) = f;
    if (f > 0) notice_kind(*sample);
    growth_error = sample->stability.growth_error;
    if (std::abs(f) > 4 * growth_error) {
      (above ? certain_high : certain_low) = x;
      (above ? g_high : g_low) = f;
    }
  }
  boundary.x = 0.5 * (low + high);
  boundary.error = 0.5 * (high - low);
  const double slope = std::abs((g_high - g_low) / (certain_high - certain_low));
  if (by_sign && slope > 0) boundary.error += std::min(growth_error / slope, certain_high - certain_low);
  boundary.converged = boundary.error <= boundary_tolerance * std::max(std::abs(low), std::abs(high));
  return boundary;
}

std::vector<UnstableBand> unstable_bands(const std::vector<const StabilitySample*>& samples,
                                         const std::vector<StabilityBoundary>& boundaries) {
  std::vector<UnstableBand> bands;
  const StabilitySample* last = nullptr;
  UnstableBand band;
  bool inside = false;
  const auto boundary_between = [&](double from, double to) {
    return std::find_if(boundaries.begin(), boundaries.end(),
                        [&](const StabilityBoundary& b) { return b.x >= from && b.x <= to; });
  };
  const auto close = [&](double x, bool open) {
    band.to = x;
    band.open_to = open;
    bands.push_back(band);
    inside = false;
  };
  for (const StabilitySample* sample : samples) {
    if (sample == nullptr) {
      if (inside) close(last->x, true);
      last = nullptr;
      continue;
    }
    const bool unstable = is_unstable(*sample);
    if (unstable && !inside) {
      band = UnstableBand{};
      band.fastest = -HUGE_VAL;
      band.from = sample->x;
      band.open_from = true;
      band.kind_from = boundary_kind(sample->stability, sample->speed);
      if (last != nullptr) {
        const auto boundary = boundary_between(last->x, sample->x);
        if (boundary != boundaries.end()) {
          band.from = boundary->x;
          band.error_from = boundary->error;
          band.open_from = false;
          band.kind_from = boundary->kind;
        }
      }
      inside = true;
    } else if (!unstable && inside) {
      const auto boundary = boundary_between(last->x, sample->x);
      const bool known = boundary != boundaries.end();
      if (known) {
        band.kind_to = boundary->kind;
        band.error_to = boundary->error;
      }
      close(known ? boundary->x : last->x, !known);
    }
    if (unstable) {
      band.kind_to = boundary_kind(sample->stability, sample->speed);
      if (sample->stability.growth_rate > band.fastest) {
        band.fastest = sample->stability.growth_rate;
        band.fastest_x = sample->x;
      }
    }
    last = sample;
  }
  if (inside) close(last->x, true);
  return bands;
}

}  // namespace hb
