#include "tools/output/scene_report.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "lib/linkage/kinematics.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;
constexpr int num_frequencies = 3;

// sin of the transmission angle of one dyad.
double sine_at(const Linkage& linkage, int dyad, double crank_angle, std::vector<BodyMotion>& motion) {
  motion_at(linkage, crank_angle, motion);
  const std::complex<double> coupler = motion[static_cast<std::size_t>(coupler_index(dyad))].e;
  const std::complex<double> closing = motion[static_cast<std::size_t>(closing_index(dyad))].e;
  const std::complex<double> turned = coupler * std::conj(closing);
  const bool is_slider = std::holds_alternative<Slider>(linkage.dyads[static_cast<std::size_t>(dyad)].closing);
  return std::abs(is_slider ? turned.real() : turned.imag());
}

std::string modes_text(const AnalysisDefaults& analysis) {
  return std::holds_alternative<AutoModes>(analysis.modes) ? "auto" : fmt::format("{}", std::get<int>(analysis.modes));
}

std::string speeds_text(const Scene& scene) {
  const AnalysisDefaults& analysis = scene.analysis;
  if (analysis.rpm && analysis.rpm->step != 0) {
    return fmt::format("{:.10g} to {:.10g} rpm in steps of {:.10g}", analysis.rpm->from, analysis.rpm->to,
                       analysis.rpm->step);
  }
  if (analysis.rpm) return fmt::format("{:.10g} rpm", analysis.rpm->from);
  if (analysis.omega) return fmt::format("omega = {:.10g} rad/{}", *analysis.omega, scene.units.time);
  return "no speed";
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

using Text = fmt::memory_buffer;

template <class... Args>
void add(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
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
  for (const auto& [name, point] : body.points) {
    add(text, "           point {}.{} at {} {} in its frame\n", body.name, name, point_text(point), units.length);
  }
  if (!body.elastic) return;
  const Elastic& elastic = *body.elastic;
  const std::string pressure = fmt::format("{}/({} {}^2)", units.mass, units.length, units.time);
  add(text, "           elastic: E {:.6g} {}, area {:.6g} {}^2, J {:.6g} {}^4, density {:.6g} {}/{}^3\n",
      elastic.youngs_modulus, pressure, elastic.area, units.length, elastic.second_moment, units.length,
      elastic.density, units.mass, units.length);
  add(text, "           damping: internal {:.6g} {}, external {:.6g} along and {:.6g} across {}/({} {})\n",
      elastic.internal_damping, units.time, elastic.damping_x, elastic.damping_y, units.mass, units.length, units.time);
  std::vector<std::string> frequencies, speeds;
  for (const double omega : natural_frequencies(body, num_frequencies)) {
    frequencies.push_back(fmt::format("{:.6g}", omega));
    speeds.push_back(fmt::format("{:.6g}", rpm_from_speed(omega, units)));
  }
  add(text, "           natural frequencies at rest, slender: {} rad/{} (as crank speeds: {} rpm)\n",
      fmt::join(frequencies, ", "), units.time, fmt::join(speeds, ", "));
}

std::string force_text(const FourierSeries& force, const Units& units) {
  const Eigen::Index harmonics = force.num_components() == 0 ? -1 : force.num_harmonics();
  if (harmonics < 0) return "";
  if (harmonics > 0) return fmt::format(", applied force of {} harmonic{}", harmonics, harmonics == 1 ? "" : "s");
  return fmt::format(", constant applied force {:.6g} {} {}/{}^2", force.c(0, 0).real(), units.mass, units.length,
                     units.time);
}

void add_linkage(Text& text, const Scene& scene, const Linkage& linkage) {
  const Units& units = scene.units;
  add(text, "gravity {:.6g} {}/{}^2 along -y\n\n", linkage.gravity, units.length, units.time);
  add_body(text, linkage.crank.body, "crank", units);
  add(text, "           pivot at {} {}\n", point_text(linkage.crank.pivot), units.length);
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const Dyad& dyad = linkage.dyads[d];
    const auto* rocker = std::get_if<Rocker>(&dyad.closing);
    add(text, "\ndyad {} ({}) on {}, branch {:+d}\n", d + 1, rocker ? "coupler and rocker" : "coupler and slider",
        dyad.on.name, dyad.branch);
    add_body(text, dyad.coupler, "coupler", units);
    if (rocker) {
      add_body(text, rocker->body, "rocker", units);
      add(text, "           pivot at {} {}\n", point_text(rocker->pivot), units.length);
    } else {
      const Slider& slider = std::get<Slider>(dyad.closing);
      add(text, "  {:<8} {:<12} mass {:.6g} {}, guide through {} {}, direction {:.6g} deg{}\n", "slider", slider.name,
          slider.mass, units.mass, point_text(slider.guide), units.length, slider.direction * degrees_per_radian,
          force_text(slider.force, units));
    }
    const TransmissionAngle worst = transmission_angle(linkage, static_cast<int>(d));
    add(text, "  smallest transmission angle {:.4g} deg, at crank angle {:.4g} deg\n",
        worst.smallest * degrees_per_radian, worst.crank_angle * degrees_per_radian);
  }
}

