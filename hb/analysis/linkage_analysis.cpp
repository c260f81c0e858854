#include "hb/analysis/linkage_analysis.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/rod_steady.hpp"
#include "hb/analysis/theory_growth.hpp"
#include "hb/engine/steady/rough_state.hpp"
#include "lib/linkage/transmission_angle.hpp"
#include "lib/rod/shear.hpp"
#include "lib/stop_wish.hpp"
#include "lib/stopwatch.hpp"

namespace hb {
namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

bool wants_modes_error(const Only& only) { return only.steady || only.shape; }

const Body& link_of(const SceneModel& model, const RodModel& rod) { return *body_at(*model.linkage(), rod.link); }

const RodCoefficients& coefficients_of(const SceneModel& model, const RodModel& rod) {
  return model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
}

std::string steady_note(const SteadyState& state, Eigen::Index num_modes) {
  return fmt::format("{} modes, {} harmonics, {}, {} iterations", num_modes, state.num_harmonics,
                     method_text(state.method), state.iterations);
}

// Modes that the growth rate needs, hb/analysis/README.md (C2), (C3): the smallest number that leaves it within the
// tolerance, to `max_modes`. Where the growth rate of more modes is itself not known to the tolerance, more still would
// not tell: then the number with the smallest error.
Eigen::Index modes_for_growth(const SceneModel& model, const RodModel& rod, double speed, const Settings& settings,
                              RodResult& result, std::vector<Stage>& stages) {
  constexpr double safety = 2;
  StabilityOptions options = growth_comparison_options(settings);
  options.leading_only = true;
  options.verdict_only = false;
  Stopwatch watch;
  const auto growth = [&](Eigen::Index modes) {
    return analyse_stability(system_with(model, rod, modes), speed, options);
  };
  Eigen::Index best = rod.num_modes;
  double error = HUGE_VAL;
  const auto consider = [&](Eigen::Index modes, double its_error) {
    if (modes > max_modes || !(its_error < error) || error <= settings.tolerance) return;
    best = modes;
    error = its_error;
  };
  Eigen::Index I = rod.num_modes;
  Stability coarse = growth(I);
  double previous = HUGE_VAL;
  while (true) {
    const Eigen::Index more = comparison_modes(I);
    Stability fine = growth(more);
    const double change = std::abs(fine.growth_rate - coarse.growth_rate),
                 bars = fine.growth_error + coarse.growth_error;
    const bool shrinks = change <= previous / 2 && previous < HUGE_VAL;
    const auto square = [](Eigen::Index modes) { return static_cast<double>(modes * modes); };
    const double steps = shrinks ? 1 : std::max(1.0, (square(max_modes) - square(I)) / (square(more) - square(I)));
    const double scale = std::max(std::abs(fine.growth_rate), speed);
    consider(I, (safety * steps * change + bars) / scale);
    if (shrinks) consider(more, (change + bars) / scale);
    const bool tells = fine.growth_error <= settings.tolerance * scale;
    if (error <= settings.tolerance || I == max_modes || !tells) break;
    I = more_modes(I);
    coarse = I == more ? std::move(fine) : growth(I);
    previous = change;
  }
  result.growth_modes_error = error;
  stages.push_back({"modes for the growth rate of " + rod.name, watch.seconds(), fmt::format("{} modes", best)});
  return best;
}

// A response with more modes or harmonics than the one whose error the difference shows: begun at zero and a hundred
// times more accurate than is asked of that one, so that its own error is seen too; without a bound of its own. What is
// left of the load grows by the resonance.
SteadyState compared_response(const HillSystem& system, Eigen::Index num_modes, double speed, const Settings& settings,
                              int num_harmonics = 0) {
  constexpr double most = 1e-6, better = 1e-2, least = 1e-14;
  SteadyOptions options = response_options(settings);
  options.without_bound = true;
  options.num_harmonics = num_harmonics;
  options.tolerance =
      std::max(least, std::min(most, better * settings.tolerance) / nearest_amplification(system, speed));
  return solve_rod(system, num_modes, speed, options);
}

// Steady state with I modes, and the error of its cut where asked; in auto mode the number of modes grows until that
// error is within the tolerance or `max_modes` is reached.
void solve_steady(const SceneModel& model, const RodModel& rod, double speed, const Settings& settings, bool with_cut,
                  Eigen::Index I, RodResult& result, std::vector<Stage>& stages) {
  SteadyOptions options = response_options(settings);
  const bool grows = is_auto(settings.modes) && rod.link >= 0;
  const Eigen::Index first = I;
  SteadyState state;
  const auto solve = [&] {
    Stopwatch watch;
    state = solve_rod(system_with(model, rod, I), I, speed, options);
    stages.push_back({"steady state of " + rod.name, watch.seconds(), steady_note(state, I)});
    return state.status != SteadyStatus::singular;
  };
  if (solve() && rod.link >= 0 && (with_cut || grows)) {
    const Body& link = link_of(model, rod);
    const RodCoefficients& coefficients = coefficients_of(model, rod);
    FourierSeries q = state.q;
    while (true) {
      Stopwatch finer_watch;
      const Eigen::Index more = comparison_modes(I);
      SteadyState finer = compared_response(system_with(model, rod, more), more, speed, settings);
      if (finer.status == SteadyStatus::singular) break;
      result.cut = cut_error(link, coefficients, speed, q, finer.q);
      result.more_modes = finer.q;
      stages.push_back({"error of the cut of " + rod.name, finer_watch.seconds(), steady_note(finer, more)});
      if (!grows || result.cut->deflection <= settings.tolerance || I == max_modes) break;
      I = more_modes(I);
      q = I == more ? std::move(finer.q) : compared_response(system_with(model, rod, I), I, speed, settings).q;
      if (q.c.size() == 0) break;
    }
    options.start = std::move(q);
    if (I != first && !solve()) {
      result.cut.reset();
      result.more_modes = {};
    }
  }
  result.num_modes = I;
  for (Eigen::Index i = 0; i < state.q.num_components(); ++i) {
    end_if_wished();
    result.max_abs.push_back(fourier::max_abs(state.q, i));
  }
  result.steady = std::move(state);
}

// The steady state of a rod once more, with half as many harmonics again.
FourierSeries with_more_harmonics(const SceneModel& model, const RodModel& rod, double speed, const Settings& settings,
                                  const RodResult& result) {
  const int most = response_options(settings).max_harmonics;
  const SteadyState state = compared_response(system_with(model, rod, result.num_modes), result.num_modes, speed,
                                              settings, std::min(most, result.steady->num_harmonics * 3 / 2 + 8));
  return state.status == SteadyStatus::singular ? result.steady->q : state.q;
}

std::string unresolved_text(const Scene& scene, const LinkageCoefficients& coefficients, TransmissionAngle worst,
                            std::size_t dyad) {
  const Linkage& linkage = std::get<Linkage>(scene.model);
  return fmt::format(
      "{}: tolerance not reached: dyad {} ({}, {}) passes within {:.3g} deg of a dead centre at crank angle {:.4g} "
      "deg, "
      "nearer than {} crank angles a turn, the limit, can show: Fourier coefficients of {:.1e} of the largest are left "
      "over, allowed 1e-10. Nothing was computed; `hb scene` draws the linkage",
      scene.file.string(), dyad + 1, linkage.dyads[dyad].coupler.name,
      body_name(linkage, closing_index(static_cast<int>(dyad))), worst.smallest * degrees_per_radian,
      worst.crank_angle * degrees_per_radian, coefficients.num_samples, coefficients.tail);
}

[[noreturn]] void refuse_unresolved(const Scene& scene, const LinkageCoefficients& coefficients) {
  const Linkage& linkage = std::get<Linkage>(scene.model);
  std::size_t dyad = 0;
  TransmissionAngle worst = transmission_angle(linkage, 0);
  for (std::size_t d = 1; d < linkage.dyads.size(); ++d) {
    const TransmissionAngle angle = transmission_angle(linkage, static_cast<int>(d));
    if (!(angle.smallest < worst.smallest)) continue;
    dyad = d;
    worst = angle;
  }
  throw UnresolvedLinkage(unresolved_text(scene, coefficients, worst, dyad), static_cast<int>(dyad), worst.crank_angle);
}

std::vector<std::string> shortfalls_of(const RodResult& rod, const Settings& settings) {
  std::vector<std::string> sentences;
  if (rod.steady) {
    if (rod.steady->status == SteadyStatus::singular) {
      sentences.push_back(
          fmt::format("{}: no unique periodic solution at this speed (resonance without damping)", rod.name));
    } else if (!(rod.steady->error_bound <= settings.tolerance)) {
      sentences.push_back(fmt::format("{}: the steady state's error bound {:.1e} exceeds the tolerance {:.1e}",
                                      rod.name, rod.steady->error_bound, settings.tolerance));
    }
  }
  if (is_auto(settings.modes) && rod.cut && !(rod.cut->deflection <= settings.tolerance)) {
    sentences.push_back(fmt::format("{}: with {} modes the error of the cut is {:.1e}, above the tolerance {:.1e}",
                                    rod.name, rod.num_modes, rod.cut->deflection, settings.tolerance));
  }
  if (rod.growth_modes_error && !(*rod.growth_modes_error <= settings.tolerance)) {
    sentences.push_back(
        fmt::format("{}: with {} modes the growth rate's error of the cut is {:.1e} of the larger of "
                    "itself and the speed, above the tolerance {:.1e}",
                    rod.name, rod.growth_modes, *rod.growth_modes_error, settings.tolerance));
  }
  return sentences;
}

// The tolerance is that of q: what is less known of the growth rate stands in its error and decides its verdict.
std::vector<std::string> notes_of(const RodResult& rod) {
  if (!rod.stability || rod.stability->converged || rod.stability->method == StabilityMethod::bound) return {};
  if (!std::isfinite(rod.stability->growth_rate)) return {fmt::format("{}: no growth rate was found", rod.name)};
  return {fmt::format("{}: the growth rate is known to {:.1e} only", rod.name, rod.stability->growth_error)};
}

// Joint forces with their errors, where they are asked for and every rod has a periodic solution.
void add_forces(const SceneModel& model, double speed, const Settings& settings, SpeedResult& result) {
  std::vector<Stage>& stages = result.stages;
  if (!result.computed.reactions) {
    if (model.linkage()) stages.push_back({"joint forces", 0, "not asked for", true});
    return;
  }
  for (const RodResult& rod : result.rods) {
    if (rod.steady->status != SteadyStatus::singular) continue;
    stages.push_back({"joint forces", 0, rod.name + " has no periodic solution", true});
    return;
  }
  Stopwatch watch;
  std::vector<LinkResponse> responses, more_modes;
  double response_error = 0;
  for (const RodResult& rod : result.rods) {
    responses.push_back({rod.link, rod.steady->q});
    more_modes.push_back({rod.link, rod.more_modes.c.size() > 0 ? rod.more_modes : rod.steady->q});
    response_error = std::max(response_error, rod.steady->error_bound);
  }
  result.forces = joint_forces(*model.influence, speed, responses);
  stages.push_back({"joint forces", watch.seconds(), ""});
  Stopwatch error_watch;
  std::vector<LinkResponse> more_harmonics;
  for (std::size_t r = 0; r < model.rods.size(); ++r)
    more_harmonics.push_back(
        {result.rods[r].link, with_more_harmonics(model, model.rods[r], speed, settings, result.rods[r])});
  result.force_errors = force_errors(*model.influence, speed, *result.forces, largest_of(*result.forces),
                                     response_error, responses, more_harmonics, more_modes);
  stages.push_back({"error of the joint forces", error_watch.seconds(), ""});
}

// What the exact model would change of the growth rate, where all rods' exponents were computed.
void judge_growth(const SceneModel& model, double speed, std::span<const LinearRod> rods, SpeedResult& result) {
  if (!std::ranges::all_of(result.rods, [](const RodResult& rod) { return rod.stability.has_value(); })) return;
  Stopwatch watch;
  result.theory->growth = growth_theory_error(*model.linkage(), speed, rods, *result.theory);
  result.stages.push_back({"theory error of the growth rate", watch.seconds(), ""});
}

// What the exact model would change, where q was computed.
void judge_theory(const SceneModel& model, double speed, SpeedResult& result) {
  if (!model.linkage() || result.rods.empty()) return;
  if (!result.computed.response()) {
    result.stages.push_back({"theory error", 0, "q was not asked for", true});
    return;
  }
  Stopwatch watch;
  std::vector<Eigen::Index> modes;
  for (const RodResult& rod : result.rods) modes.push_back(rod.num_modes);
  std::vector<HillSystem> systems(modes.size());
  std::vector<LinearRod> rods;
  for (std::size_t r = 0; r < modes.size(); ++r) {
    const bool as_made = modes[r] == model.rods[r].num_modes;
    if (!as_made) systems[r] = system_with(model, model.rods[r], modes[r]);
    rods.push_back({as_made ? &model.rods[r].system : &systems[r], &result.rods[r].steady->q});
  }
  const JointForces* forces = result.forces ? &*result.forces : nullptr;
  const bool as_made =
      model.exact && std::ranges::equal(modes, model.exact->rods(), {}, {}, &ExactModel::Rod::num_modes);
  result.theory = as_made ? theory_errors(*model.exact, speed, rods, forces)
                          : theory_errors(theory_model(*model.linkage(), modes), speed, rods, forces);
  result.stages.push_back({"theory error", watch.seconds(), result.theory->reason});
  judge_growth(model, speed, rods, result);
  if (!model.exact) return;
  Stopwatch share_watch;
  const std::vector<double> shares = axial_shares(*model.exact);
  for (std::size_t r = 0; r < modes.size(); ++r) result.theory->rods[r].axial_share = shares[r];
  result.stages.push_back({"share of axial elasticity", share_watch.seconds(), ""});
}

}  // namespace

