#include "hb/engine/exponents/exponent_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "hb/engine/exponents/constant_coefficients.hpp"
#include "hb/engine/exponents/hill_determinant.hpp"
#include "hb/engine/exponents/hill_exponents.hpp"
#include "hb/engine/exponents/shifted_resonances.hpp"
#include "hb/engine/exponents/slaving.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

// Above, slaving each mode on its own is tried before all are propagated.
constexpr Index most_modes_propagated = 6;

std::vector<Index> all_modes(const ScaledSystem& system) {
  std::vector<Index> all(std::size_t(system.num_modes()));
  std::iota(all.begin(), all.end(), Index(0));
  return all;
}

// |Im s + k| nearest to `near`.
double unfolded(double s, double near) {
  const double fraction = s - std::floor(s);
  const double up = fraction + std::round(near - fraction), down = -fraction + std::round(near + fraction);
  return std::abs(up - near) <= std::abs(down - near) ? std::abs(up) : std::abs(down);
}

void name_modes(Exponents& exponents, const ScaledSystem& system, const std::vector<Index>& group) {
  hb::name_modes(exponents, system.mean_diagonal(), system.damping_diagonal(), group);
}

// Whether two of the exponents may be one that was found twice.
bool may_be_twice(const Exponents& found) {
  for (std::size_t i = 0; i < found.s.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const cplx apart = found.s[i] - found.s[k];
      const double turn = apart.imag() - std::round(apart.imag());
      if (!(std::hypot(apart.real(), turn) > found.error[i] + found.error[k])) return true;
    }
  return false;
}

// sum_j s_j = -tr G (Liouville): not so if an exponent was found twice and another one not at all.
bool add_up(const ScaledSystem& system, const Exponents& found) {
  if (Index(found.s.size()) != 2 * system.num_modes()) return true;
  double sum = system.G.trace(), error = 8 * eps * system.G.diagonal().cwiseAbs().sum() + system.G_error.trace();
  for (std::size_t i = 0; i < found.s.size(); ++i) {
    sum += found.s[i].real();
    error += found.error[i];
  }
  return std::abs(sum) <= error;
}

// True if the columns span everything: no subspace appears twice. Rows are weighted as amplitudes of the modes are.
bool spans(const ScaledSystem& system, MatrixXd states, double least) {
  const Index I = system.num_modes();
  if (!states.allFinite()) return false;
  const VectorXd w2 = system.mean_diagonal();
  for (Index i = 0; i < I; ++i) states.row(i) *= std::max(1.0, std::sqrt(std::abs(w2(i))));
  states.colwise().normalize();
  return dense::Lu<double>(states).rcond() > least;
}

