#include "tools/output/nonlinear_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "hb/analysis/nonlinear/motion_loads.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/json_parts.hpp"
#include "tools/output/machine_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/shape_rows.hpp"
#include "tools/output/stress_words.hpp"
#include "tools/output/text.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

// All rods have one verdict together.
NamedVerdicts verdict_of(const NonlinearResult& result) { return {{"all rods together", result.stability->verdict}}; }

Json rod_json(const NonlinearRod& rod, const Linkage& linkage, const NonlinearResult& result, const Units& units) {
  Json json;
  json["modes"] = rod.q.num_components();
  json["harmonics"] = rod.q.num_harmonics();
  Json max_abs = Json::array(), angles = Json::array();
  for (const Extremum& peak : rod.max_abs) {
    max_abs.push_back(peak.value);
    angles.push_back(scene_angle(peak.crank_angle, units));
  }
  if (result.computed.steady)
    json["q"] = {{"max_abs", std::move(max_abs)}, {"crank_angle", std::move(angles)}, {"fourier", fourier_json(rod.q)}};
  json["error_bound"] = number(rod.error_bound);
  if (rod.cut) {
    json["modes_error"] = rod.cut->deflection;
    json["more_modes_needed"] = !(rod.cut->deflection <= 0.01);
  }
  if (rod.shape) {
    add_shape(json, *rod.shape, rod.peak_errors, units);
    if (rod.stress) {
      add_stress(json, *rod.stress);
      if (rod.cycle) add_stress_cycle(json["stress"], *rod.cycle, *body_at(linkage, rod.link), units);
    }
  }
  return json;
}

std::string way_text(const NonlinearResult& result, const Scene& scene) {
  if (!result.followed_from) return "weakly bent at all lower speeds: Newton's method from the linear answer";
  return fmt::format("branch followed from {}, {} on the way", speed_text(*result.followed_from, scene),
                     result.folds == 1 ? "1 fold" : fmt::format("{} folds", result.folds));
}

void add_rod(Text& text, const NonlinearRod& rod, const Linkage& linkage, const OutputUnits& units) {
  add(text, "{}: {} {}, {} harmonics\n", rod.name, rod.max_abs.size(), rod.max_abs.size() == 1 ? "mode" : "modes",
      rod.q.num_harmonics());
  add(text, "  q_i: amplitude of sin(i pi x/l), largest over the motion\n");
  add(text, "    {:>3}  {:>18}  {:>18}\n", "i", "max |q_i| [" + units.length + "]", "crank angle [deg]");
  const double largest = std::ranges::max(rod.max_abs, {}, &Extremum::value).value;
  for (std::size_t i = 0; i < rod.max_abs.size(); ++i)
    add(text, "    {:>3}  {:>18.{}g}  {:>18.3f}\n", i + 1, rod.max_abs[i].value,
        std::min(10, trusted_digits(rod.max_abs[i].value, rod.error_bound * largest)),
        rod.max_abs[i].crank_angle * degrees_per_radian);
  add(text, "  error bound       {:.1e} of the largest |q|, estimated\n", rod.error_bound);
  if (rod.cut)
    add(text, "  error of the cut  {:.1e} of the largest deflection, estimated{}\n", rod.cut->deflection,
        rod.cut->deflection <= 0.01 ? "" : "; MORE MODES ARE NEEDED (--modes)");
  if (rod.shape) {
    const std::optional<PeakErrors>& errors = rod.peak_errors;
    add(text, "{}", deflection_row(rod.shape->deflection, errors, units));
    add(text, "{}", moment_row(rod.shape->bending_moment, errors, units));
  }
  if (rod.stress) {
    const Body& link = *body_at(linkage, rod.link);
    add(text, "{}", stress_lines(*rod.stress, link, units));
    if (rod.cycle) add(text, "{}", stress_rows(*rod.cycle, link, units));
  }
  add(text, "\n");
}

void add_stability(Text& text, const NonlinearResult& result, const Scene& scene) {
  const Stability& stability = *result.stability;
  const OutputUnits units = output_units(scene);
  const Eigen::Index unresolved =
      2 * result.motion.q.num_components() - static_cast<Eigen::Index>(stability.exponents.size());
  add(text, "All rods together\n{}", exponents_rows(stability, unresolved, result.speed, scene));
  add(text, "  growth rate       {}{}\n", growth_text(stability, units.rate),
      stability.converged ? "" : "  NOT REACHED");
  add(text, "  {}\n\n", verdict_sentence(stability, result.speed, scene));
}

