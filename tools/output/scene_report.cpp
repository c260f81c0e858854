#include "tools/output/scene_report.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "lib/linkage/kinematics.hpp"
#include "lib/linkage/transmission_angle.hpp"
#include "lib/rod/shear.hpp"
#include "tools/output/hill_report.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/text.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

constexpr int num_frequencies = 3;

std::string modes_text(const AnalysisDefaults& analysis) {
  return std::holds_alternative<AutoModes>(analysis.modes) ? "auto" : fmt::format("{}", std::get<int>(analysis.modes));
}

std::string speeds_text(const Scene& scene) {
  const AnalysisDefaults& analysis = scene.analysis;
  if (!analysis.rpm && !analysis.omega) return "no speed";
  const Speeds& speeds = analysis.rpm ? *analysis.rpm : *analysis.omega;
  const std::string unit = analysis.rpm ? "rpm" : "rad/" + scene.units.time;
  if (speeds.step == 0) return fmt::format("{:.10g} {}", speeds.from, unit);
  return fmt::format("{:.10g} to {:.10g} {} in steps of {:.10g}", speeds.from, speeds.to, unit, speeds.step);
}

// cos 90 deg is 6e-17: what is rounding beside the other coordinate counts as 0.
std::complex<double> cleaned(std::complex<double> point) {
  const double rounding = 1e-15 * std::abs(point);
  const auto clean = [&](double x) { return std::abs(x) <= rounding ? 0.0 : x; };
  return {clean(point.real()), clean(point.imag())};
}

std::string point_text(std::complex<double> given) {
  const std::complex<double> point = cleaned(given);
  return fmt::format("({:.6g}, {:.6g})", point.real(), point.imag());
}

// By how much shear, with Poisson's ratio 0.3 and k = 5/6, would lower the frequencies of the first and the last mode.
void add_shear_left_out(Text& text, const Body& link) {
  Body sheared = link;
  sheared.elastic->shear = Shear{link.elastic->youngs_modulus / 2.6, 5.0 / 6};
  constexpr int last = 5;
  const RestModes modes = rest_modes(sheared, last);
  const double rotary = link.elastic->density / link.elastic->youngs_modulus;
  const double mu_EJ = link.mass / link.length / (link.elastic->youngs_modulus * link.elastic->second_moment);
  const auto percent = [&](int mode) {
    const double k2 = std::pow(mode * std::numbers::pi / link.length, 2);
    const double square = modes.stiffness[0](mode - 1) / modes.mass[0](mode - 1);
    return 100 * (1 - std::sqrt(square * (rotary * k2 + mu_EJ)) / k2);
  };
  add(text,
      "           shear left out: it would lower the frequency of mode 1 by about {:.2g} %, of mode {} by {:.2g} %\n",
      percent(1), last, percent(last));
}

