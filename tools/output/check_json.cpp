#include "tools/output/check_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/output/check_report.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_parts.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

Json difference(const RodCheck& rod, const std::optional<Comparison>& c) {
  return rod.compared() && c ? number(c->difference) : Json();
}

Json allowed(const RodCheck& rod, const std::optional<Comparison>& c) {
  return rod.compared() && c ? number(c->allowed) : Json();
}

// null where nothing could be compared.
Json agrees(const RodCheck& rod) { return rod.compared() || rod.both_singular ? Json(rod.agrees()) : Json(); }

Json shooting_json(const ShootingResult& shooting) {
  const bool has_exponents = !shooting.exponents.empty();
  Json json = {{"status", to_string(shooting.status)},
               {"integrator", to_string(shooting.integrator)},
               {"integrator_tolerance", number(shooting.integrator_tolerance)},
               {"q_error", shooting.orbit.q.size() > 0 ? number(shooting.q_error) : Json()},
               {"growth_rate", has_exponents ? number(shooting.growth_rate) : Json()},
               {"growth_error", has_exponents ? number(shooting.growth_error) : Json()},
               {"exponents", exponents_json(shooting.exponents)},
               {"verdict", to_string(shooting.verdict)},
               {"segments", shooting.num_segments},
               {"steps", shooting.steps},
               {"evaluations", shooting.evaluations},
               {"seconds", shooting.seconds},
               {"predicted_seconds", number(shooting.predicted_seconds)}};
  if (!shooting.message.empty()) json["message"] = shooting.message;
  return json;
}

Json marching_json(const MarchingResult& marching) {
  Json json = {{"status", to_string(marching.status)},
               {"integrator", to_string(marching.integrator)},
               {"turns", marching.turns},
               {"q_error", number(marching.q_error)},
               {"steps", marching.steps},
               {"seconds", marching.seconds}};
  if (!marching.message.empty()) json["message"] = marching.message;
  return json;
}

Json rod_json(const RodCheck& rod, double tolerance) {
  Json json;
  json["q_difference"] = difference(rod, rod.q);
  json["exponent_difference"] = difference(rod, rod.exponents);
  json["agrees"] = agrees(rod);
  json["q_allowed"] = allowed(rod, rod.q);
  json["exponent_allowed"] = allowed(rod, rod.exponents);
  json["q1_difference"] = difference(rod, rod.q1);
  json["q1_allowed"] = allowed(rod, rod.q1);
  if (rod.deflection) {
    json["deflection_difference"] = number(rod.deflection->difference);
    json["deflection_allowed"] = number(rod.deflection->allowed);
  }
  if (rod.marched) {
    json["marching_difference"] = number(rod.marched->difference);
    json["marching_allowed"] = number(rod.marched->allowed);
  }
  Json& series = json["harmonic_balance"];
  series = {{"tolerance", tolerance},
            {"error_bound", number(rod.steady.error_bound)},
            {"harmonics", rod.steady.num_harmonics}};
  if (rod.stability) {
    series["growth_rate"] = number(rod.stability->growth_rate);
    series["growth_error"] = number(rod.stability->growth_error);
    series["exponents"] = exponents_json(rod.stability->exponents);
    series["verdict"] = to_string(rod.stability->verdict);
  }
  json["shooting"] = shooting_json(rod.shooting);
  if (rod.marching) json["marching"] = marching_json(*rod.marching);
  if (!rod.compared()) json["not_compared"] = rod.not_compared;
  return json;
}

// Of the mechanism; null where nothing was said of it.
Json verdict(const SpeedCheck& check) {
  const std::optional<Verdict> worst = worst_of(check.verdicts);
  return worst ? Json(to_string(*worst)) : Json();
}

