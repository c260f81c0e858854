#include "tools/output/table_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/nearest_resonance.hpp"
#include "tools/output/machine_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/shape_rows.hpp"
#include "tools/output/stress_words.hpp"
#include "tools/output/text.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

constexpr std::size_t max_modes_shown = 10;

// How far the speed is from where a natural frequency is met, and what that does to the response.
void add_resonance(Text& text, const SceneModel& model, const RodModel& rod_model, const RodResult& rod, double speed) {
  const std::optional<NearestResonance> nearest = nearest_resonance(rod_model.system, speed);
  const int highest = highest_harmonic(*rod.steady);
  if (nearest && nearest->order > highest)
    add(text, "  resonance         none: omega_1 is about {} Omega, the response has {}\n", nearest->order,
        highest == 0 ? "no harmonics"
                     : fmt::format("harmonics up to {}Omega", highest == 1 ? "" : fmt::format("{} ", highest)));
  else if (nearest)
    add(text, "  resonance         nearest {}Omega = omega_1 at {}, {:.2g} % {}\n",
        nearest->order == 1 ? "" : fmt::format("{} ", nearest->order), speed_text(nearest->speed, model.scene, 6),
        100 * std::abs(nearest->speed / speed - 1), nearest->speed > speed ? "faster" : "slower");
  if (const std::optional<double> slow = quasi_static_response(rod_model.system, rod_model.num_modes, speed)) {
    double largest = 0;
    for (const Extremum& peak : rod.max_abs) largest = std::max(largest, peak.value);
    add(text, "  amplification     {:.4g}: largest |q| against that of the same load applied slowly\n",
        largest / *slow);
  }
}

void add_steady(Text& text, const SceneModel& model, std::size_t r, const SpeedResult& result, double tolerance) {
  const RodResult& rod = result.rods[r];
  const OutputUnits units = output_units(model.scene);
  const bool is_rod = model.linkage() != nullptr;
  const SteadyState& state = *rod.steady;
  if (state.status == SteadyStatus::singular) {
    add(text, "  no unique periodic solution at this speed: resonance without damping\n");
    return;
  }
  add(text, "  q_i: {}\n", is_rod ? "amplitude of sin(i pi x/l), largest over the turn" : "largest over the period");
  add(text, "    {:>3}  {:>18}  {:>18}\n", "i", "max |q_i|" + bracketed(units.response),
      is_rod ? "crank angle [deg]" : "phase [deg]");
  const std::size_t shown = std::min(rod.max_abs.size(), max_modes_shown);
  double largest = 0;
  for (const Extremum& peak : rod.max_abs) largest = std::max(largest, peak.value);
  for (std::size_t i = 0; i < shown; ++i) {
    const double value = rod.max_abs[i].value;
    add(text, "    {:>3}  {:>18.{}g}  {:>18.3f}\n", i + 1, value, trusted_digits(value, state.error_bound * largest),
        rod.max_abs[i].crank_angle * degrees_per_radian);
  }
  if (shown < rod.max_abs.size()) add(text, "    ... {} more (--json has all)\n", rod.max_abs.size() - shown);
  add(text, "  error bound       {:.1e} of the largest |q|{}{}\n", state.error_bound,
      state.bound == SteadyBound::proved ? ", proved" : "",
      state.error_bound <= tolerance ? "" : fmt::format("  NOT REACHED: asked {:.1e}", tolerance));
  add_resonance(text, model, model.rods[r], rod, result.speed);
}

// One digit: "about 3 %", "about 20 %", "less than 0.1 %", "half or more".
std::string rough_share(double share) {
  const double percent = 100 * share;
  if (!(percent < 50)) return "half or more";
  if (percent < 0.1) return "less than 0.1 %";
  return percent < 9.5 ? fmt::format("about {:.1g} %", percent)
                       : fmt::format("about {:.0f} %", 10 * std::round(percent / 10));
}

