#include "hb/engine/exponents/stability.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>

#include "hb/engine/exponents/constant_coefficients.hpp"
#include "hb/engine/exponents/growth_bound.hpp"
#include "hb/engine/exponents/hill_determinant.hpp"
#include "hb/engine/exponents/hill_exponents.hpp"
#include "hb/engine/system/independent_parts.hpp"
#include "hb/engine/exponents/reduced_exponents.hpp"
#include "hb/engine/exponents/slaving.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

constexpr double eps = 2.220446049250313e-16;
// Above, slaving each mode on its own is tried before all are propagated.
constexpr Index most_modes_propagated = 10;

// |Im s + k| nearest to `near`.
double unfolded(double s, double near) {
  const double fraction = s - std::floor(s);
  const double up = fraction + std::round(near - fraction), down = -fraction + std::round(near + fraction);
  return std::abs(up - near) <= std::abs(down - near) ? std::abs(up) : std::abs(down);
}

// Gives every exponent its mode and its unfolded frequency: pairs go to the modes of the group whose mean equation
// z^2 + b z + w^2 has the nearest root; each mode takes two.
void name_modes(Exponents& exponents, const ScaledSystem& system, const std::vector<Index>& group) {
  const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  const std::size_t count = exponents.s.size();
  exponents.mode.assign(count, 0);
  exponents.frequency.assign(count, 0);
  std::vector<int> room(group.size(), 2);
  for (std::size_t i = 0; i < count; ++i) {
    double nearest = HUGE_VAL;
    std::size_t chosen = 0;
    for (std::size_t g = 0; g < group.size(); ++g) {
      if (room[g] == 0) continue;
      const cplx root = std::sqrt(cplx(b(group[g]) * b(group[g]) / 4 - w2(group[g]), 0));
      for (const cplx mean : {-b(group[g]) / 2 + root, -b(group[g]) / 2 - root}) {
        // The phase function gives the whole frequency; a turn's map gives it modulo 1.
        const double im = std::abs(exponents.s[i].imag());
        const double frequency = im > 0.5 ? im : unfolded(exponents.s[i].imag(), std::abs(mean.imag()));
        const double distance = std::hypot(exponents.s[i].real() - mean.real(), frequency - std::abs(mean.imag()));
        if (distance < nearest) {
          nearest = distance;
          chosen = g;
          exponents.frequency[i] = frequency;
        }
      }
    }
    if (room[chosen] > 0) --room[chosen];
    exponents.mode[i] = group[chosen];
  }
}

struct Search {
  Exponents exponents;
  StabilityMethod method = StabilityMethod::automatic;
  std::string evidence;
  std::vector<Index> kept;
  bool complete = false;  // all 2I exponents accounted for
};

Search propagate_all(const ScaledSystem& system, double tolerance, bool leading_only = false) {
  std::vector<Index> all(std::size_t(system.num_modes()));
  std::iota(all.begin(), all.end(), Index(0));
  Search search;
  search.exponents = propagated_exponents(slave_to(system, all), tolerance, leading_only);
  name_modes(search.exponents, system, all);
  search.method = StabilityMethod::propagation;
  search.evidence = "all modes propagated over a turn by Radau IIA";
  search.kept = all;
  search.complete = true;
  return search;
}

// True if the columns span everything: no subspace appears twice. Rows are weighted as amplitudes of the modes are.
bool spans(const ScaledSystem& system, MatrixXd states) {
  const Index I = system.num_modes();
  if (!states.allFinite()) return false;
  const VectorXd w2 = system.mean_diagonal();
  for (Index i = 0; i < I; ++i) states.row(i) *= std::max(1.0, std::sqrt(std::abs(w2(i))));
  states.colwise().normalize();
  // Far above the errors of the subspaces.
  return Eigen::PartialPivLU<MatrixXd>(states).rcond() > 1e-8;
}

// Relative error of alpha that moves no kept mode's exponents -b/2 +- sqrt(b^2/4 - w^2) by more than a thousandth of
// what is allowed: ds = d alpha/(2 sqrt|w^2 - b^2/4|).
double sufficient(const ScaledSystem& system, std::span<const Index> kept, double tolerance) {
  const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  double smallest = 1;
  for (const Index s : kept) {
    const cplx root = std::sqrt(cplx(b(s) * b(s) / 4 - w2(s), 0));
    const double wanted = std::max(std::abs((-b(s) / 2 + root).real()), 0.01);
    const double size = std::max(std::abs(w2(s)), 1e-4);
    smallest = std::min(smallest, wanted * 2 * std::max(std::abs(root), 1e-3) / size);
  }
  return 1e-3 * tolerance * smallest;
}

