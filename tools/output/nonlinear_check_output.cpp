#include "tools/output/nonlinear_check_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tools/output/check_json.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_parts.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/text.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

Json difference(const std::optional<Comparison>& c) { return c ? number(c->difference) : Json(); }
Json allowed(const std::optional<Comparison>& c) { return c ? number(c->allowed) : Json(); }

bool compared(const NonlinearCheck& check) { return check.not_compared.empty(); }

Json system_json(const NonlinearCheck& check, double tolerance) {
  Json json;
  json["exponent_difference"] = difference(check.exponents);
  json["exponent_allowed"] = allowed(check.exponents);
  json["agrees"] = compared(check) ? Json(check.agrees()) : Json();
  Json& series = json["harmonic_balance"];
  series = {{"tolerance", tolerance},
            {"error_bound", number(check.series.motion.error_bound)},
            {"harmonics", check.series.motion.num_harmonics}};
  if (check.series.stability) {
    series["growth_rate"] = number(check.series.stability->growth_rate);
    series["growth_error"] = number(check.series.stability->growth_error);
    series["exponents"] = exponents_json(check.series.stability->exponents);
    series["verdict"] = to_string(check.series.stability->verdict);
  }
  const ShootingResult& shooting = check.shooting;
  json["shooting"] = {{"status", to_string(shooting.status)},
                      {"integrator", to_string(shooting.integrator)},
                      {"integrator_tolerance", number(shooting.integrator_tolerance)},
                      {"q_error", shooting.orbit.q.size() > 0 ? number(shooting.q_error) : Json()},
                      {"exponents", exponents_json(shooting.exponents)},
                      {"verdict", to_string(shooting.verdict)},
                      {"segments", shooting.num_segments},
                      {"steps", shooting.steps},
                      {"evaluations", shooting.evaluations},
                      {"seconds", shooting.seconds}};
  if (!shooting.message.empty()) json["shooting"]["message"] = shooting.message;
  if (!compared(check)) json["not_compared"] = check.not_compared;
  return json;
}

std::vector<std::string> reported_rods(const SceneModel& model) {
  std::vector<std::string> names;
  for (const RodModel& rod : model.rods)
    if (rod.reported) names.push_back(rod.name);
  return names;
}

// Of one rod at one speed; nothing to say where there was no comparison.
Json rod_json(const NonlinearCheck& check, std::size_t r) {
  Json json;
  const bool known = compared(check);
  json["q_difference"] = known ? number(check.rods[r].q.difference) : Json();
  json["exponent_difference"] = known ? difference(check.exponents) : Json();
  json["agrees"] = known ? Json(check.rods[r].agrees() && (!check.exponents || check.exponents->agrees())) : Json();
  json["q_allowed"] = known ? number(check.rods[r].q.allowed) : Json();
  json["exponent_allowed"] = known ? allowed(check.exponents) : Json();
  json["q1_difference"] = known ? number(check.rods[r].q1.difference) : Json();
  json["q1_allowed"] = known ? number(check.rods[r].q1.allowed) : Json();
  return json;
}

void add_comparison(Text& text, const std::string& name, const Comparison& c, const std::string& unit) {
  add(text, "  {:<8} {:<20} {:>10.2e}  {:>10.2e}  {}\n", name, c.what + unit, c.difference, c.allowed,
      c.agrees() ? "agrees" : "DISAGREES");
}

// Of the motion of all rods together.
NamedVerdicts verdicts(const NonlinearCheck& check) {
  if (!check.series.stability) return {};
  return {{"all rods together", check.series.stability->verdict}};
}