Eigen::Index highest_harmonic(const std::array<FourierSeries, 3>& powers) {
  Eigen::Index highest = 0;
  for (const FourierSeries& series : powers) highest = std::max(highest, series.num_harmonics());
  return highest;
}

Json point_json(std::complex<double> given) {
  const std::complex<double> point = cleaned(given);
  return Json::array({point.real(), point.imag()});
}

Json body_json(const Body& body, const Units& units) {
  Json json = {
      {"length", body.length}, {"mass", body.mass}, {"com_xy", point_json(body.com)}, {"inertia", body.inertia}};
  if (!body.points.empty()) {
    for (const auto& [name, point] : body.points) json["points_xy"][name] = point_json(point);
  }
  if (body.elastic) {
    const Elastic& elastic = *body.elastic;
    json["elastic"] = {{"E", elastic.youngs_modulus},
                       {"area", elastic.area},
                       {"J", elastic.second_moment},
                       {"density", elastic.density},
                       {"damping_internal", elastic.internal_damping},
                       {"damping_x", elastic.damping_x},
                       {"damping_y", elastic.damping_y}};
    const std::vector<double> frequencies = natural_frequencies(body, num_frequencies);
    json["natural_frequencies"] = frequencies;
    for (const double omega : frequencies) json["natural_frequencies_rpm"].push_back(rpm_from_speed(omega, units));
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
    }
    const TransmissionAngle worst = transmission_angle(linkage, static_cast<int>(d));
    entry["transmission_angle"] = {{"min", scene_angle(worst.smallest, units)},
                                   {"crank_angle", scene_angle(worst.crank_angle, units)}};
    dyads.push_back(std::move(entry));
  }
  return json;
}

}  // namespace

TransmissionAngle transmission_angle(const Linkage& linkage, int dyad) {
  constexpr int num_samples = 720;
  constexpr double step = 2 * std::numbers::pi / num_samples;
  std::vector<BodyMotion> motion;
  int worst = 0;
  double smallest = 2;
  for (int j = 0; j < num_samples; ++j) {
    const double sine = sine_at(linkage, dyad, j * step, motion);
    if (sine < smallest) smallest = sine, worst = j;
  }
  // Golden section about the smallest sample.
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  double low = (worst - 1) * step, high = (worst + 1) * step;
  while (high - low > 1e-9) {
    const double left = high - ratio * (high - low), right = low + ratio * (high - low);
    if (sine_at(linkage, dyad, left, motion) <= sine_at(linkage, dyad, right, motion)) {
      high = right;
    } else {
      low = left;
    }
  }
  const double angle = (low + high) / 2;
  const double sine = std::min(smallest, sine_at(linkage, dyad, angle, motion));
  const double turn = 2 * std::numbers::pi;
  // A smooth minimum is found to the root of rounding: what lies that near to a full turn is its beginning.
  const double in_turn = angle < 0 ? angle + turn : angle;
  return {std::asin(std::min(1.0, sine)), turn - in_turn <= 1e-7 ? 0 : in_turn};
}

std::vector<double> natural_frequencies(const Body& link, int count) {
  const Elastic& elastic = *link.elastic;
  const double mu = link.mass / link.length;
  std::vector<double> frequencies;
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
  add(text, "units: {}, {}, {}, {}; force {} {}/{}^2 = {:.6g} N\n", units.length, units.mass, units.time, units.angle,
      units.mass, units.length, units.time, units.force_in_newton());
  if (const auto* hill = std::get_if<HillSystem>(&scene.model)) {
    add(text, "linear periodic system of {} {}: stiffness with {} harmonics, load with {}\n", hill->num_modes(),
        hill->num_modes() == 1 ? "unknown" : "unknowns", highest_harmonic(hill->stiffness),
        highest_harmonic(hill->load));
  } else {
    add_linkage(text, scene, std::get<Linkage>(scene.model));
  }
  add(text, "\nanalysis: {}, modes {}, tolerance {:.1e}\n", speeds_text(scene), modes_text(scene.analysis),
      scene.analysis.tolerance);
  for (const std::string& warning : scene.warnings) add(text, "\nWARNING: {}\n", warning);
  return fmt::to_string(text);
}

Json scene_json(const Scene& scene) {
  Json json;
  json["title"] = scene.title;
  json["units"] = units_json(scene.units);
  if (const auto* hill = std::get_if<HillSystem>(&scene.model)) {
    json["system"] = {{"unknowns", hill->num_modes()},
                      {"stiffness_harmonics", highest_harmonic(hill->stiffness)},
                      {"load_harmonics", highest_harmonic(hill->load)}};
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
  if (scene.analysis.rpm) {
    const Speeds& rpm = *scene.analysis.rpm;
    analysis["rpm"] = rpm.step == 0 ? Json(rpm.from) : Json::array({rpm.from, rpm.to, rpm.step});
  }
  if (scene.analysis.omega) analysis["omega"] = *scene.analysis.omega;
  json["warnings"] = scene.warnings;
  return json;
}

}  // namespace hb::tools
