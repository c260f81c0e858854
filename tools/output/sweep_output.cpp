#include "tools/output/sweep_output.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/path_unit.hpp"
#include "tools/output/sweep_machine.hpp"
#include "tools/output/sweep_theory.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

constexpr std::size_t most_keys = 40;  // of a sweep, of a rod

// A number, or null where it is not finite.
template <class Value>
Json over_points(const std::vector<SweepPoint>& points, const Value& value) {
  Json array = Json::array();
  array.get_ref<Json::array_t&>().reserve(points.size());
  for (const SweepPoint& point : points) array.push_back(point.problem.empty() ? value(point) : Json(nullptr));
  return array;
}

Json verdict_json(const RodPoint& rod) {
  return rod.stability ? Json(to_string(rod.stability->stability.verdict)) : Json(nullptr);
}

Json exponents_json(const Stability& stability) {
  Json::array_t array;
  array.reserve(stability.exponents.size());
  for (const Exponent& exponent : stability.exponents) {
    Json::array_t parts;
    parts.reserve(2);
    parts.emplace_back(exponent.value.real());
    parts.emplace_back(exponent.value.imag());
    array.emplace_back(std::move(parts));
  }
  return array;
}

Json rod_json(const SweepScene& scene, const SweepResult& result, std::size_t r,
              const std::vector<SweepPoint>& points) {
  Json json = object_with_room(most_keys);
  json["modes"] = result.rods[r].num_modes;
  const auto of_rod = [&](const auto& value) {
    return over_points(points, [&](const SweepPoint& point) { return Json(value(point.rods[r])); });
  };
  if (result.computed.steady) {
    json["max_abs"] =
        of_rod([](const RodPoint& rod) { return rod.max_abs.empty() ? Json(nullptr) : Json(rod.max_abs); });
    json["error_bound"] = of_rod([](const RodPoint& rod) { return number(rod.error_bound); });
    json["resonance_distance"] = of_rod([](const RodPoint& rod) { return number(rod.resonance_distance); });
  }
  if (result.computed.shape) {
    json["deflection"] = of_rod([](const RodPoint& rod) { return number(rod.deflection); });
    json["deflection_error"] = of_rod([](const RodPoint& rod) { return number(rod.deflection_error); });
    json["bending_moment"] = of_rod([](const RodPoint& rod) { return number(rod.bending_moment); });
    json["bending_moment_error"] = of_rod([](const RodPoint& rod) { return number(rod.bending_moment_error); });
    json["buckling_share"] = of_rod([](const RodPoint& rod) { return number(rod.buckling_share); });
    json["buckling_share_error"] = of_rod([](const RodPoint& rod) { return number(rod.buckling_share_error); });
    json["strain"] = of_rod([](const RodPoint& rod) { return number(rod.strain); });
    add_stress(json, r, points, scene.scene().units);
  }
  if (scene.first().linkage())
    json["theory_error"] = of_rod([](const RodPoint& rod) { return number(rod.theory_error); });
  if (has_theory(scene, result) && result.computed.shape)
    json["deflection_theory_error"] = of_rod([](const RodPoint& rod) { return number(rod.deflection_theory_error); });
  if (result.computed.stability) {
    json["growth_rate"] = of_rod([](const RodPoint& rod) { return number(rod.stability->stability.growth_rate); });
    Json& distances = json["distance_to_boundary"] = Json::array();
    for (const SweepPoint& point : points) {
      const std::optional<double> distance = distance_to_boundary(result.rods[r], point.x);
      distances.push_back(distance && !point.rods.empty() ? Json(*distance) : Json(nullptr));
    }
    json["growth_error"] = of_rod([](const RodPoint& rod) { return number(rod.stability->stability.growth_error); });
    json["verdict"] = of_rod(verdict_json);
    json["exponents"] = of_rod([](const RodPoint& rod) { return exponents_json(rod.stability->stability); });
  }
  return json;
}

Json ranges_json(const std::vector<SweepPoint>& points,
                 const std::function<const TurnRange*(const SweepPoint&)>& range) {
  Json json;
  for (const bool largest : {false, true}) {
    json[largest ? "max" : "min"] = over_points(points, [&](const SweepPoint& point) {
      const TurnRange* value = range(point);
      return value ? number(largest ? value->max : value->min) : Json(nullptr);
    });
  }
  return json;
}