// Sentences on rods that yield.
std::vector<std::string> strength_warnings(const SceneModel& model, const NonlinearResult& result) {
  std::vector<std::string> sentences;
  for (const NonlinearRod& rod : result.rods)
    if (rod.cycle)
      if (std::optional<std::string> sentence =
              yield_warning(rod.name, *rod.cycle, *body_at(*model.linkage(), rod.link), output_units(model.scene)))
        sentences.push_back(std::move(*sentence));
  return sentences;
}

// The error of the cut is known where the motion with more modes is.
bool cut_known(const NonlinearResult& result) { return result.rods.empty() || result.rods.front().cut.has_value(); }

void add_forces(Text& text, const SceneModel& model, const NonlinearResult& result, const OutputUnits& units) {
  const JointForces& forces = *result.forces;
  const auto range = [&](const FourierSeries& series, Eigen::Index c, double factor) {
    const Range of = fourier::range(series, c);
    return fmt::format("{:>12.6g} .. {:<12.6g}", of.min.value * factor, of.max.value * factor);
  };
  add(text,
      "Joint forces, smallest .. largest, in the frames of the bent couplers' chords.\n  {:<22}  {:^28}  {:^28}\n",
      "[N]", "rigid", "elastic");
  for (const JointForce& joint : forces.joints)
    for (Eigen::Index c = 0; c < joint.rigid.num_components(); ++c)
      add(text, "  {:<20} {}  {}  {}\n", c == 0 ? joint.name : "",
          joint.rigid.num_components() == 1 ? "n"
          : c == 0                          ? "x"
                                            : "y",
          range(joint.rigid, c, units.force), range(joint.elastic, c, units.force));
  add(text, "  {:<22}  {}  {}\n", "driving torque [N m]", range(forces.torque_rigid, 0, units.moment),
      range(forces.torque, 0, units.moment));
  const ForceErrors& errors = *result.force_errors;
  add(text, "  estimated errors: forces {:.1e} of the largest, torque {:.1e}", errors.force, errors.torque);
  if (cut_known(result))
    add(text, "; from the cut of the modes {:.1e} and {:.1e}", errors.force_cut, errors.torque_cut);
  add(text, "\n{}", machine_rows(*machine_loads(*model.linkage(), result), result.sliders, result.speed, model.scene));
}

}  // namespace

Json nonlinear_json(const SceneModel& model, const NonlinearResult& result, const Settings& settings, bool stats) {
  const Units& units = model.scene.units;
  Json json;
  json["title"] = model.scene.title;
  json["theory"] = "nonlinear";
  json["rpm"] = rpm_of(result.speed, units);
  json["omega"] = result.speed;
  json["period"] = result.turns;
  json["status"] = result.shortfalls.empty() ? "reached" : "tolerance not reached";
  if (!result.shortfalls.empty()) json["notes"] = result.shortfalls;
  json["tolerance"] = settings.tolerance;
  json["motion_tolerance"] = result.tolerance;
  if (result.cut_tolerance) json["modes_tolerance"] = *result.cut_tolerance;
  std::vector<std::string> warnings = model.scene.warnings;
  for (std::string& sentence : strength_warnings(model, result)) warnings.push_back(std::move(sentence));
  if (!warnings.empty()) json["warnings"] = warnings;
  json["units"] = units_json(units);
  json["found"] = result.search == MotionSearch::found;
  if (result.followed_from) json["followed_from_rpm"] = rpm_of(*result.followed_from, units);
  if (result.search != MotionSearch::found && result.last_speed) {
    Json& last = json["last_motion"] = {{"rpm", rpm_of(*result.last_speed, units)}, {"omega", *result.last_speed}};
    for (std::size_t r = 0; r < model.rods.size(); ++r)
      if (model.rods[r].reported) last["rods"][model.rods[r].name] = {{"max_abs", result.last_max_abs[r]}};
  }
  json["folds_passed"] = result.folds;
  Json& rods = json["rods"] = Json::object();
  for (const NonlinearRod& rod : result.rods)
    if (rod.reported) rods[rod.name] = rod_json(rod, *model.linkage(), result, units);
  if (result.stability) {
    json["system"] = stability_json(*result.stability, 2 * result.motion.q.num_components());
    add_modes(json["system"], result.stability->exponents, result.speed / result.turns, units);
    json["verdict"] = to_string(result.stability->verdict);
  }
  if (result.forces) {
    json["joints"] = joints_json(*result.forces);
    json["torque"] = range_json(result.forces->torque, 0);
    json["torque"]["rigid"] = range_json(result.forces->torque_rigid, 0);
    json["joints_error"] = number(result.force_errors->force);
    json["torque_error"] = number(result.force_errors->torque);
    if (cut_known(result)) {
      json["joints_modes_error"] = number(result.force_errors->force_cut);
      json["torque_modes_error"] = number(result.force_errors->torque_cut);
    }
    add_machine(json, *machine_loads(*model.linkage(), result), result.sliders, result.speed, units);
  }
  Json& others = json["other_motions"] = Json::array();
  for (const OtherMotion& other : result.others) {
    Json entry;
    for (std::size_t r = 0; r < model.rods.size(); ++r)
      if (model.rods[r].reported) entry["rods"][model.rods[r].name] = {{"max_abs", other.max_abs[r]}};
    if (other.verdict) entry["verdict"] = to_string(*other.verdict);
    others.push_back(std::move(entry));
  }
  if (stats) {
    std::vector<Stage> stages = model.stages;
    stages.insert(stages.end(), result.stages.begin(), result.stages.end());
    add_stats(json, stages, settings);
  }
  return json;
}

