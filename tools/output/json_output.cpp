#include "tools/output/json_output.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/nearest_resonance.hpp"
#include "tools/output/json_parts.hpp"
#include "tools/output/machine_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/printable.hpp"
#include "tools/output/stress_words.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

void add_steady(Json& json, const RodResult& rod, const Units& units) {
  const SteadyState& state = *rod.steady;
  json["status"] = status_text(state.status);
  json["harmonics"] = state.q.num_harmonics() >= 0 ? state.q.num_harmonics() : 0;
  Json max_abs = Json::array(), angles = Json::array();
  if (rod.max_abs.empty()) max_abs = angles = Json(static_cast<std::size_t>(rod.num_modes), Json(nullptr));
  for (const Extremum& peak : rod.max_abs) {
    max_abs.push_back(peak.value);
    angles.push_back(scene_angle(peak.crank_angle, units));
  }
  json["q"] = {{"max_abs", std::move(max_abs)}, {"crank_angle", std::move(angles)}, {"fourier", fourier_json(state.q)}};
  json["error_bound"] = state.status == SteadyStatus::singular ? Json() : Json(state.error_bound);
  json["error_bound_proved"] = state.bound == SteadyBound::proved;
  json["residual"] = state.residual;
  json["resonance_distance"] = state.resonance_distance;
  json["steady_method"] = method_text(state.method);
}

void add_resonance(Json& json, const RodModel& model, const RodResult& rod, double speed, const Units& units) {
  if (const std::optional<NearestResonance> nearest = nearest_resonance(model.system, speed))
    json["nearest_resonance"] = {{"order", nearest->order},
                                 {"rpm", rpm_from_speed(nearest->speed, units)},
                                 {"omega", nearest->speed},
                                 {"frequency", nearest->frequency},
                                 {"in_response", nearest->order <= highest_harmonic(*rod.steady)}};
  const std::optional<double> slow = quasi_static_response(model.system, model.num_modes, speed);
  double largest = 0;
  for (const Extremum& peak : rod.max_abs) largest = std::max(largest, peak.value);
  if (slow && !rod.max_abs.empty()) json["amplification"] = largest / *slow;
}

void add_stability(Json& json, const RodResult& rod, double speed, const Units& units) {
  json.update(stability_json(*rod.stability, rod.num_exponents));
  json["exponents_unresolved"] = unresolved_exponents(rod);
  add_modes(json, rod.stability->exponents, speed, units);
  json["growth_modes"] = rod.growth_modes;
  if (rod.growth_modes_error) json["growth_modes_error"] = *rod.growth_modes_error;
}

void add_theory(Json& json, const std::optional<TheoryErrors>& errors, std::size_t r) {
  json["theory"] = !errors ? "not judged" : beyond_theory(errors->rods[r].q) ? "beyond" : "within";
  json["theory_error"] = errors ? number(errors->rods[r].q) : Json(nullptr);
  if (!errors) return;
  json["deflection_theory_error"] = number(errors->rods[r].deflection);
  if (errors->rods[r].axial_share) json["theory_axial_share"] = *errors->rods[r].axial_share;
}

}  // namespace

Json units_json(const Units& units) {
  return {{"length", units.length},
          {"mass", units.mass},
          {"time", units.time},
          {"angle", units.angle},
          {"force", fmt::format("{} {}/{}^2", units.mass, units.length, units.time)},
          {"force_in_newton", units.force_in_newton()},
          {"torque_in_newton_metre", units.torque_in_newton_metre()}};
}

Json accuracy_json(const Settings& settings) {
  Json json = Json::object();
  for (const SolverTolerance& of : solver_tolerances(settings)) json[of.solver] = of.tolerance;
  return json;
}

void add_stats(Json& document, const std::vector<Stage>& stages, const Settings& settings) {
  Json& json = document["stats"] = Json::array();
  for (const Stage& stage : stages) {
    Json entry = {{"stage", stage.name}};
    if (stage.skipped) {
      entry["skipped"] = stage.note;
    } else {
      entry["seconds"] = stage.seconds;
      if (!stage.note.empty()) entry["note"] = stage.note;
    }
    json.push_back(std::move(entry));
  }
  document["accuracy"] = accuracy_json(settings);
}