Only available(const SceneModel& model, Only only) {
  if (!model.linkage()) only.reactions = only.shape = false;
  return only;
}

HillSystem system_with(const SceneModel& model, const RodModel& rod, Eigen::Index num_modes) {
  const Eigen::Index unknowns = rod.link >= 0 ? num_unknowns(link_of(model, rod), num_modes) : num_modes;
  if (unknowns == rod.system.num_modes()) return rod.system;
  if (unknowns == rod.finer.num_modes()) return rod.finer;
  return ritz_system(link_of(model, rod), coefficients_of(model, rod), num_modes);
}

const char* method_text(SteadyMethod method) {
  switch (method) {
    case SteadyMethod::direct:
      return "direct";
    case SteadyMethod::iterative:
      return "iterative";
    case SteadyMethod::automatic:
      break;
  }
  return "automatic";
}

void require_resolved(const Scene& scene, const LinkageCoefficients& coefficients) {
  if (!coefficients.resolved) refuse_unresolved(scene, coefficients);
}

SceneModel make_model(Scene scene, const Settings& settings, bool compares_modes) {
  SceneModel model;
  model.scene = std::move(scene);
  Stopwatch watch;
  std::vector<std::string> names;
  if (const auto* hill = std::get_if<HillSystem>(&model.scene.model)) {
    RodModel rod;
    rod.name = "system";
    rod.num_modes = hill->num_modes();
    rod.system = *hill;
    names.push_back(rod.name);
    model.rods.push_back(std::move(rod));
  } else {
    const Linkage& linkage = *model.linkage();
    for (const int link : elastic_links(linkage)) {
      RodModel rod;
      rod.name = body_name(linkage, link);
      rod.link = link;
      names.push_back(rod.name);
      model.rods.push_back(std::move(rod));
    }
  }

  for (const std::string& name : settings.rods) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw RequestError(
          "rods", fmt::format("\"{}\"", name),
          names.empty() ? "nothing, the scene has no elastic links" : fmt::format("{}", fmt::join(names, ", ")));
    }
  }
  if (!settings.rods.empty()) {
    const auto asked = [&](const RodModel& rod) {
      return std::find(settings.rods.begin(), settings.rods.end(), rod.name) != settings.rods.end();
    };
    // Joint forces carry the vibration of every rod, reported or not, so does what bending does to the mechanism, and
    // the mechanism is stable where every rod is.
    const bool all_needed = model.linkage() && (settings.only.response() || settings.only.stability);
    for (RodModel& rod : model.rods) {
      rod.reported = asked(rod);
      if (!rod.reported && !all_needed) {
        model.stages.push_back({"rod " + rod.name, 0, "not asked for", true});
      }
    }
    if (!all_needed) std::erase_if(model.rods, [](const RodModel& rod) { return !rod.reported; });
  }

  if (const Linkage* linkage = model.linkage()) model.influence = std::make_shared<const InfluenceTable>(*linkage);
  if (const Linkage* linkage = model.linkage(); linkage && !model.rods.empty()) {
    model.coefficients = linkage_coefficients(*linkage);
    require_resolved(model.scene, model.coefficients);
    model.stages.push_back(
        {"coefficients of the geometry", watch.seconds(),
         fmt::format("{} crank angles, tail {:.1e}", model.coefficients.num_samples, model.coefficients.tail)});
    Stopwatch ritz_watch;
    const std::vector<int>& links = model.coefficients.links;
    for (RodModel& rod : model.rods) {
      rod.coefficients = static_cast<int>(std::find(links.begin(), links.end(), rod.link) - links.begin());
      const Body& link = link_of(model, rod);
      const Eigen::Index I = start_modes(settings.modes);
      rod.num_modes = I;
      rod.system = ritz_system(link, coefficients_of(model, rod), I);
      if (compares_modes && rod.reported && wants_modes_error(settings.only)) {
        rod.finer = ritz_system(link, coefficients_of(model, rod), comparison_modes(I));
      }
    }
    model.stages.push_back({"Ritz matrices", ritz_watch.seconds(), ""});
    if (settings.only.response() && !is_auto(settings.modes))
      model.exact = std::make_shared<const ExactModel>(
          theory_model(*linkage, std::vector<Eigen::Index>(model.rods.size(), start_modes(settings.modes))));
  }
  return model;
}

