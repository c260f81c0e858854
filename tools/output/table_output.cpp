#include "tools/output/table_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <iterator>
#include <optional>

#include "tools/output/output_units.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

constexpr std::size_t max_exponents_shown = 4;
constexpr std::size_t max_modes_shown = 10;

using Text = fmt::memory_buffer;

template <class... Args>
void add(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

void add_steady(Text& text, const RodResult& rod, const OutputUnits& units, bool is_rod, double tolerance) {
  const SteadyState& state = *rod.steady;
  if (state.status == SteadyStatus::singular) {
    add(text, "  no unique periodic solution at this speed: resonance without damping\n");
    return;
  }
  add(text, "  q_i: {}\n", is_rod ? "amplitude of sin(i pi x/l), largest over the turn" : "largest over the period");
  add(text, "    {:>3}  {:>18}  {:>18}\n", "i", "max |q_i|" + bracketed(units.response), "crank angle [deg]");
  const std::size_t shown = std::min(rod.max_abs.size(), max_modes_shown);
  for (std::size_t i = 0; i < shown; ++i) {
    add(text, "    {:>3}  {:>18.10g}  {:>18.3f}\n", i + 1, rod.max_abs[i].value,
        rod.max_abs[i].crank_angle * degrees_per_radian);
  }
  if (shown < rod.max_abs.size()) add(text, "    ... {} more (--json has all)\n", rod.max_abs.size() - shown);
  add(text, "  error bound       {:.1e} of the largest |q|{}{}\n", state.error_bound,
      state.bound == SteadyBound::proved ? ", proved" : "",
      state.error_bound <= tolerance ? "" : fmt::format("  NOT REACHED: asked {:.1e}", tolerance));
  add(text, "  resonance         {:.3g} away (1: far, 0: at resonance)\n", state.resonance_distance);
}

void add_theory(Text& text, const std::optional<TheoryErrors>& errors, std::size_t r) {
  if (!errors) {
    add(text, "  theory error      not judged: q was not computed\n");
    return;
  }
  const TheoryErrors::Rod& rod = errors->rods[r];
  if (!rod.q) {
    add(text, "  theory error      no value: {}; BEYOND THE LINEAR THEORY\n", errors->reason);
    return;
  }
  add(text, "  theory error      {:.1e} of the largest |q|, first nonlinear correction{}\n", *rod.q,
      beyond_theory(rod.q) ? "; BEYOND THE LINEAR THEORY" : "");
  if (rod.axial_share)
    add(text, "    of it           {:.1g} would be taken away by axial elasticity, which it leaves out, estimated\n",
        *rod.axial_share);
}

void add_peak(Text& text, const char* name, const RodPeak& peak, double factor, const std::string& unit,
              const OutputUnits& units) {
  add(text, "  {:<16}  {:.8g} {} at x = {:.5g} {}, crank angle {:.3f} deg\n", name, peak.max_abs * factor, unit, peak.x,
      units.length, peak.crank_angle * degrees_per_radian);
}

// The first few; of a conjugate pair the first stands for both.
void add_exponents(Text& text, const std::vector<Exponent>& exponents, const char* mark) {
  std::vector<bool> done(exponents.size(), false);
  std::size_t shown = 0, left = 0;
  for (std::size_t k = 0; k < exponents.size(); ++k) {
    if (done[k]) continue;
    if (shown == max_exponents_shown) {
      ++left;
      continue;
    }
    ++shown;
    const Exponent& exponent = exponents[k];
    bool pair = false;
    for (std::size_t other = k + 1; other < exponents.size() && exponent.value.imag() != 0 && !pair; ++other) {
      pair = !done[other] && exponents[other].value == std::conj(exponent.value);
      if (pair) done[other] = true;
    }
    const double re = exponent.value.real() + 0.0, im = exponent.value.imag() + 0.0;
    const auto digits = [&](double value) { return trusted_digits(value, exponent.error); };
    add(text, "  {:>16}  {:>18}  {:>18}  {:>8.1e}\n", mark, fmt::format("{:.{}g}", re, digits(re)),
        fmt::format("{}{:.{}g}", pair ? "+-" : "", pair ? std::abs(im) : im, digits(im)), exponent.error);
  }
  if (left > 0) add(text, "    ... {} more (--json has all)\n", left);
}

void add_stability(Text& text, const RodResult& rod, double speed, const Scene& scene) {
  const Stability& stability = *rod.stability;
  const OutputUnits units = output_units(scene);
  if (!stability.exponents.empty() || !stability.uncertain.empty())
    add(text, "  {:<16}  {:>18}  {:>18}  {:>8}\n", fmt::format("exponents [{}]", units.rate), "real part",
        "imaginary part", "error");
  add_exponents(text, stability.exponents, "");
  if (const Eigen::Index missing = unresolved_exponents(rod); missing > 0) {
    add(text, "    {} of {} not resolved to a part in 10^6{}\n", missing, rod.num_exponents,
        stability.uncertain.empty() ? "" : ":");
    add_exponents(text, stability.uncertain, "?");
  }
  add(text, "  growth rate       {} {}{}\n", growth_text(stability), units.rate,
      stability.converged ? "" : "  NOT REACHED");
  if (rod.growth_modes_error)
    add(text, "  its cut           {:.1e} of the larger of itself and the speed, estimated\n", *rod.growth_modes_error);
  add(text, "  {}\n", verdict_sentence(stability, speed, scene.units));
}

std::string range_text(const FourierSeries& series, Eigen::Index component, double factor) {
  const Range range = fourier::range(series, component);
  return fmt::format("{:>12.6g} .. {:<12.6g}", range.min.value * factor, range.max.value * factor);
}

void add_forces(Text& text, const Linkage& linkage, const JointForces& forces, const std::optional<ForceErrors>& errors,
                const OutputUnits& units) {
  add(text,
      "Joint forces, smallest .. largest over the turn. {};\n"
      "LINK.1 acts on the link, LINK.0 is passed on to the link before it, pivots and guides act on their link.\n",
      force_frames(elastic_rockers(linkage)));
  add(text, "  {:<22}  {:^28}  {:^28}\n", "[N]", "rigid", "elastic");
  for (const JointForce& joint : forces.joints) {
    for (Eigen::Index c = 0; c < joint.rigid.num_components(); ++c) {
      const char* component = joint.rigid.num_components() == 1 ? "n" : c == 0 ? "x" : "y";
      add(text, "  {:<20} {}  {}  {}\n", c == 0 ? joint.name : "", component, range_text(joint.rigid, c, units.force),
          range_text(joint.elastic, c, units.force));
    }
  }
  add(text, "  {:<22}  {}  {}\n", "driving torque [N m]", range_text(forces.torque_rigid, 0, units.moment),
      range_text(forces.torque, 0, units.moment));
  if (!errors) return;
  add(text, "  estimated errors: forces {:.1e} of the largest, torque {:.1e}", errors->force, errors->torque);
  if (errors->force_cut > 0 || errors->torque_cut > 0)
    add(text, "; from the cut of the modes {:.1e} and {:.1e}", errors->force_cut, errors->torque_cut);
  add(text, "\n");
}

// "unstable because of AB", "stable (AB, CD)": the worst of all rods, and which of them were not looked at.
std::string verdict_of_all(const std::vector<RodResult>& rods) {
  std::vector<Verdict> verdicts;
  for (const RodResult& rod : rods) {
    if (rod.stability) verdicts.push_back(rod.stability->verdict);
  }
  std::vector<std::string> names, others;
  const Verdict verdict = worst(verdicts);
  for (const RodResult& rod : rods) {
    if (!rod.stability) others.push_back(rod.name);
    if (rod.stability && rod.stability->verdict == verdict) names.push_back(rod.name);
  }
  const bool all = verdict == Verdict::stable || verdict == Verdict::bounded;
  const std::string because = fmt::format(fmt::runtime(all ? "({})" : "because of {}"), fmt::join(names, ", "));
  return fmt::format("{} {}{}", to_string(verdict), because,
                     others.empty() ? "" : fmt::format("; not looked at: {}", fmt::join(others, ", ")));
}

}  // namespace