void add_forces(Json& json, const SweepResult& result) {
  Json& joints = json["joints"] = object_with_room(result.joint_components.size());
  for (std::size_t c = 0; c < result.joint_components.size(); ++c) {
    const std::string& name = result.joint_components[c];
    const std::size_t space = name.rfind(' ');
    const std::string joint = name.substr(0, space), component = name.substr(space + 1);
    joints[joint][component] =
        ranges_json(result.points, [&](const SweepPoint& p) { return c < p.joints.size() ? &p.joints[c] : nullptr; });
    joints[joint][component + "_rigid"] = ranges_json(
        result.points, [&](const SweepPoint& p) { return c < p.joints_rigid.size() ? &p.joints_rigid[c] : nullptr; });
  }
  json["torque"] = ranges_json(result.points, [](const SweepPoint& p) { return p.torque ? &*p.torque : nullptr; });
  json["torque"]["rigid"] =
      ranges_json(result.points, [](const SweepPoint& p) { return p.torque_rigid ? &*p.torque_rigid : nullptr; });
  const auto errors = [&](const char* key, double ForceErrors::*error) {
    json[key] = over_points(result.points, [&](const SweepPoint& p) {
      return p.force_errors ? number((*p.force_errors).*error) : Json(nullptr);
    });
  };
  errors("joints_error", &ForceErrors::force);
  errors("torque_error", &ForceErrors::torque);
  errors("joints_modes_error", &ForceErrors::force_cut);
  errors("torque_modes_error", &ForceErrors::torque_cut);
  add_machine(json, result);
}

Json critical_json(const SweepResult& result, const CriticalPoint& point, const SweepScene& scene) {
  Json json = {{"rod", result.rods[point.rod].name}, {"x", point.peak.x}};
  if (is_speed(scene)) json["rpm"] = rpm_from_speed(point.speed, scene.scene().units);
  json["omega"] = point.speed;
  json["error"] = point.peak.error;
  json["q"] = point.component + 1;
  json["max_abs"] = number(point.peak.value);
  json["unbounded"] = std::isinf(point.peak.value);
  json["prominence"] = point.prominence;
  if (const SweepPoint* there = refined_point(result, point.peak.x); there && has_theory(scene, result))
    json["theory_error"] = number(there->rods[point.rod].theory_error);
  if (point.mode >= 0) {
    json["mode"] = point.mode + 1;
    json["order"] = point.order;
    json["frequency"] = point.frequency;
    json["damping"] = point.damping;
  }
  return json;
}

Json band_json(const UnstableBand& band) {
  return {{"from", band.from},
          {"to", band.to},
          {"from_kind", band.open_from ? Json(nullptr) : Json(to_string(band.kind_from))},
          {"to_kind", band.open_to ? Json(nullptr) : Json(to_string(band.kind_to))},
          {"from_error", band.error_from},
          {"to_error", band.error_to},
          {"fastest_growth", band.fastest},
          {"fastest_at", band.fastest_x}};
}

// Of all elastic links; null where the linkage does not close.
Json verdicts_json(const std::vector<SweepPoint>& points) {
  Json verdicts = Json::array();
  for (const SweepPoint& point : points) {
    Verdict verdict = Verdict::stable;
    for (const RodPoint& rod : point.rods)
      if (rod.stability) verdict = worst(verdict, rod.stability->stability.verdict);
    verdicts.push_back(point.rods.empty() ? Json() : Json(to_string(verdict)));
  }
  return verdicts;
}

void add_critical(Json& json, const SweepScene& scene, const SweepResult& result) {
  std::vector<double> critical, critical_x;
  for (const CriticalPoint& point : result.critical) critical_x.push_back(point.peak.x);
  std::sort(critical_x.begin(), critical_x.end());
  critical_x.erase(std::unique(critical_x.begin(), critical_x.end()), critical_x.end());
  if (is_speed(scene)) {
    for (const double x : critical_x)
      critical.push_back(scene.axis().kind == Axis::Kind::rpm ? x : rpm_from_speed(x, scene.scene().units));
    json["critical_rpm"] = critical;
  } else {
    json["critical_rpm"] = Json::array();
  }
  json["critical_x"] = critical_x;
  Json& list = json["critical"] = Json::array();
  for (const CriticalPoint& point : result.critical) list.push_back(critical_json(result, point, scene));
}

