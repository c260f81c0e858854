#include "tools/output/json_output.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;

// No "-0.0".
Json pair(std::complex<double> value) { return Json::array({value.real() + 0.0, value.imag() + 0.0}); }

Json range_json(const FourierSeries& series, Eigen::Index component) {
  const Range range = fourier::range(series, component);
  return {{"min", range.min.value}, {"max", range.max.value}};
}

Json fourier_json(const FourierSeries& series) {
  Json modes = Json::array();
  for (Eigen::Index i = 0; i < series.num_components(); ++i) {
    Json coefficients = Json::array();
    for (Eigen::Index n = 0; n <= series.num_harmonics(); ++n) coefficients.push_back(pair(series.c(i, n)));
    modes.push_back(std::move(coefficients));
  }
  return modes;
}

Json peak_json(const RodPeak& peak, const Units& units) {
  return {{"max_abs", peak.max_abs}, {"x", peak.x}, {"crank_angle", scene_angle(peak.crank_angle, units)}};
}

void add_steady(Json& json, const RodResult& rod, const Units& units) {
  const SteadyState& state = *rod.steady;
  json["status"] = status_text(state.status);
  json["harmonics"] = state.q.num_harmonics() >= 0 ? state.q.num_harmonics() : 0;
  Json max_abs = Json::array(), angles = Json::array();
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

void add_stability(Json& json, const RodResult& rod) {
  const Stability& stability = *rod.stability;
  Json exponents = Json::array(), errors = Json::array();
  for (const Exponent& exponent : stability.exponents) {
    exponents.push_back(pair(exponent.value));
    errors.push_back(exponent.error);
  }
  json["exponents"] = std::move(exponents);
  json["exponent_errors"] = std::move(errors);
  json["exponents_unresolved"] = unresolved_exponents(rod);
  Json& uncertain = json["exponents_uncertain"] = Json::array();
  for (const Exponent& exponent : stability.uncertain)
    uncertain.push_back({{"exponent", pair(exponent.value)}, {"error", exponent.error}});
  json["growth_rate"] = stability.growth_rate + 0.0;
  if (rod.growth_modes_error) json["growth_modes_error"] = *rod.growth_modes_error;
  json["exponent_error"] = stability.growth_error;
  json["growth_interval"] = {stability.growth_low + 0.0, stability.growth_high + 0.0};
  json["verdict"] = to_string(stability.verdict);
  json["stability_method"] = to_string(stability.method);
  json["stability_converged"] = stability.converged;
}

Json joints_json(const JointForces& forces) {
  Json joints = Json::object();
  for (const JointForce& joint : forces.joints) {
    Json& entry = joints[joint.name];
    if (joint.rigid.num_components() == 1) {
      entry["n"] = range_json(joint.elastic, 0);
      entry["n_rigid"] = range_json(joint.rigid, 0);
      continue;
    }
    entry["x"] = range_json(joint.elastic, 0);
    entry["y"] = range_json(joint.elastic, 1);
    entry["x_rigid"] = range_json(joint.rigid, 0);
    entry["y_rigid"] = range_json(joint.rigid, 1);
  }
  return joints;
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

Json stages_json(const std::vector<Stage>& stages) {
  Json json = Json::array();
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
  return json;
}

Json steady_json(const SceneModel& model, const SpeedResult& result, const Settings& settings) {
  const Units& units = model.scene.units;
  Json json;
  json["title"] = model.scene.title;
  json["rpm"] = rpm_of(result.speed, units);
  json["omega"] = result.speed;
  json["status"] = result.shortfalls.empty() ? "reached" : "tolerance not reached";
  if (!result.shortfalls.empty()) json["notes"] = result.shortfalls;
  json["tolerance"] = settings.tolerance;
  if (!model.scene.warnings.empty()) json["warnings"] = model.scene.warnings;
  json["units"] = units_json(units);
  Json& rods = json["rods"] = Json::object();
  for (const RodResult& rod : result.rods) {
    if (!rod.reported) continue;
    Json& entry = rods[rod.name];
    entry["modes"] = rod.num_modes;
    if (result.computed.steady) add_steady(entry, rod, units);
    if (rod.modes_error) {
      entry["modes_error"] = *rod.modes_error;
      entry["more_modes_needed"] = needs_more_modes(rod);
    }
    if (rod.shape) {
      entry["deflection"] = peak_json(rod.shape->deflection, units);
      entry["bending_moment"] = peak_json(rod.shape->bending_moment, units);
    }
    if (rod.stability) add_stability(entry, rod);
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
  } else if (!model.linkage() && settings.only.reactions) {
    json["joints"] = Json::object();
  }
  if (settings.stats) {
    std::vector<Stage> stages = model.stages;
    stages.insert(stages.end(), result.stages.begin(), result.stages.end());
    json["stats"] = stages_json(stages);
  }
  return json;
}

void print_json(const Json& document) {
  const std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  std::fwrite(text.data(), 1, text.size(), stdout);
}

}  // namespace hb::tools