// Relative error of alpha that moves no kept mode's exponents -b/2 +- sqrt(b^2/4 - w^2) by more than a thousandth of
// what is allowed: ds = d alpha/(2 sqrt|w^2 - b^2/4|).
double sufficient(const ScaledSystem& system, std::span<const Index> kept, double tolerance) {
  double smallest = 1;
  for (const Index s : kept) {
    const double w2 = system.K.c(s * (system.num_modes() + 1), 0).real(), b = system.G(s, s);
    const cplx root = std::sqrt(cplx(b * b / 4 - w2, 0));
    const double wanted = std::max(std::abs((-b / 2 + root).real()), 0.01);
    const double size = std::max(std::abs(w2), 1e-4);
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
constexpr double strong_resonance = 3e-3;

// Slaves the others to `together` and to the modes that pull at these, which are added to it until that converges;
// empty where too many would have to be kept. `diverges`: it is known that it does not with `together` alone. `start`
// serves the modes that it is of.
std::optional<ReducedSystem> slave_to_resonant(SampledStiffness& stiffness, std::vector<Index>& together,
                                               double tolerance, bool bounds_others, bool diverges,
                                               const SlavingStart& start = {}) {
  const ScaledSystem& system = stiffness.system();
  Index next = 0;
  const auto with_next = [&] {
    std::vector<Index> more = together;
    more.push_back(next);
    return more;
  };
  while (resonance_strength(system, together).maxCoeff(&next) > strong_resonance && !too_many(system, with_next()))
    together = with_next(), diverges = false;
  while (!too_many(system, together)) {
    if (!diverges) {
      ReducedSystem reduced = slave_to(stiffness, together, sufficient(system, together, tolerance), bounds_others,
                                       start.modes == together ? start : SlavingStart());
      if (reduced.converged) return reduced;
    }
    diverges = false;
    resonance_strength(system, together).maxCoeff(&next);
    together = with_next();
  }
  return std::nullopt;
}

// Exponents that are known better than those of a list take their place. A list that has lost them, because they decay
// too fast for it, gets them.
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
      list.imaginary_error[i] = pair.imaginary_error[p];
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

}  // namespace

void name_modes(Exponents& exponents, const VectorXd& w2, const VectorXd& b, const std::vector<Index>& group) {
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

ExponentSearch search_by_propagation(const ScaledSystem& system, double tolerance, bool leading_only) {
  const std::vector<Index> all = all_modes(system);
  ExponentSearch search;
  search.exponents = propagated_exponents(slave_to(system, all), tolerance, leading_only);
  name_modes(search.exponents, system, all);
  search.method = StabilityMethod::propagation;
  search.evidence = "all modes propagated over a turn by Radau IIA";
  search.kept = all;
  search.complete = true;
  return search;
}

namespace {

// One mode, which no other follows and which has the whole plane.
ExponentSearch search_single(const ScaledSystem& system, double tolerance, const Exponents& known) {
  const std::vector<Index> all{0};
  ExponentSearch search;
  search.exponents = reduced_exponents(slave_to(system, all), tolerance);
  if (search.exponents.s.empty()) return search_by_propagation(system, tolerance);
  name_modes(search.exponents, system, all);
  search.method = StabilityMethod::slaving;
  search.evidence = "one mode, its exponents from the phase function, Hill's determinant or one turn's propagation";
  search.complete = true;
  if (!may_be_twice(search.exponents)) sharpen(search.exponents, known);
  return search;
}

}  // namespace

ExponentSearch search_by_slaving(const ScaledSystem& system, double tolerance, const Exponents& known,
                                 std::span<const SlavingStart> starts) {
  const Index I = system.num_modes();
  if (I == 1) return search_single(system, tolerance, known);
  ExponentSearch search;
  const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  std::vector<Index> together;
  std::vector<Exponents> alone(std::size_t(I), Exponents{});
  std::vector<Slaved> slaved(std::size_t(I), Slaved{});
  std::vector<const Exponents*> lists{&search.exponents};
  std::vector<MatrixXd> subspaces(std::size_t(I), MatrixXd{});  // states at the start of the turn, per mode alone
  std::vector<SlavingStart> solved(std::size_t(I + 1), SlavingStart{});
  MatrixXd start_together(2 * I, 0);
  SampledStiffness stiffness(system);
  const bool begun = Index(starts.size()) == I + 1;
  bool diverged = false;  // the last of `together`
  for (Index g = 0; g < I; ++g) {
    if (begun && starts[std::size_t(g)].diverges) {
      solved[std::size_t(g)].diverges = diverged = true;
      together.push_back(g);
      continue;
    }
    const std::array<Index, 1> one{g};
    ReducedSystem reduced = slave_to(stiffness, one, sufficient(system, one, tolerance), false,
                                     begun ? starts[std::size_t(g)] : SlavingStart());
    if (reduced.converged) alone[std::size_t(g)] = reduced_exponents(reduced, tolerance);
    hb::name_modes(alone[std::size_t(g)], w2, b, {g});
    if (reduced.converged && !alone[std::size_t(g)].s.empty()) {
      slaved[std::size_t(g)] = {reduced.iteration_share, reduced.solved.amplification};
      lists.push_back(&alone[std::size_t(g)]);
      subspaces[std::size_t(g)] = std::move(reduced.start);
      solved[std::size_t(g)] = std::move(reduced.solved);
    } else {
      together.push_back(g);
      diverged = solved[std::size_t(g)].diverges = !reduced.converged;
    }
  }
  const ShiftedResonances resonances(w2, b);
  const auto widen = [&](Index g) { resonances.widen(slaved[std::size_t(g)], lists, alone[std::size_t(g)]); };
  search.method = StabilityMethod::slaving;
  if (!together.empty()) {
    if (const auto reduced = slave_to_resonant(stiffness, together, tolerance, false, diverged && together.size() == 1,
                                               begun ? starts.back() : SlavingStart())) {
      search.exponents = reduced_exponents(*reduced, tolerance);
      hb::name_modes(search.exponents, w2, b, together);
      start_together = reduced->start;
      solved.back() = reduced->solved;
      solved.back().modes = together;
      if (const Index kept = Index(together.size()); kept < I)
        resonances.widen({reduced->iteration_share, reduced->solved.amplification}, lists, search.exponents);
    } else {
      search = search_by_propagation(system, tolerance);
      for (Index g = 0; g < I; ++g) widen(g);
      for (const Exponents& pair : alone) sharpen(search.exponents, pair);
      search.solved = std::move(solved);
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
  for (Index g = 0; g < I; ++g) widen(g);
  search.exponents.reserve(std::size_t(2 * I));
  MatrixXd states(2 * I, 2 * I);
  states.leftCols(start_together.cols()) = start_together;
  Index filled = start_together.cols();
  for (Index g = 0; g < I; ++g)
    if (std::find(together.begin(), together.end(), g) == together.end()) {
      states.middleCols(filled, 2) = subspaces[std::size_t(g)];
      filled += 2;
      search.exponents.append(alone[std::size_t(g)]);
      search.exponents.converged = search.exponents.converged && alone[std::size_t(g)].converged;
    }
  search.solved = std::move(solved);
  // Subspaces are as far off as their exponents are from being told apart.
  constexpr double above_errors = 1e-8, well_apart = 1e-3;
  const bool apart = !may_be_twice(search.exponents);
  const double least = apart ? above_errors : well_apart;
  search.complete = add_up(system, search.exponents) && spans(system, std::move(states), least);
  if (search.complete && apart) sharpen(search.exponents, known);
  return search;
}

ExponentSearch search_by_hill(const ScaledSystem& system) {
  const HillExponents hill = hill_exponents(system);
  ExponentSearch search;
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

ExponentSearch search_by_determinant(const ScaledSystem& system) {
  ExponentSearch search;
  search.method = StabilityMethod::determinant;
  if (!system.diagonal_damping) {
    search.evidence = "Hill's determinant was not taken: the damping is not diagonal";
    return search;
  }
  const HillDeterminant determinant(system);
  search.exponents = determinant.exponents();
  if (search.exponents.s.empty() && !(search.exponents.others_below > -HUGE_VAL)) {
    search.evidence = "Hill's determinant was not found: it needs too many unknowns or does not settle";
    return search;
  }
  name_modes(search.exponents, system, all_modes(system));
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

std::optional<ExponentSearch> search_leading(const ScaledSystem& system, double tolerance,
                                             const std::vector<int>& keep) {
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
  SampledStiffness stiffness(system);
  if (const auto reduced = slave_to_resonant(stiffness, together, tolerance, true, false)) {
    ExponentSearch search;
    search.exponents = reduced_exponents(*reduced, tolerance, true);
    name_modes(search.exponents, system, together);
    double growth = -HUGE_VAL;
    for (std::size_t i = 0; i < search.exponents.s.size(); ++i)
      growth = std::max(growth, search.exponents.s[i].real() - search.exponents.error[i]);
    double& others = search.exponents.others_below;
    others = std::max(others, reduced->others_below);
    if (others < growth) {
      search.method = StabilityMethod::slaving;
      search.evidence = fmt::format("{} modes kept, the others slaved to them and bounded below the leading exponent",
                                    together.size());
      search.kept = together;
      search.complete = true;
      return search;
    }
  }
  if (I > most_modes_propagated) return std::nullopt;
  return search_by_propagation(system, tolerance, true);
}

ExponentSearch search_constant(const ScaledSystem& system) {
  const TurnExponents roots = constant_exponents(system);
  ExponentSearch search;
  search.exponents.s = roots.s;
  search.exponents.error = search.exponents.imaginary_error = roots.error;
  search.exponents.converged = true;
  name_modes(search.exponents, system, all_modes(system));
  search.method = StabilityMethod::hill;
  search.evidence = "constant coefficients: roots of the characteristic equation";
  search.complete = true;
  return search;
}

}  // namespace hb