void add_check(Text& text, const SceneModel& model, const NonlinearCheck& check, const Settings& settings) {
  const OutputUnits units = output_units(model.scene);
  const std::string verdict = mechanism_verdict(verdicts(check));
  add(text, "{}, {}{}{}\nmotion without linearisation{}, harmonic balance against time integration\n",
      scene_name(model.scene), speed_text(check.speed, model.scene), verdict.empty() ? "" : ": ", verdict,
      check.series.turns == 1 ? "" : fmt::format(", period of {} turns", check.series.turns));
  if (check.series.search == MotionSearch::found)
    add(text, "  harmonic balance  asked {:.1e}, error {:.1e}, {} harmonics, {:.3g} s\n", settings.tolerance,
        check.series.motion.error_bound, check.series.motion.num_harmonics, check.seconds_harmonic_balance);
  if (check.shooting.orbit.q.size() > 0)
    add(text, "  shooting          reached {:.1e}; {}, {} steps, {} segment{}, {:.3g} s\n", check.shooting.q_error,
        to_string(check.shooting.integrator), check.shooting.steps, check.shooting.num_segments,
        check.shooting.num_segments == 1 ? "" : "s", check.seconds_shooting);
  if (!compared(check)) {
    add(text, "  not compared: {}\n", check.not_compared);
  } else {
    add(text, "  {:<29} {:>10}  {:>10}\n", "", "difference", "allowed");
    for (const NonlinearRodCheck& rod : check.rods) {
      add_comparison(text, rod.name, rod.q, "");
      add_comparison(text, "", rod.q1, "");
    }
    if (check.exponents) add_comparison(text, "all", *check.exponents, bracketed(units.rate));
    if (check.series.stability)
      add(text, "  growth rate{} {} and {}; {} and {}\n", bracketed(units.rate),
          with_error(check.series.stability->growth_rate, check.series.stability->growth_error),
          with_error(check.shooting.growth_rate, check.shooting.growth_error),
          to_string(check.series.stability->verdict), to_string(check.shooting.verdict));
  }
  for (const std::string& sentence : check.shortfalls) add(text, "NOT REACHED: {}\n", sentence);
}

}  // namespace

Json nonlinear_check_json(const SceneModel& model, const std::vector<NonlinearCheck>& checks,
                          const Settings& settings) {
  const Units& units = model.scene.units;
  const std::vector<std::string> names = reported_rods(model);
  Json json;
  json["title"] = model.scene.title;
  json["theory"] = "nonlinear";
  const bool one = checks.size() == 1;
  const auto each = [&](const auto& value) {
    if (one) return Json(value(checks.front()));
    Json list = Json::array();
    for (const NonlinearCheck& check : checks) list.push_back(value(check));
    return list;
  };
  json["rpm"] = each([&](const NonlinearCheck& c) { return Json(rpm_of(c.speed, units)); });
  json["omega"] = each([](const NonlinearCheck& c) { return Json(c.speed); });
  json["agrees"] = std::ranges::all_of(checks, &NonlinearCheck::agrees);
  if (std::ranges::any_of(checks, [](const NonlinearCheck& c) { return c.series.stability.has_value(); }))
    json["verdict"] = each([](const NonlinearCheck& c) {
      return c.series.stability ? Json(to_string(c.series.stability->verdict)) : Json();
    });
  json["rods"] = Json::object();
  for (std::size_t r = 0; r < names.size(); ++r) {
    if (one) {
      json["rods"][names[r]] = rod_json(checks.front(), r);
      continue;
    }
    for (const NonlinearCheck& check : checks) {
      const Json entry = rod_json(check, r);
      for (const auto& [key, value] : entry.items()) json["rods"][names[r]][key].push_back(value);
    }
  }
  json["system"] = each([&](const NonlinearCheck& c) { return system_json(c, settings.tolerance); });
  double series = 0, shooting = 0;
  for (const NonlinearCheck& check : checks) {
    series += check.seconds_harmonic_balance;
    shooting += check.seconds_shooting;
  }
  if (!model.scene.warnings.empty()) json["warnings"] = model.scene.warnings;
  json["seconds"] = {{"harmonic_balance", series}, {"shooting", shooting}};
  std::vector<ShortfallsAt> shortfalls;
  for (const NonlinearCheck& check : checks) shortfalls.push_back({check.speed, check.shortfalls});
  add_shortfalls(json, model.scene, shortfalls);
  return json;
}

std::string nonlinear_check_report(const SceneModel& model, const std::vector<NonlinearCheck>& checks,
                                   const Settings& settings) {
  Text text;
  bool agree = true, complete = true;
  for (const NonlinearCheck& check : checks) {
    add_check(text, model, check, settings);
    if (check.opposite_verdicts())
      add(text, "DISAGREES: harmonic balance says {}, time integration {}\n",
          to_string(check.series.stability->verdict), to_string(check.shooting.verdict));
    add(text, "\n");
    agree = agree && check.agrees();
    complete = complete && compared(check);
  }
  for (const std::string& warning : model.scene.warnings) add(text, "WARNING: {}\n", warning);
  add(text, "{}\n",
      !agree     ? "The paths DISAGREE."
      : complete ? "The paths agree within the sum of their error bars."
                 : "Not everything could be compared; what could agrees within the sum of the error bars.");
  return fmt::to_string(text);
}

}  // namespace hb::tools