// Elastic data in the units of data sheets: GPa, MPa, kg/m^3, Hz; lengths in the scene's.
void add_elastic(Text& text, const Body& body, const Units& units) {
  const Elastic& elastic = *body.elastic;
  const double L = units.length_in_m, pascal = units.force_in_newton() / (L * L);
  const double EJ = elastic.youngs_modulus * elastic.second_moment, k = std::numbers::pi / body.length;
  const double gyration = std::sqrt(elastic.second_moment / elastic.area);
  add(text, "           elastic: E {:.6g} GPa, area {:.6g} {}^2, J {:.6g} {}^4, density {:.6g} kg/m^3\n",
      elastic.youngs_modulus * pascal * 1e-9, elastic.area, units.length, elastic.second_moment, units.length,
      elastic.density * units.mass_in_kg / (L * L * L));
  add(text, "           section: radius of gyration {:.4g} {}, slenderness {:.4g}{}\n", gyration, units.length,
      body.length / gyration,
      elastic.section_height > 0 ? fmt::format(", height {:.6g} {}", elastic.section_height, units.length) : "");
  add(text, "           buckling load {:.4g} N (pinned ends, elastic), which is {:.4g} MPa\n",
      EJ * k * k * units.force_in_newton(), EJ * k * k / elastic.area * pascal * 1e-6);
  const Strength& strength = elastic.strength;
  std::string strengths;
  for (const auto& [name, value] : {std::pair("yield", strength.yield), std::pair("tensile", strength.tensile),
                                    std::pair("endurance", strength.endurance)})
    if (value > 0)
      strengths += fmt::format("{}{} {:.6g} MPa", strengths.empty() ? "" : ", ", name, value * pascal * 1e-6);
  if (!strengths.empty()) add(text, "           strength: {}\n", strengths);
  if (elastic.shear) {
    add(text, "           shear: G {:.6g} GPa, k {:.6g}\n", elastic.shear->modulus * pascal * 1e-9,
        elastic.shear->coefficient);
  }
  const std::vector<double> omega = natural_frequencies(body, num_frequencies);
  // lib/README.md (M9), rotary inertia included; (S5) with shear.
  const double m = elastic.density / elastic.youngs_modulus * k * k + body.mass / body.length / EJ;
  const double first = elastic.shear ? omega.front() : k * k / std::sqrt(m);
  add(text,
      "           damping: internal {:.6g} {} (ratio {:.3g} of mode 1), external {:.6g} along and {:.6g} across {}/({} "
      "{})\n",
      elastic.internal_damping, units.time, elastic.internal_damping * first / 2, elastic.damping_x, elastic.damping_y,
      units.mass, units.length, units.time);
  std::vector<std::string> hertz, speeds;
  for (const double frequency : omega) {
    hertz.push_back(fmt::format("{:.6g}", frequency / (2 * std::numbers::pi * units.time_in_s)));
    speeds.push_back(fmt::format("{:.6g}", rpm_from_speed(frequency, units)));
  }
  add(text, "           natural frequencies at rest, {}: {} Hz (as crank speeds: {} rpm)\n",
      elastic.shear ? "with shear" : "without shear", fmt::join(hertz, ", "), fmt::join(speeds, ", "));
  if (!elastic.shear) add_shear_left_out(text, body);
}

// Further joints of a link or slider.
void add_points(Text& text, const std::string& name, const std::map<std::string, std::complex<double>>& points,
                const Units& units) {
  for (const auto& [point, place] : points)
    add(text, "           point {}.{} at {} {} in its frame\n", name, point, point_text(place), units.length);
}

void add_body(Text& text, const Body& body, const char* kind, const Units& units) {
  add(text, "  {:<8} {:<12} length {:.6g} {}, mass {:.6g} {}", kind, body.name, body.length, units.length, body.mass,
      units.mass);
  if (!body.elastic) {
    if (body.mass != 0) add(text, ", centre of mass {} {}", point_text(body.com), units.length);
    if (body.inertia != 0) {
      add(text, ", inertia {:.6g} {} {}^2 about it", body.inertia, units.mass, units.length);
    }
  }
  add(text, "\n");
  add_points(text, body.name, body.points, units);
  if (!body.elastic) return;
  add_elastic(text, body, units);
}

// Along the direction is away from the crank where the position is positive there.
std::string force_text(const Slider& slider, int branch, const Units& units) {
  if (slider.force.num_components() == 0) return "";
  const double newton = units.force_in_newton();
  const Range range = fourier::range(slider.force, 0);
  const std::string sense =
      fmt::format("positive = along direction ({} the crank)", branch > 0 ? "away from" : "toward");
  if (slider.force.num_harmonics() == 0) {
    return fmt::format("           constant applied force {:.6g} N, {}\n", range.max.value * newton, sense);
  }
  return fmt::format("           applied force {:.6g} .. {:.6g} N, mean {:.6g} N, {}; {} harmonics\n",
                     range.min.value * newton, range.max.value * newton, slider.force.c(0, 0).real() * newton, sense,
                     slider.force.num_harmonics());
}