SpeedResult analyse(const SceneModel& model, double speed, const Settings& settings, bool one_number) {
  SpeedResult result;
  result.speed = speed;
  const Only only = result.computed = available(model, settings.only);
  std::vector<Stage>& stages = result.stages;
  const bool auto_modes = is_auto(settings.modes);

  for (const RodModel& rod : model.rods) {
    RodResult entry;
    entry.name = rod.name;
    entry.link = rod.link;
    entry.reported = rod.reported;
    entry.num_modes = rod.num_modes;
    entry.growth_alone = only.stability && !only.all_exponents();
    const bool shows_cut = rod.reported && wants_modes_error(only);
    if (only.stability) entry.growth_modes = rod.num_modes;
    if (auto_modes && rod.link >= 0 && only.stability) {
      entry.growth_modes = modes_for_growth(model, rod, speed, settings, entry, stages);
      if (only.verdict) entry.growth_modes_error.reset();
      if (one_number || !only.response()) entry.num_modes = entry.growth_modes;
    }
    if (only.response()) {
      solve_steady(model, rod, speed, settings, shows_cut || only.reactions, entry.num_modes, entry, stages);
      if (!shows_cut) entry.cut.reset();
      if (one_number && only.stability) entry.growth_modes = entry.num_modes;
    } else {
      stages.push_back({"steady state of " + rod.name, 0, "not asked for", true});
    }
    const bool solved = entry.steady && entry.steady->status != SteadyStatus::singular;

    if (!only.shape || !rod.reported) {
      if (rod.link >= 0) stages.push_back({"shape of " + rod.name, 0, "not asked for", true});
    } else if (solved) {
      Stopwatch watch;
      entry.shape = rod_shape(link_of(model, rod), coefficients_of(model, rod), speed, entry.steady->q);
      std::optional<double> moment_error;
      if (entry.cut) {
        entry.peak_errors = peak_errors(link_of(model, rod), *entry.shape, entry.num_modes,
                                        std::ranges::max(entry.max_abs, {}, &Extremum::value).value,
                                        entry.steady->error_bound, *entry.cut);
        moment_error = entry.peak_errors->bending_moment;
      }
      entry.stress = rod_stress(link_of(model, rod), coefficients_of(model, rod), model.coefficients.tail, speed,
                                entry.shape->bending_moment.max_abs, moment_error);
      stages.push_back({"shape of " + rod.name, watch.seconds(), ""});
    }

    if (!only.stability) {
      stages.push_back({"stability of " + rod.name, 0, "not asked for", true});
    } else {
      const StabilityOptions options = exponent_options(settings);
      Stopwatch watch;
      const HillSystem system = system_with(model, rod, entry.growth_modes);
      entry.num_exponents = 2 * system.num_modes();
      entry.stability = analyse_stability(system, speed, options);
      stages.push_back({"stability of " + rod.name, watch.seconds(), entry.stability->evidence});
      if (!only.all_exponents()) stages.push_back({"further exponents of " + rod.name, 0, "not asked for", true});
    }
    for (std::string& sentence : shortfalls_of(entry, settings)) result.shortfalls.push_back(std::move(sentence));
    for (std::string& sentence : notes_of(entry)) result.notes.push_back(std::move(sentence));
    result.rods.push_back(std::move(entry));
  }

  add_forces(model, speed, settings, result);
  judge_theory(model, speed, result);
  return result;
}

}  // namespace hb
