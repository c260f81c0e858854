#include "hb/engine/exponents/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "hb/engine/exponents/exponent_search.hpp"
#include "hb/engine/exponents/exponent_summary.hpp"
#include "hb/engine/exponents/growth_bound.hpp"
#include "hb/engine/exponents/imaginary_axis.hpp"
#include "hb/engine/system/independent_parts.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

using Eigen::Index;
using cplx = std::complex<double>;

Stability finished(const ScaledSystem& system, const ExponentSearch& search, double tolerance) {
  const Exponents& found = search.exponents;
  Stability result = summary(search, system.speed, tolerance);
  const bool known = search.complete && std::isfinite(result.growth_rate);
  // Where nothing varies the exponents are not taken modulo i Omega.
  const double period = system.K.num_harmonics() == 0 ? HUGE_VAL : 1;
  if (known && Index(found.s.size()) == 2 * system.num_modes() && system.conservative.all() &&
      images_apart(found.s, found.error, period)) {
    ExponentSearch on_axis = search;
    for (cplx& s : on_axis.exponents.s) s.real(0);
    on_axis.exponents.error = found.imaginary_error;
    result = summary(on_axis, system.speed, tolerance);
    put_on_axis(result);
  }
  return result;
}

// Between the mean of all exponents, -tr G/(2I) (Liouville), and the logarithmic norm's bound.
Stability by_bound(const ScaledSystem& system) {
  const double Omega = system.speed, high = growth_bound(system);
  const double mean = -system.G.trace() / (2 * double(system.num_modes())),
               low = mean - 8 * eps * std::abs(mean) - system.G_error.trace() / 2;
  Stability result;
  result.method = StabilityMethod::bound;
  result.evidence = std::isfinite(high) ? "closed-form bounds on the growth rate; no exponent was computed"
                                        : "closed-form bounds on the growth rate do not exist here";
  set_growth(result, Omega * high, Omega * low, Omega * high);
  result.converged = result.verdict == Verdict::stable;
  return result;
}

// Cells of a turn that propagation begins with, about.
double propagated_cells(const ScaledSystem& system) {
  return 0.8 * std::sqrt(system.mean_diagonal().cwiseAbs().maxCoeff());
}

// Damping and gyroscopic forces of the scaled system that couple modes by less than this do not keep slaving from
// converging (by experience).
constexpr double weak_damping_coupling = 0.01;

bool damping_couples(const ScaledSystem& system) {
  if (system.diagonal_damping) return false;
  const Eigen::MatrixXd own = system.G.diagonal().asDiagonal();
  return (system.G - own).cwiseAbs().maxCoeff() > weak_damping_coupling;
}

// Where damping or gyroscopic forces couple the modes slaving goes in circles, and few slow modes are propagated in
// less time than that; without such forces it takes as long, and slaving leaves more rounding.
bool propagates_at_once(const ScaledSystem& system) {
  const double cells = propagated_cells(system);
  if (damping_couples(system)) return system.num_modes() <= 4 && cells <= 64;
  return system.num_modes() > 1 && system.num_modes() <= 6 && cells <= 16;
}

// Reductions once more, begun at what they came to, and so much sharper that their own errors do not count: of the
// exponents of a mode alone these may be the largest.
ExponentSearch slaved_sharper(const ScaledSystem& system, double tolerance, const Exponents& known,
                              std::vector<SlavingStart> solved) {
  constexpr double sharper = 1e-2;
  for (SlavingStart& start : solved) start.rough = true;
  return search_by_slaving(system, sharper * tolerance, known, solved);
}

// The decision policy: hb/engine/README.md, "Which method when".
Stability of_group(const ScaledSystem& system, const StabilityOptions& options) {
  const double tolerance = options.tolerance;
  if (system.K.num_harmonics() == 0) return finished(system, search_constant(system), tolerance);
  if (options.method == StabilityMethod::bound || options.verdict_only) {
    const Stability bounds = by_bound(system);
    if (options.method == StabilityMethod::bound || bounds.verdict == Verdict::stable) return bounds;
  }
  if (options.method == StabilityMethod::hill) return finished(system, search_by_hill(system), tolerance);
  if (options.method == StabilityMethod::determinant) return finished(system, search_by_determinant(system), tolerance);
  if (options.method == StabilityMethod::propagation)
    return finished(system, search_by_propagation(system, tolerance), tolerance);
  const auto suffices = [&](const Stability& result) {
    return result.converged && (result.verdict != Verdict::undecided || options.growth_suffices);
  };
  // Without damping all exponents are needed to decide.
  if (options.leading_only && system.num_modes() > 1 && !system.conservative.all())
    if (const auto lead = search_leading(system, tolerance, options.keep)) {
      const Stability result = finished(system, *lead, tolerance);
      if (suffices(result) || (options.as_found && std::isfinite(result.growth_rate + result.growth_error)))
        return result;
    }
  Exponents propagated;
  if (options.method == StabilityMethod::automatic && propagates_at_once(system)) {
    ExponentSearch search = search_by_propagation(system, tolerance);
    const Stability result = finished(system, search, tolerance);
    const bool all = !system.diagonal_damping || Index(result.exponents.size()) == 2 * system.num_modes();
    if (suffices(result) && all) return result;
    propagated = std::move(search.exponents);
  }
  ExponentSearch search = search_by_slaving(system, tolerance, propagated, options.starts);
  Stability result = finished(system, search, tolerance);
  if (options.keeps_solved) result.solved = search.solved;
  if (search.method == StabilityMethod::propagation || options.method == StabilityMethod::slaving) return result;
  // Beyond about a second's work the fastest modes turn so often that propagation is less accurate than what is there.
  if (search.complete && propagated_cells(system) * std::pow(double(system.num_modes()), 3) > 1e6) return result;
  if (search.complete && (suffices(result) || options.one_method)) return result;
  if (search.complete && system.num_modes() > 1) {
    const ExponentSearch again = slaved_sharper(system, tolerance, propagated, std::move(search.solved));
    Stability closer = finished(system, again, tolerance);
    if (again.complete && again.method == StabilityMethod::slaving && closer.growth_error < result.growth_error) {
      closer.evidence += " (second reductions, sharper, after first ones undecided or less accurate than asked)";
      closer.solved = std::move(result.solved);
      result = std::move(closer);
    }
    if (suffices(result)) return result;
  }
  const double sharper = options.growth_suffices ? tolerance : std::min(tolerance, 1e-11);
  Stability second = finished(system, search_by_propagation(system, sharper), tolerance);
  if (second.growth_error >= result.growth_error && second.verdict != Verdict::bounded) return result;
  second.evidence += search.complete ? " (second method after a first that was undecided or less accurate than asked)"
                                     : " (the reduction did not account for all exponents)";
  return second;
}