// Slaving the others to them costs more than propagating all modes: cells as many as the fastest one needs, each with a
// dense elimination.
bool too_many(const ScaledSystem& system, const std::vector<Index>& together) {
  const VectorXd w2 = system.mean_diagonal();
  const auto work = [](double modes, double fastest2) {
    return modes * modes * modes * std::max(12.0, 0.8 * std::sqrt(fastest2));
  };
  double fastest2 = 0;
  for (const Index s : together) fastest2 = std::max(fastest2, std::abs(w2(s)));
  return 2 * work(double(together.size()), fastest2) > work(double(system.num_modes()), w2.cwiseAbs().maxCoeff());
}

// Above this resonance strength reductions converge slowly, if at all (by experience with rods in bands of
// instability).
constexpr double strong_resonance = 3e-4;

// Slaves the others to `together` and to the modes that pull at these, which are added to it until that converges;
// empty where too many would have to be kept.
std::optional<ReducedSystem> slave_to_resonant(const ScaledSystem& system, std::vector<Index>& together,
                                               double tolerance) {
  Index next = 0;
  const auto with_next = [&] {
    std::vector<Index> more = together;
    more.push_back(next);
    return more;
  };
  while (resonance_strength(system, together).maxCoeff(&next) > strong_resonance && !too_many(system, with_next()))
    together = with_next();
  while (!too_many(system, together)) {
    ReducedSystem reduced = slave_to(system, together, sufficient(system, together, tolerance));
    if (reduced.converged) return reduced;
    resonance_strength(system, together).maxCoeff(&next);
    together = with_next();
  }
  return std::nullopt;
}

// Exponents of one mode that are known better than those of a whole list take their place. A list that has lost them,
// because they decay too fast for it, gets them.
void sharpen(Exponents& list, const Exponents& pair) {
  for (std::size_t p = 0; p < pair.s.size(); ++p) {
    bool missing = true;
    for (std::size_t i = 0; i < list.s.size(); ++i) {
      const cplx apart = list.s[i] - pair.s[p];
      const double turn = std::abs(apart.imag() - std::round(apart.imag()));
      if (!(std::hypot(apart.real(), turn) <= list.error[i] + pair.error[p])) continue;
      missing = false;
      if (!(pair.error[p] < list.error[i])) continue;
      list.s[i] = pair.s[p];
      list.error[i] = pair.error[p];
      list.mode[i] = pair.mode[p];
      list.frequency[i] = pair.frequency[p];
      break;
    }
    if (!missing || !(pair.s[p].real() < list.others_below)) continue;
    list.add(pair.s[p], pair.error[p]);
    list.mode.push_back(pair.mode[p]);
    list.frequency.push_back(pair.frequency[p]);
  }
}

// Every mode on its own, the others slaved to it; modes for which that diverges together, with more modes until the
// reduction converges.
Search by_slaving(const ScaledSystem& system, double tolerance) {
  const Index I = system.num_modes();
  Search search;
  std::vector<Index> together;
  std::vector<Exponents> alone(std::size_t(I), Exponents{});
  std::vector<MatrixXd> starts(std::size_t(I), MatrixXd{});  // of the subspaces, per mode alone
  MatrixXd start_together(2 * I, 0);
  for (Index g = 0; g < I; ++g) {
    const std::array<Index, 1> one{g};
    const ReducedSystem reduced = slave_to(system, one, sufficient(system, one, tolerance));
    if (reduced.converged) alone[std::size_t(g)] = reduced_exponents(reduced, tolerance);
    name_modes(alone[std::size_t(g)], system, {g});
    if (reduced.converged && !alone[std::size_t(g)].s.empty())
      starts[std::size_t(g)] = reduced.start;
    else
      together.push_back(g);
  }
  search.method = StabilityMethod::slaving;
  if (!together.empty()) {
    if (const auto reduced = slave_to_resonant(system, together, tolerance)) {
      search.exponents = reduced_exponents(*reduced, tolerance);
      name_modes(search.exponents, system, together);
      start_together = reduced->start;
    } else {
      search = propagate_all(system, tolerance);
      for (const Exponents& pair : alone) sharpen(search.exponents, pair);
      return search;
    }
    search.evidence = fmt::format(
        "{} modes propagated over a turn by Radau IIA, the others slaved to them; {} modes "
        "each with the others slaved to it",
        together.size(), I - Index(together.size()));
  } else {
    search.evidence = fmt::format("{} modes, each with the others slaved to it, their exponents from {}", I,
                                  "the phase function, Hill's determinant or one turn's propagation");
    search.exponents.converged = true;
  }
  MatrixXd states(2 * I, 2 * I);
  states.leftCols(start_together.cols()) = start_together;
  Index filled = start_together.cols();
  for (Index g = 0; g < I; ++g)
    if (std::find(together.begin(), together.end(), g) == together.end()) {
      states.middleCols(filled, 2) = starts[std::size_t(g)];
      filled += 2;
      search.exponents.append(alone[std::size_t(g)]);
      search.exponents.converged = search.exponents.converged && alone[std::size_t(g)].converged;
    }
  search.complete = spans(system, std::move(states));
  return search;
}

