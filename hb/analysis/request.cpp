#include "hb/analysis/request.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "hb/analysis/accuracy.hpp"

namespace hb {
namespace {

std::string without_marks(std::string text) {
  std::erase(text, '@');
  return text;
}

std::string behind(const std::string& field, const std::string& sentence) {
  return field.empty() ? without_marks(sentence) : field + ": " + without_marks(sentence);
}

}  // namespace

RequestError::RequestError(std::string field_name, std::string what_found, std::string what_allowed)
    : RequestError(field_name, what_found, what_allowed,
                   fmt::format("found {}, allowed: {}", what_found, what_allowed)) {}

RequestError::RequestError(std::string field_name, std::string what_found, std::string what_allowed, std::string words)
    : std::runtime_error(behind(field_name, words)),
      field(std::move(field_name)),
      found(without_marks(std::move(what_found))),
      allowed(without_marks(std::move(what_allowed))),
      sentence(std::move(words)) {}

Speed Speed::from_rpm(double rpm, const Units& units) { return {speed_from_rpm(rpm, units), rpm, true}; }

Speed Speed::from_omega(double omega, const Units& units) { return {omega, rpm_from_speed(omega, units), false}; }

Only only_of(const std::vector<std::string>& names) {
  Only only{false, false, false, false};
  const std::pair<const char*, bool*> quantities[] = {{"steady", &only.steady},       {"stability", &only.stability},
                                                      {"growth", &only.growth},       {"verdict", &only.verdict},
                                                      {"reactions", &only.reactions}, {"shape", &only.shape}};
  for (const std::string& name : names) {
    const auto* found = std::ranges::find(quantities, name, &std::pair<const char*, bool*>::first);
    if (found == std::end(quantities))
      throw RequestError("only", "\"" + name + "\"",
                         "steady, stability, growth, verdict, reactions, shape, or a list of them");
    *found->second = true;
  }
  only.growth = only.growth && !only.stability;
  only.verdict = only.verdict && !only.growth && !only.stability;
  only.stability = only.stability || only.growth || only.verdict;
  return only;
}

Settings settings_of(const Request& request, const Scene& scene) {
  Settings settings;
  settings.modes = request.modes.value_or(scene.analysis.modes);
  if (const auto* hill = std::get_if<HillSystem>(&scene.model)) {
    const int size = static_cast<int>(hill->num_modes());
    const int* asked = request.modes ? std::get_if<int>(&*request.modes) : nullptr;
    if (asked && *asked != size)
      throw RequestError("modes", fmt::format("\"{}\"", *asked), fmt::format("{}, the size of [hill] mass", size));
    settings.modes = size;
  } else if (const int* modes = std::get_if<int>(&settings.modes); modes && !(*modes >= 1 && *modes <= max_modes)) {
    throw RequestError("modes", fmt::format("\"{}\"", *modes), fmt::format("an integer 1 to {}, or auto", max_modes));
  }
  settings.tolerance = request.tolerance.value_or(scene.analysis.tolerance);
  if (!(settings.tolerance >= 1e-14 && settings.tolerance <= 0.1))
    throw RequestError("tolerance", fmt::format("\"{}\"", settings.tolerance), "a number from 1e-14 to 0.1");
  settings.tolerance_asked = request.tolerance.has_value();
  settings.boundary_tolerance = request.boundary_tolerance.value_or(default_boundary_tolerance(settings.tolerance));
  if (!(settings.boundary_tolerance >= 1e-14 && settings.boundary_tolerance <= 1e-2))
    throw RequestError("boundary_tolerance", fmt::format("\"{}\"", settings.boundary_tolerance),
                       "a number from 1e-14 to 0.01");
  settings.search = request.search;
  settings.boundaries = request.boundaries;
  settings.rods = request.rods;
  settings.only = request.only;
  settings.steady_method = request.steady_method;
  settings.bound = request.bound;
  settings.stability_method = request.stability_method;
  return settings;
}

Speed speed_of(const Request& request, const Scene& scene) {
  if (request.rpm && request.omega)
    throw RequestError("omega", fmt::format("{} beside rpm = {}", *request.omega, *request.rpm), "one of the two");
  const auto checked = [](const char* field, double value) {
    if (!(value >= slowest && value <= fastest))
      throw RequestError(field, fmt::format("{}", value), fmt::format("a number from {:g} to {:g}", slowest, fastest));
    return value;
  };
  if (request.rpm) return Speed::from_rpm(checked("rpm", *request.rpm), scene.units);
  if (request.omega) return Speed::from_omega(checked("omega", *request.omega), scene.units);
  // Of a range the first: one scene serves single speeds and sweeps.
  if (scene.analysis.rpm) return Speed::from_rpm(scene.analysis.rpm->from, scene.units);
  if (scene.analysis.omega) return Speed::from_omega(scene.analysis.omega->from, scene.units);
  throw RequestError("rpm", "no speed, and the scene has none under [analysis]",
                     fmt::format("rpm, or omega (rad per {})", scene.units.time));
}

}  // namespace hb