// Of groups whose exponents together are those of the system.
Stability of_groups(const ScaledSystem& system, const std::vector<std::vector<int>>& groups, StabilityOptions options,
                    const char* relation) {
  options.keep = {};
  options.starts = {};
  options.keeps_solved = false;
  Stability whole;
  double growth = -HUGE_VAL, high = -HUGE_VAL, low = -HUGE_VAL, others = -HUGE_VAL;
  Verdict verdict = Verdict::stable;
  whole.converged = true;
  for (const std::vector<int>& modes : groups) {
    const Stability part = analyse_stability(group_of(system, modes), options);
    const auto add = [&](const std::vector<Exponent>& from, std::vector<Exponent>& to) {
      for (Exponent e : from) {
        e.mode = modes[static_cast<std::size_t>(e.mode)];
        to.push_back(e);
      }
    };
    add(part.exponents, whole.exponents);
    add(part.uncertain, whole.uncertain);
    whole.converged = whole.converged && part.converged;
    verdict = worst(verdict, part.verdict);
    others = std::max(others, part.others_below);
    // A group of which nothing is known may do anything.
    const bool known = std::isfinite(part.growth_rate) && std::isfinite(part.growth_error);
    high = known ? std::max(high, part.growth_high) : HUGE_VAL;
    low = std::max(low, part.growth_low);
    if (!(part.growth_rate > growth) || !(known || part.method == StabilityMethod::bound)) continue;
    growth = part.growth_rate;
    whole.method = part.method;
    whole.evidence = part.evidence;
  }
  sort(whole.exponents);
  sort(whole.uncertain);
  whole.evidence = fmt::format("{} groups of modes {}; the leading one: {}", groups.size(), relation, whole.evidence);
  set_growth(whole, growth, low, high);
  whole.others_below = others;
  if (!std::isfinite(whole.growth_error)) whole.converged = false;
  whole.verdict = verdict;
  return whole;
}

// Groups that feel each other one way only: simple exponents in each leave disturbances bounded only where all are.
Stability of_one_way_groups(const ScaledSystem& system, const std::vector<std::vector<int>>& groups,
                            const StabilityOptions& options) {
  Stability whole = of_groups(system, groups, options, "that feel each other one way at most");
  if (whole.verdict != Verdict::bounded) return whole;
  std::vector<cplx> values;
  std::vector<double> errors;
  for (const auto* list : {&whole.exponents, &whole.uncertain})
    for (const Exponent& e : *list) {
      values.push_back(e.value);
      errors.push_back(e.error);
    }
  const double period = system.K.num_harmonics() == 0 ? HUGE_VAL : system.speed;
  if (!images_apart(values, errors, period)) whole.verdict = Verdict::undecided;
  return whole;
}

}  // namespace

std::complex<double> Exponent::multiplier(double speed) const {
  return std::exp(value * (2 * std::numbers::pi / speed));
}

Stability analyse_stability(const ScaledSystem& system, const StabilityOptions& options) {
  const Index g = common_divisor(system);
  if (g > 1) {
    StabilityOptions shorter = options;
    shorter.tolerance /= double(g);  // relative to the speed, which is g times as high there
    Stability result = analyse_stability(with_period_divided(system, g), shorter);
    for (std::vector<Exponent>* list : {&result.exponents, &result.uncertain}) {
      for (Exponent& e : *list) e.value.imag(system.speed * folded(e.value.imag() / system.speed));
      sort(*list);
    }
    result.evidence += fmt::format("; K repeats {} times a turn", g);
    return result;
  }
  if (system.num_modes() == 1) return of_group(system, options);
  const auto groups = independent_groups(system);
  if (groups.size() > 1) return of_groups(system, groups, options, "that do not feel each other");
  const auto one_way = one_way_groups(system);
  if (one_way.size() > 1) return of_one_way_groups(system, one_way, options);
  return of_group(system, options);
}

Stability analyse_stability(const HillSystem& system, double speed, const StabilityOptions& options) {
  return analyse_stability(scale_system(system, speed), options);
}

const char* to_string(StabilityMethod method) {
  switch (method) {
    case StabilityMethod::automatic:
      return "automatic";
    case StabilityMethod::hill:
      return "hill";
    case StabilityMethod::slaving:
      return "slaving";
    case StabilityMethod::propagation:
      return "propagation";
    case StabilityMethod::bound:
      return "bound";
    case StabilityMethod::determinant:
      return "determinant";
  }
  return "";
}

}  // namespace hb