Search by_hill(const ScaledSystem& system) {
  const HillExponents hill = hill_exponents(system);
  Search search;
  // From two modes the iteration may have gone to one exponent. Distinct ones have independent vectors: 2I are all.
  const auto found_before = [&](std::size_t i) {
    for (std::size_t k = 0; k < search.exponents.s.size(); ++k) {
      const cplx apart = search.exponents.s[k] - hill.s[i];
      const double turn = std::abs(apart.imag() - std::round(apart.imag()));
      if (std::hypot(apart.real(), turn) <= search.exponents.error[k] + hill.error[i] + 1e-10) return true;
    }
    return false;
  };
  for (std::size_t i = 0; i < hill.s.size(); ++i) {
    if (found_before(i)) continue;
    search.exponents.add(hill.s[i], hill.error[i]);
    search.exponents.mode.push_back(hill.mode[i]);
    search.exponents.frequency.push_back(std::abs(hill.s[i].imag()));
  }
  search.complete = Index(search.exponents.s.size()) == 2 * system.num_modes();
  search.method = StabilityMethod::hill;
  search.evidence = "each exponent by Newton's method on the Hill equations, in a window centred on its mode";
  return search;
}

Search by_determinant(const ScaledSystem& system) {
  Search search;
  search.method = StabilityMethod::determinant;
  if (!system.diagonal_damping) {
    search.evidence = "Hill's determinant was not taken: the damping is not diagonal";
    return search;
  }
  const HillDeterminant determinant(system);
  search.exponents = determinant.exponents();
  std::vector<Index> all(std::size_t(system.num_modes()));
  std::iota(all.begin(), all.end(), Index(0));
  name_modes(search.exponents, system, all);
  // How many lie to the right of zero is known from the winding of the determinant as well, if none lies too near.
  const std::optional<int> growing = determinant.exponents_above(0);
  int found = 0, unclear = search.exponents.others_below >= 0 ? 1 : 0;
  for (std::size_t i = 0; i < search.exponents.s.size(); ++i) {
    const double growth = search.exponents.s[i].real(), bar = search.exponents.error[i];
    (growth > bar ? found : unclear) += growth >= -bar ? 1 : 0;
  }
  search.complete = !search.exponents.s.empty() && (!growing || unclear > 0 || *growing == found);
  search.evidence = growing
                        ? fmt::format("zeros of Hill's determinant on a circle; {} growing by its winding", *growing)
                        : "zeros of Hill's determinant on a circle";
  return search;
}