void add_theory(Text& text, const std::optional<TheoryErrors>& errors, std::size_t r) {
  if (!errors) {
    add(text, "  {}\n", not_judged);
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
    add(text, "    of it           {} would be changed by axial elasticity, which it leaves out; a rough estimate\n",
        rough_share(*rod.axial_share));
}

std::string growth_theory_row(const SpeedResult& result, const OutputUnits& units) {
  if (!result.theory || !result.theory->growth) return "";
  double rate = -HUGE_VAL;
  for (const RodResult& rod : result.rods) rate = std::max(rate, rod.stability->growth_rate);
  return fmt::format("  theory error of the growth rate of all rods: {:.1e} {}{}\n", *result.theory->growth, units.rate,
                     *result.theory->growth < std::abs(rate) ? "" : ", not less than the rate itself");
}

void add_stability(Text& text, const SceneModel& model, std::size_t r, const SpeedResult& result, bool multipliers) {
  const Scene& scene = model.scene;
  const RodResult& rod = result.rods[r];
  const double speed = result.speed;
  const Stability& stability = *rod.stability;
  const OutputUnits units = output_units(scene);
  add(text, "{}", exponents_rows(stability, unresolved_exponents(rod), speed, scene));
  if (multipliers) add(text, "{}", multipliers_rows(stability, speed, scene));
  add(text, "  growth rate       {}\n", growth_text(stability, units.rate));
  if (rod.growth_modes_error)
    add(text, "  its cut           {:.1e} of the larger of itself and the speed, estimated\n", *rod.growth_modes_error);
  std::vector<DisturbanceLine> lines;
  if (stability.verdict == Verdict::unstable && !stability.exponents.empty())
    lines = disturbance_lines(system_with(model, model.rods[r], rod.growth_modes), speed, stability.exponents.front());
  add(text, "  {}\n", verdict_sentence(stability, speed, scene, lines));
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

}  // namespace

std::string steady_table(const SceneModel& model, const SpeedResult& result, const Settings& settings,
                         bool multipliers) {
  const Scene& scene = model.scene;
  const OutputUnits units = output_units(scene);
  const bool is_linkage = model.linkage() != nullptr;
  Text text;
  const std::string verdict = mechanism_verdict(named_verdicts(result.rods));
  add(text, "{}, {}{}{}\n", scene_name(scene), speed_text(result.speed, scene), verdict.empty() ? "" : ": ", verdict);
  if (is_linkage) add(text, "omega = {:.10g} rad/{}\n", result.speed, units.time);
  add(text, "\n");
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const RodResult& rod = result.rods[r];
    if (!rod.reported) continue;
    add(text, "{}: {} {}", rod.name, rod.num_modes,
        is_linkage ? (rod.num_modes == 1 ? "mode" : "modes") : (rod.num_modes == 1 ? "unknown" : "unknowns"));
    if (rod.steady && result.computed.steady) add(text, ", {} harmonics", rod.steady->num_harmonics);
    if (rod.stability && rod.growth_modes != rod.num_modes)
      add(text, "; exponents with {} {}", rod.growth_modes, rod.growth_modes == 1 ? "mode" : "modes");
    add(text, "\n");
    if (rod.steady && result.computed.steady) add_steady(text, model, r, result, settings.tolerance);
    if (is_linkage) add_theory(text, result.theory, r);
    if (rod.cut) {
      add(text, "  error of the cut  {:.1e} of the largest deflection, estimated{}\n", rod.cut->deflection,
          !needs_more_modes(rod) ? "" : "; MORE MODES ARE NEEDED (--modes)");
    }
    if (rod.shape) {
      add(text, "{}", deflection_row(rod.shape->deflection, rod.peak_errors, units));
      add(text, "{}", static_row(model, result, r));
      add(text, "{}", moment_row(rod.shape->bending_moment, rod.peak_errors, units));
    }
    if (rod.stress) add(text, "{}", stress_lines(*rod.stress, *body_at(*model.linkage(), rod.link), units));
    add(text, "{}", stress_rows(model, result, r));
    if (rod.stability) add_stability(text, model, r, result, multipliers);
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
    add(text, "{}", machine_rows(model, result));
    if (unstable) add(text, "  The elastic values contain rods whose periodic state is unstable.\n");
  }
  add(text, "{}", growth_theory_row(result, units));
  for (const std::string& sentence : result.shortfalls) add(text, "NOT REACHED: {}\n", sentence);
  for (const std::string& sentence : result.notes) add(text, "NOTE: {}\n", sentence);
  for (const std::string& warning : scene.warnings) add(text, "WARNING: {}\n", warning);
  if (result.theory)
    for (const std::string& warning : theory_warnings(model, result)) add(text, "WARNING: {}\n", warning);
  for (const std::string& warning : limit_warnings(model, result)) add(text, "WARNING: {}\n", warning);
  for (const std::string& warning : strength_warnings(model, result)) add(text, "WARNING: {}\n", warning);
  const bool parted = text.size() > 1 && text.data()[text.size() - 2] == '\n';
  if (!verdict.empty()) add(text, "{}Verdict: {}\n", parted ? "" : "\n", verdict);
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

std::string accuracy_table(const Settings& settings) {
  Text text;
  add(text, "  tolerance {:.1e} means:", settings.tolerance);
  const char* before = "";
  for (SolverTolerance of : solver_tolerances(settings)) {
    std::replace(of.solver.begin(), of.solver.end(), '_', ' ');
    add(text, "{} {} {:.1e}", before, of.solver, of.tolerance);
    before = ",";
  }
  add(text, "\n");
  return fmt::to_string(text);
}

}  // namespace hb::tools