std::string nonlinear_table(const SceneModel& model, const NonlinearResult& result) {
  const Scene& scene = model.scene;
  const OutputUnits units = output_units(scene);
  Text text;
  add(text, "{}, {}{}\nomega = {:.10g} rad/{}, motion without linearisation{}\n", scene_name(scene),
      speed_text(result.speed, scene), result.stability ? ": " + mechanism_verdict(verdict_of(result)) : "",
      result.speed, units.time, result.turns == 1 ? "" : fmt::format(", period of {} turns", result.turns));
  if (result.search == MotionSearch::found) add(text, "  {}\n\n", way_text(result, scene));
  for (const NonlinearRod& rod : result.rods)
    if (rod.reported) add_rod(text, rod, *model.linkage(), units);
  if (result.stability) add_stability(text, result, scene);
  if (result.forces) add_forces(text, model, result, units);
  for (const OtherMotion& other : result.others) {
    add(text, "Another motion at this speed{}:",
        other.verdict ? fmt::format(", {}", to_string(*other.verdict)) : std::string());
    for (std::size_t r = 0; r < model.rods.size(); ++r)
      if (model.rods[r].reported)
        add(text, " {} max |q_1| = {:.6g} {}", model.rods[r].name, other.max_abs[r].front(), units.length);
    add(text, "\n");
  }
  for (const std::string& sentence : result.shortfalls) add(text, "NOT REACHED: {}\n", sentence);
  if (result.search != MotionSearch::found && result.last_speed) {
    add(text, "The last motion on the way is at {}:", speed_text(*result.last_speed, scene));
    for (std::size_t r = 0; r < model.rods.size(); ++r)
      if (model.rods[r].reported)
        add(text, " {} max |q_1| = {:.6g} {}", model.rods[r].name, result.last_max_abs[r].front(), units.length);
    add(text, "\n");
  }
  for (const std::string& warning : strength_warnings(model, result)) add(text, "WARNING: {}\n", warning);
  for (const std::string& warning : scene.warnings) add(text, "WARNING: {}\n", warning);
  return fmt::to_string(text);
}

SpeedResult as_speed_result(const NonlinearResult& result) {
  SpeedResult speed;
  speed.speed = result.speed;
  speed.computed = result.computed;
  speed.computed.stability = false;
  for (const NonlinearRod& from : result.rods) {
    RodResult rod;
    rod.name = from.name;
    rod.link = from.link;
    rod.reported = from.reported;
    rod.num_modes = from.q.num_components();
    SteadyState state;
    state.status = SteadyStatus::converged;
    state.q = from.q;
    state.num_harmonics = static_cast<int>(from.q.num_harmonics());
    state.error_bound = from.error_bound;
    rod.steady = std::move(state);
    rod.max_abs = from.max_abs;
    rod.shape = from.shape;
    rod.stress = from.stress;
    speed.rods.push_back(std::move(rod));
  }
  speed.forces = result.forces;
  speed.force_errors = result.force_errors;
  return speed;
}

MachineFiles machine_files(const NonlinearResult& result) {
  MachineFiles files;
  for (const NonlinearRod& rod : result.rods) files.envelopes.push_back(rod.envelope);
  if (result.forces) files.frame = result.forces->frame;
  files.sliders = result.sliders;
  return files;
}

}  // namespace hb::tools