// Only the leading exponents: the slowest modes with the others slaved to them, and a bound that puts all other
// exponents below; without such a bound all modes propagated. Empty if neither serves.
std::optional<Search> leading(const ScaledSystem& system, double tolerance, const std::vector<int>& keep) {
  const Index I = system.num_modes();
  if (!system.diagonal_damping) return std::nullopt;
  std::vector<Index> together(keep.begin(), keep.end());
  if (together.empty()) {
    const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
    Index slowest = 0;
    double largest = -HUGE_VAL;
    for (Index g = 0; g < I; ++g) {
      const double growth = (-b(g) / 2 + std::sqrt(cplx(b(g) * b(g) / 4 - w2(g), 0))).real();
      if (growth > largest) {
        largest = growth;
        slowest = g;
      }
    }
    together.push_back(slowest);
  }
  if (const auto reduced = slave_to_resonant(system, together, tolerance)) {
    Search search;
    search.exponents = reduced_exponents(*reduced, tolerance, true);
    name_modes(search.exponents, system, together);
    double growth = -HUGE_VAL;
    for (std::size_t i = 0; i < search.exponents.s.size(); ++i)
      growth = std::max(growth, search.exponents.s[i].real() - search.exponents.error[i]);
    if (std::max(reduced->others_below, search.exponents.others_below) < growth) {
      search.method = StabilityMethod::slaving;
      search.evidence = fmt::format("{} modes kept, the others slaved to them and bounded below the leading exponent",
                                    together.size());
      search.kept = together;
      search.complete = true;
      return search;
    }
  }
  if (I > most_modes_propagated) return std::nullopt;
  return propagate_all(system, tolerance, true);
}

// Imaginary part to (-Omega/2, Omega/2].
double folded(double s) {
  double f = s - std::floor(s + 0.5);  // [-1/2, 1/2)
  return f <= -0.5 ? f + 1 : f;
}

// Real part descending, then imaginary part ascending.
void sort(std::vector<Exponent>& exponents) {
  std::stable_sort(exponents.begin(), exponents.end(), [](const Exponent& a, const Exponent& b) {
    if (a.value.real() != b.value.real()) return a.value.real() > b.value.real();
    return a.value.imag() < b.value.imag();
  });
}

Stability finished(const ScaledSystem& system, const Search& search, double tolerance) {
  const double Omega = system.speed;
  Stability result;
  result.method = search.method;
  result.evidence = search.evidence;
  result.kept.assign(search.kept.begin(), search.kept.end());
  double upper = search.exponents.others_below, lower = -HUGE_VAL, growth = -HUGE_VAL;
  for (std::size_t i = 0; i < search.exponents.s.size(); ++i) {
    const cplx s = search.exponents.s[i];
    const double error = search.exponents.error[i];
    growth = std::max(growth, s.real());
    upper = std::max(upper, s.real() + error);
    lower = std::max(lower, s.real() - error);
    (error <= 1e-6 * std::max(std::abs(s), 1.0) ? result.exponents : result.uncertain)
        .push_back({{Omega * s.real(), Omega * folded(s.imag())},
                    Omega * error,
                    int(search.exponents.mode[i]),
                    Omega * search.exponents.frequency[i]});
  }
  sort(result.exponents);
  sort(result.uncertain);
  const bool known = search.complete && std::isfinite(growth);
  const double bar = known ? std::max(upper - growth, growth - lower) : HUGE_VAL;
  result.growth_rate = Omega * growth;
  result.growth_error = Omega * bar;
  result.converged = std::isfinite(bar) && bar <= std::max(tolerance, 1e-13) * std::max(std::abs(growth), 1.0);
  if (known && upper < 0) result.verdict = Verdict::stable;
  if (known && lower > 0) result.verdict = Verdict::unstable;
  return result;
}

// Between the mean of all exponents, -tr G/(2I) (Liouville), and the logarithmic norm's bound.
Stability by_bound(const ScaledSystem& system) {
  const double Omega = system.speed, upper = growth_bound(system);
  const double lower = -system.G.trace() / (2 * double(system.num_modes()));
  Stability result;
  result.method = StabilityMethod::bound;
  result.evidence = std::isfinite(upper) ? "closed-form bounds on the growth rate; no exponent was computed"
                                         : "closed-form bounds on the growth rate do not exist here";
  result.growth_rate = Omega * (std::isfinite(upper) ? (upper + lower) / 2 : lower);
  result.growth_error = Omega * (std::isfinite(upper) ? (upper - lower) / 2 + 8 * eps * std::abs(lower) : HUGE_VAL);
  if (upper < 0) result.verdict = Verdict::stable;
  result.converged = result.verdict != Verdict::undecided;
  return result;
}