Json steady_json(const SceneModel& model, const SpeedResult& result, const Settings& settings, bool stats) {
  const Units& units = model.scene.units;
  constexpr std::size_t most_keys = 40;  // of all, of a rod
  Json json = object_with_room(most_keys);
  json["title"] = model.scene.title;
  json["rpm"] = rpm_of(result.speed, units);
  json["omega"] = result.speed;
  json["status"] = result.shortfalls.empty() ? "reached" : "tolerance not reached";
  std::vector<std::string> notes = result.shortfalls;
  notes.insert(notes.end(), result.notes.begin(), result.notes.end());
  if (!notes.empty()) json["notes"] = std::move(notes);
  json["tolerance"] = settings.tolerance;
  if (result.computed.stability && !result.rods.empty()) {
    Verdict verdict = Verdict::stable;
    for (const RodResult& rod : result.rods)
      if (rod.stability) verdict = worst(verdict, rod.stability->verdict);
    json["verdict"] = to_string(verdict);
  }
  if (result.theory && result.computed.stability) json["growth_theory_error"] = number(result.theory->growth);
  std::vector<std::string> warnings = model.scene.warnings;
  for (std::string& sentence : theory_warnings(model, result)) warnings.push_back(std::move(sentence));
  for (std::string& sentence : limit_warnings(model, result)) warnings.push_back(std::move(sentence));
  for (std::string& sentence : strength_warnings(model, result)) warnings.push_back(std::move(sentence));
  if (!warnings.empty()) json["warnings"] = std::move(warnings);
  json["units"] = units_json(units);
  Json& rods = json["rods"] = object_with_room(result.rods.size());
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const RodResult& rod = result.rods[r];
    if (!rod.reported) continue;
    Json& entry = rods[rod.name] = object_with_room(most_keys);
    entry["modes"] = rod.num_modes;
    if (result.computed.steady) add_steady(entry, rod, units);
    if (result.computed.steady) add_resonance(entry, model.rods[r], rod, result.speed, units);
    if (model.linkage()) add_theory(entry, result.theory, r);
    if (rod.cut) {
      entry["modes_error"] = rod.cut->deflection;
      entry["more_modes_needed"] = needs_more_modes(rod);
    }
    if (rod.shape) {
      add_shape(entry, *rod.shape, rod.peak_errors, units);
      entry["static_deflection"] = static_json(model, result, r);
      add_stress(entry, *rod.stress);
      add_stress_cycle(entry["stress"], model, result, r);
    }
    if (rod.stability) add_stability(entry, rod, result.speed, units);
  }
  if (result.forces) {
    json["joints"] = joints_json(*result.forces);
    json["torque"] = range_json(result.forces->torque, 0);
    json["torque"]["rigid"] = range_json(result.forces->torque_rigid, 0);
    if (const std::optional<ForceErrors>& errors = result.force_errors) {
      json["joints_error"] = errors->force;
      json["torque_error"] = errors->torque;
      json["joints_modes_error"] = errors->force_cut;
      json["torque_modes_error"] = errors->torque_cut;
    }
    if (result.theory) {
      json["joints_theory_error"] = number(result.theory->force);
      json["torque_theory_error"] = number(result.theory->torque);
    }
    add_machine(json, model, result);
  } else if (!model.linkage() && settings.only.reactions) {
    json["joints"] = Json::object();
  }
  if (stats) {
    std::vector<Stage> stages = model.stages;
    stages.insert(stages.end(), result.stages.begin(), result.stages.end());
    add_stats(json, stages, settings);
  }
  return json;
}

std::string json_text(const Json& document) {
  return printable(document.dump(-1, ' ', false, Json::error_handler_t::replace)) + "\n";
}

std::string json_file_text(const Json& document) {
  return printable(document.dump(1, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace hb::tools