void add_linkage(Text& text, const Scene& scene, const Linkage& linkage) {
  const Units& units = scene.units;
  add(text, "gravity {:.6g} {}/{}^2 along -y\n\n", linkage.gravity, units.length, units.time);
  add_body(text, linkage.crank.body, "crank", units);
  add(text, "           pivot at {} {}\n", point_text(linkage.crank.pivot), units.length);
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const Dyad& dyad = linkage.dyads[d];
    const auto* rocker = std::get_if<Rocker>(&dyad.closing);
    add(text, "\ndyad.{} ({}) on {}, branch {:+d}\n", d, rocker ? "coupler and rocker" : "coupler and slider",
        dyad.on.name, dyad.branch);
    add_body(text, dyad.coupler, "coupler", units);
    if (rocker) {
      add_body(text, rocker->body, "rocker", units);
      add(text, "           pivot at {} {}\n", point_text(rocker->pivot), units.length);
    } else {
      const Slider& slider = std::get<Slider>(dyad.closing);
      add(text, "  {:<8} {:<12} mass {:.6g} {}, guide through {} {}, direction {:.6g} deg\n", "slider", slider.name,
          slider.mass, units.mass, point_text(slider.guide), units.length, slider.direction * degrees_per_radian);
      add_points(text, slider.name, slider.points, units);
      text.append(force_text(slider, dyad.branch, units));
    }
    const TransmissionAngle worst = transmission_angle(linkage, static_cast<int>(d));
    add(text, "  smallest transmission angle {:.4g} deg, at crank angle {:.4g} deg\n",
        worst.smallest * degrees_per_radian, worst.crank_angle * degrees_per_radian);
  }
}

Json point_json(std::complex<double> given) {
  const std::complex<double> point = cleaned(given);
  return Json::array({point.real(), point.imag()});
}

Json body_json(const Body& body, const Units& units) {
  Json json = {
      {"length", body.length}, {"mass", body.mass}, {"com_xy", point_json(body.com)}, {"inertia", body.inertia}};
  for (const auto& [name, point] : body.points) json["points_xy"][name] = point_json(point);
  if (body.elastic) {
    const Elastic& elastic = *body.elastic;
    json["elastic"] = {{"E", elastic.youngs_modulus},
                       {"area", elastic.area},
                       {"J", elastic.second_moment},
                       {"density", elastic.density},
                       {"damping_internal", elastic.internal_damping},
                       {"damping_x", elastic.damping_x},
                       {"damping_y", elastic.damping_y}};
    if (elastic.shear) json["elastic"]["shear"] = {{"G", elastic.shear->modulus}, {"k", elastic.shear->coefficient}};
    if (elastic.section_height > 0) json["elastic"]["section_height"] = elastic.section_height;
    if (elastic.strength.yield > 0) json["elastic"]["yield"] = elastic.strength.yield;
    if (elastic.strength.tensile > 0) json["elastic"]["tensile"] = elastic.strength.tensile;
    if (elastic.strength.endurance > 0) json["elastic"]["endurance"] = elastic.strength.endurance;
    json["elastic"]["slenderness"] = body.length / std::sqrt(elastic.second_moment / elastic.area);
    const std::vector<double> frequencies = natural_frequencies(body, num_frequencies);
    json["natural_frequencies"] = frequencies;
    for (const double omega : frequencies) {
      json["natural_frequencies_rpm"].push_back(rpm_from_speed(omega, units));
      json["natural_frequencies_hz"].push_back(omega / (2 * std::numbers::pi * units.time_in_s));
    }
  }
  return json;
}