// Modes that feel each other, or a constant K.
Stability of_group(const ScaledSystem& system, const StabilityOptions& options) {
  Search search;
  if (system.K.num_harmonics() == 0) {
    const TurnExponents roots = constant_exponents(system);
    search.exponents.s = roots.s;
    search.exponents.error = roots.error;
    search.exponents.converged = true;
    std::vector<Index> all(std::size_t(system.num_modes()));
    std::iota(all.begin(), all.end(), Index(0));
    name_modes(search.exponents, system, all);
    search.method = StabilityMethod::hill;
    search.evidence = "constant coefficients: roots of the characteristic equation";
    search.complete = true;
    return finished(system, search, options.tolerance);
  }
  if (options.method == StabilityMethod::bound || options.verdict_only) {
    const Stability bounds = by_bound(system);
    if (options.method == StabilityMethod::bound || bounds.verdict == Verdict::stable) return bounds;
  }
  if (options.method == StabilityMethod::hill) return finished(system, by_hill(system), options.tolerance);
  if (options.method == StabilityMethod::determinant)
    return finished(system, by_determinant(system), options.tolerance);
  if (options.method == StabilityMethod::propagation)
    return finished(system, propagate_all(system, options.tolerance), options.tolerance);
  if (options.leading_only && system.num_modes() > 1)
    if (const auto lead = leading(system, options.tolerance, options.keep)) {
      const Stability result = finished(system, *lead, options.tolerance);
      if (result.verdict != Verdict::undecided && result.converged) return result;
    }
  search = by_slaving(system, options.tolerance);
  Stability result = finished(system, search, options.tolerance);
  if (search.method == StabilityMethod::propagation || options.method == StabilityMethod::slaving) return result;
  // Beyond about a second's work the fastest modes turn so often that propagation is less accurate than what is there.
  const double cells = 0.8 * std::sqrt(system.mean_diagonal().cwiseAbs().maxCoeff());
  if (search.complete && cells * std::pow(double(system.num_modes()), 3) > 1e6) return result;
  if (!search.complete || result.verdict == Verdict::undecided || !result.converged) {
    Stability second = finished(system, propagate_all(system, std::min(options.tolerance, 1e-11)), options.tolerance);
    if (!(second.growth_error >= result.growth_error)) {
      second.evidence += search.complete
                             ? " (second method after a first that was undecided or less accurate than asked)"
                             : " (the reduction did not account for all exponents)";
      return second;
    }
  }
  return result;
}

// Of groups that do not feel each other.
Stability of_groups(const ScaledSystem& system, const std::vector<std::vector<int>>& groups, StabilityOptions options) {
  options.keep = {};
  Stability whole;
  whole.growth_rate = -HUGE_VAL;
  whole.converged = true;
  double upper = -HUGE_VAL, lower = -HUGE_VAL;
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
    // A group of which nothing is known may do anything.
    if (!std::isfinite(part.growth_rate) || !std::isfinite(part.growth_error)) {
      upper = HUGE_VAL;
      continue;
    }
    upper = std::max(upper, part.growth_rate + part.growth_error);
    lower = std::max(lower, part.growth_rate - part.growth_error);
    if (!(part.growth_rate > whole.growth_rate)) continue;
    whole.growth_rate = part.growth_rate;
    whole.method = part.method;
    whole.evidence = part.evidence;
  }
  sort(whole.exponents);
  sort(whole.uncertain);
  whole.evidence =
      fmt::format("{} groups of modes that do not feel each other; the leading one: {}", groups.size(), whole.evidence);
  whole.growth_error = std::max(upper - whole.growth_rate, whole.growth_rate - lower);
  if (!std::isfinite(whole.growth_error)) {
    whole.growth_error = HUGE_VAL;
    whole.converged = false;
  }
  if (upper < 0) whole.verdict = Verdict::stable;
  if (lower > 0) whole.verdict = Verdict::unstable;
  return whole;
}

}  // namespace

Stability analyse_stability(const ScaledSystem& system, const StabilityOptions& options) {
  if (system.K.num_harmonics() == 0) return of_group(system, options);
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
  const std::vector<std::vector<int>> groups = independent_groups(system);
  return groups.size() == 1 ? of_group(system, options) : of_groups(system, groups, options);
}

Stability analyse_stability(const HillSystem& system, double speed, const StabilityOptions& options) {
  return analyse_stability(scale_system(system, speed), options);
}

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return "stable";
    case Verdict::unstable:
      return "unstable";
    case Verdict::undecided:
      return "undecided";
  }
  return "";
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