std::string steady_table(const SceneModel& model, const SpeedResult& result, const Settings& settings) {
  const Scene& scene = model.scene;
  const OutputUnits units = output_units(scene);
  const bool is_linkage = model.linkage() != nullptr;
  Text text;
  add(text, "{}: {}", scene_name(scene), speed_text(result.speed, scene));
  if (is_linkage) add(text, " (omega = {:.10g} rad/{})", result.speed, units.time);
  add(text, "\n\n");
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const RodResult& rod = result.rods[r];
    if (!rod.reported) continue;
    add(text, "{}: {} {}", rod.name, rod.num_modes,
        is_linkage ? (rod.num_modes == 1 ? "mode" : "modes") : (rod.num_modes == 1 ? "unknown" : "unknowns"));
    if (rod.steady && result.computed.steady) add(text, ", {} harmonics", rod.steady->num_harmonics);
    add(text, "\n");
    if (rod.steady && result.computed.steady) add_steady(text, rod, units, is_linkage, settings.tolerance);
    if (is_linkage) add_theory(text, result.theory, r);
    if (rod.modes_error) {
      add(text, "  error of the cut  {:.1e} of the largest deflection, estimated{}\n", *rod.modes_error,
          !needs_more_modes(rod) ? "" : "; MORE MODES ARE NEEDED (--modes)");
    }
    if (rod.shape) {
      add_peak(text, "deflection", rod.shape->deflection, 1, units.length, units);
      add_peak(text, "bending moment", rod.shape->bending_moment, units.moment, "N m", units);
    }
    if (rod.stability) add_stability(text, rod, result.speed, scene);
    add(text, "\n");
  }
  if (result.rods.empty() && is_linkage) add(text, "No elastic links: rigid joint forces only.\n\n");
  if (result.forces) {
    add_forces(text, *model.linkage(), *result.forces, result.force_errors, units);
    if (result.theory && result.theory->force)
      add(text, "  theory errors: forces {:.1e} of the largest, torque {:.1e}\n", *result.theory->force,
          *result.theory->torque);
    const bool unstable = std::any_of(result.rods.begin(), result.rods.end(), [](const RodResult& rod) {
      return rod.stability && rod.stability->verdict == Verdict::unstable;
    });
    if (unstable) add(text, "  The elastic values belong to an unstable periodic state.\n");
  }
  for (const std::string& sentence : result.shortfalls) add(text, "NOT REACHED: {}\n", sentence);
  for (const std::string& warning : scene.warnings) add(text, "WARNING: {}\n", warning);
  for (const std::string& warning : theory_warnings(model, result)) add(text, "WARNING: {}\n", warning);
  if (result.computed.stability && !result.rods.empty()) add(text, "\nVerdict: {}\n", verdict_of_all(result.rods));
  return fmt::to_string(text);
}

std::string stages_table(const std::vector<Stage>& stages) {
  Text text;
  for (const Stage& stage : stages) {
    if (stage.skipped) {
      add(text, "  {:<28} {:>12}  {}\n", stage.name, "skipped", stage.note);
    } else {
      add(text, "  {:<28} {:>9.1f} us  {}\n", stage.name, stage.seconds * 1e6, stage.note);
    }
  }
  return fmt::to_string(text);
}

}  // namespace hb::tools