Json linkage_json(const Linkage& linkage, const Units& units) {
  Json json;
  json["gravity"] = linkage.gravity;
  json["crank"] = body_json(linkage.crank.body, units);
  json["crank"]["name"] = linkage.crank.body.name;
  json["crank"]["pivot"] = point_json(linkage.crank.pivot);
  Json& dyads = json["dyads"] = Json::array();
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const Dyad& dyad = linkage.dyads[d];
    Json entry = {{"on", dyad.on.name}, {"branch", dyad.branch}};
    entry["coupler"] = body_json(dyad.coupler, units);
    entry["coupler"]["name"] = dyad.coupler.name;
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      entry["rocker"] = body_json(rocker->body, units);
      entry["rocker"]["name"] = rocker->body.name;
      entry["rocker"]["pivot"] = point_json(rocker->pivot);
    } else {
      const Slider& slider = std::get<Slider>(dyad.closing);
      entry["slider"] = {{"name", slider.name},
                         {"mass", slider.mass},
                         {"guide", point_json(slider.guide)},
                         {"direction", scene_angle(slider.direction, units)},
                         {"force_harmonics", std::max<Eigen::Index>(0, slider.force.num_harmonics())}};
      for (const auto& [name, point] : slider.points) entry["slider"]["points_xy"][name] = point_json(point);
      if (slider.force.num_components() > 0) {
        const Range range = fourier::range(slider.force, 0);
        entry["slider"]["force"] = {
            {"min", range.min.value}, {"max", range.max.value}, {"mean", slider.force.c(0, 0).real()}};
      }
    }
    const TransmissionAngle worst = transmission_angle(linkage, static_cast<int>(d));
    entry["transmission_angle"] = {{"min", scene_angle(worst.smallest, units)},
                                   {"crank_angle", scene_angle(worst.crank_angle, units)}};
    dyads.push_back(std::move(entry));
  }
  return json;
}

}  // namespace

std::vector<double> natural_frequencies(const Body& link, int count) {
  const Elastic& elastic = *link.elastic;
  const double mu = link.mass / link.length;
  std::vector<double> frequencies;
  if (elastic.shear) {
    const RestModes modes = rest_modes(link, count);
    for (int i = 0; i < count; ++i) frequencies.push_back(std::sqrt(modes.stiffness[0](i) / modes.mass[0](i)));
    return frequencies;
  }
  for (int i = 1; i <= count; ++i) {
    const double wave_number = i * std::numbers::pi / link.length;
    frequencies.push_back(wave_number * wave_number * std::sqrt(elastic.youngs_modulus * elastic.second_moment / mu));
  }
  return frequencies;
}

std::string scene_table(const Scene& scene) {
  const Units& units = scene.units;
  Text text;
  add(text, "{}\n", scene_name(scene));
  if (const auto* hill = std::get_if<HillSystem>(&scene.model)) {
    add(text, "{}", hill_table(*hill, scene));
  } else {
    add(text, "units: {}, {}, {}, {}; force {} {}/{}^2 = {:.6g} N\n", units.length, units.mass, units.time, units.angle,
        units.mass, units.length, units.time, units.force_in_newton());
    add_linkage(text, scene, std::get<Linkage>(scene.model));
  }
  add(text, "\nanalysis: {}, modes {}, tolerance {:.1e}\n", speeds_text(scene), modes_text(scene.analysis),
      scene.analysis.tolerance);
  for (const std::string& note : scene.notes) add(text, "\nNOTE: {}\n", note);
  for (const std::string& warning : scene.warnings) add(text, "\nWARNING: {}\n", warning);
  return fmt::to_string(text);
}

Json scene_json(const Scene& scene) {
  Json json;
  json["title"] = scene.title;
  json["units"] = units_json(scene.units);
  if (const auto* hill = std::get_if<HillSystem>(&scene.model)) {
    json["system"] = hill_json(*hill, scene);
  } else {
    json["linkage"] = linkage_json(std::get<Linkage>(scene.model), scene.units);
  }
  Json& analysis = json["analysis"];
  if (const int* modes = std::get_if<int>(&scene.analysis.modes)) {
    analysis["modes"] = *modes;
  } else {
    analysis["modes"] = "auto";
  }
  analysis["tolerance"] = scene.analysis.tolerance;
  const auto speeds = [](const Speeds& given) {
    return given.step == 0 ? Json(given.from) : Json::array({given.from, given.to, given.step});
  };
  if (scene.analysis.rpm) analysis["rpm"] = speeds(*scene.analysis.rpm);
  if (scene.analysis.omega) analysis["omega"] = speeds(*scene.analysis.omega);
  json["warnings"] = scene.warnings;
  json["notes"] = scene.notes;
  return json;
}

}  // namespace hb::tools