Json single_json(const SceneModel& model, const SpeedCheck& check, const Settings& settings) {
  Json json;
  json["title"] = model.scene.title;
  json["rpm"] = rpm_from_speed(check.speed, model.scene.units);
  json["omega"] = check.speed;
  json["agrees"] = check.agrees();
  if (!check.verdicts.empty()) json["verdict"] = verdict(check);
  json["rods"] = Json::object();
  for (const RodCheck& rod : check.rods) {
    Json& entry = json["rods"][rod.name] = rod_json(rod, settings.tolerance);
    if (model.linkage()) entry["theory_error"] = number(rod.theory_error);
  }
  if (check.theory) {
    if (check.joints) {
      json["joints_theory_error"] = number(check.theory->force);
      json["torque_theory_error"] = number(check.theory->torque);
    }
    if (!check.verdicts.empty()) json["growth_theory_error"] = number(check.theory->growth);
  }
  if (check.joints) {
    const auto compared = [](const Comparison& c) {
      return Json{{"difference", number(c.difference)}, {"allowed", number(c.allowed)}, {"agrees", c.agrees()}};
    };
    json["joints"] = compared(check.joints->forces);
    json["joints"]["worst"] = check.joints->worst;
    json["torque"] = compared(check.joints->torque);
  }
  return json;
}

Json speeds_json(const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  Json json;
  json["title"] = model.scene.title;
  json["rpm"] = Json::array();
  json["omega"] = Json::array();
  json["agrees"] = std::all_of(checks.begin(), checks.end(), [](const SpeedCheck& c) { return c.agrees(); });
  json["rods"] = Json::object();
  for (const SpeedCheck& check : checks) {
    json["rpm"].push_back(rpm_from_speed(check.speed, model.scene.units));
    json["omega"].push_back(check.speed);
    if (!check.verdicts.empty()) json["verdict"].push_back(verdict(check));
    for (const RodCheck& rod : check.rods) {
      Json& entry = json["rods"][rod.name];
      entry["q_difference"].push_back(difference(rod, rod.q));
      entry["q_allowed"].push_back(allowed(rod, rod.q));
      entry["exponent_difference"].push_back(difference(rod, rod.exponents));
      entry["exponent_allowed"].push_back(allowed(rod, rod.exponents));
      entry["verdict"].push_back(to_string(rod.shooting.verdict));
      entry["agrees"].push_back(agrees(rod));
      if (model.linkage()) entry["theory_error"].push_back(number(rod.theory_error));
    }
    const bool joints = check.joints.has_value();
    if (check.theory) {
      json["joints_theory_error"].push_back(number(check.theory->force));
      json["torque_theory_error"].push_back(number(check.theory->torque));
      json["growth_theory_error"].push_back(number(check.theory->growth));
    }
    json["joints_difference"].push_back(joints ? number(check.joints->forces.difference) : Json());
    json["torque_difference"].push_back(joints ? number(check.joints->torque.difference) : Json());
  }
  if (const std::optional<WorstComparison> worst = worst_comparison(checks))
    json["worst"] = {{"rpm", rpm_from_speed(worst->speed, model.scene.units)},
                     {"rod", worst->where},
                     {"what", worst->comparison.what},
                     {"difference", number(worst->comparison.difference)},
                     {"allowed", number(worst->comparison.allowed)}};
  return json;
}

}  // namespace

Json check_json(const Check& found) {
  const SceneModel& model = *found.model;
  const std::vector<SpeedCheck>& checks = found.speeds;
  Json json = found.over_range ? speeds_json(model, checks) : single_json(model, checks.front(), found.settings);
  double series = 0, shooting = 0, marching = 0;
  for (const SpeedCheck& check : checks) {
    series += check.seconds_harmonic_balance;
    shooting += check.seconds_shooting;
    marching += check.seconds_marching;
  }
  if (std::vector<std::string> warnings = check_warnings(model, checks); !warnings.empty())
    json["warnings"] = std::move(warnings);
  json["seconds"] = {{"harmonic_balance", series}, {"shooting", shooting}};
  if (marching > 0) json["seconds"]["marching"] = marching;
  std::vector<ShortfallsAt> shortfalls;
  for (const SpeedCheck& check : checks) shortfalls.push_back({check.speed, check.shortfalls});
  add_shortfalls(json, model.scene, shortfalls);
  return json;
}

void add_shortfalls(Json& json, const Scene& scene, const std::vector<ShortfallsAt>& all) {
  Json notes = Json::array();
  for (const auto& [speed, sentences] : all)
    for (const std::string& sentence : sentences)
      notes.push_back(all.size() > 1 ? speed_text(speed, scene) + ": " + sentence : sentence);
  json["status"] = notes.empty() ? "reached" : "tolerance not reached";
  if (!notes.empty()) json["notes"] = std::move(notes);
}

}  // namespace hb::tools