void add_bands(Json& json, const SweepResult& result) {
  Json bands = Json::object(), not_excluded = Json::object(), details = Json::object();
  for (const SweepRod& rod : result.rods) {
    if (!rod.reported) continue;
    Json pairs = Json::array(), list = Json::array();
    for (const UnstableBand& band : rod.bands) {
      pairs.push_back(Json::array({band.from, band.to}));
      list.push_back(band_json(band));
    }
    bands[rod.name] = std::move(pairs);
    not_excluded[rod.name] = rod.not_excluded;
    details[rod.name] = std::move(list);
  }
  json["unstable_bands"] = std::move(bands);
  json["not_excluded"] = std::move(not_excluded);
  json["band_details"] = std::move(details);
}

}  // namespace

std::string axis_label(const SweepScene& scene) {
  switch (scene.axis().kind) {
    case Axis::Kind::rpm:
      return "crank speed [rpm]";
    case Axis::Kind::omega:
      return "omega [rad/" + scene.scene().units.time + "]";
    case Axis::Kind::parameter:
      break;
  }
  return scene.axis().path + bracketed(path_unit(scene.axis().path, scene.scene().units));
}

Json sweep_json(const SweepScene& scene, const SweepResult& result, bool stats) {
  const Units& units = scene.scene().units;
  const std::vector<SweepPoint>& points = result.points;
  Json json = object_with_room(most_keys);
  json["title"] = scene.scene().title;
  json["status"] = result.shortfalls.empty() ? "reached" : "tolerance not reached";
  std::vector<std::string> notes = result.shortfalls;
  notes.insert(notes.end(), result.notes.begin(), result.notes.end());
  if (!notes.empty()) json["notes"] = std::move(notes);
  if (std::vector<std::string> warnings = sweep_warnings(scene, result); !warnings.empty())
    json["warnings"] = std::move(warnings);
  json["tolerance"] = scene.settings().tolerance;
  json["units"] = units_json(units);
  json["x"] = {{"path", scene.axis().path}, {"values", scene.axis().values}};
  Json rpm = Json::array(), omega = Json::array();
  for (const SweepPoint& point : points) {
    rpm.push_back(scene.axis().kind == Axis::Kind::rpm     ? point.x
                  : scene.axis().kind == Axis::Kind::omega ? rpm_from_speed(point.speed, units)
                                                           : scene.fixed_rpm());
    omega.push_back(point.speed);
  }
  json["rpm"] = std::move(rpm);
  json["omega"] = std::move(omega);
  if (result.computed.stability && !result.rods.empty()) json["verdict"] = verdicts_json(points);
  Json& rods = json["rods"] = object_with_room(result.rods.size());
  for (std::size_t r = 0; r < result.rods.size(); ++r)
    if (result.rods[r].reported) rods[result.rods[r].name] = rod_json(scene, result, r, points);
  if (result.searched_peaks) add_critical(json, scene, result);
  if (result.searched_bands) add_bands(json, result);
  if (result.computed.reactions) add_forces(json, result);
  add_theory(json, scene, result);
  Json problems = Json::array();
  for (std::size_t k = 0; k < points.size(); ++k)
    if (!points[k].problem.empty())
      problems.push_back({{"index", k}, {"x", points[k].x}, {"reason", points[k].problem}});
  if (!problems.empty()) json["problems"] = std::move(problems);
  if (!result.refined.empty()) {
    Json& refined = json["refined"] = object_with_room(2);
    Json x = Json::array();
    for (const SweepPoint& point : result.refined) x.push_back(point.x);
    refined["x"] = std::move(x);
    Json& refined_rods = refined["rods"] = object_with_room(result.rods.size());
    for (std::size_t r = 0; r < result.rods.size(); ++r)
      if (result.rods[r].reported) refined_rods[result.rods[r].name] = rod_json(scene, result, r, result.refined);
  }
  if (stats) add_stats(json, result.stages, scene.settings());
  return json;
}

}  // namespace hb::tools
