#include "tools/output/machine_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hb/analysis/machine_loads.hpp"
#include "hb/analysis/slider_motion.hpp"
#include "hb/analysis/static_deflection.hpp"
#include "hb/analysis/stress_cycle.hpp"
#include "lib/constants.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_parts.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

using Eigen::Index;

double watt(const Units& units) { return units.torque_in_newton_metre() / units.time_in_s; }

std::string range_of(const FourierSeries& series, Index component, double factor, int digits) {
  const Range range = fourier::range(series, component);
  return fmt::format("{:.{}g} .. {:.{}g}", range.min.value * factor, digits, range.max.value * factor, digits);
}

Eigen::VectorXd turn_angles(Index N) { return Eigen::VectorXd::LinSpaced(N + 1, 0, 360); }

// Samples over a closed turn, a column each.
Eigen::MatrixXd closed(const FourierSeries& series, Index N) {
  Eigen::MatrixXd rows(N + 1, series.num_components());
  rows.topRows(N) = fourier::synthesise(series, N).transpose();
  rows.row(N) = rows.row(0);
  return rows;
}

Index samples_for(Index harmonics) { return 360 * ((6 * std::max<Index>(harmonics, 1) + 359) / 360); }

const RodCoefficients& coefficients_of(const SceneModel& model, std::size_t rod) {
  return model.coefficients.rods[static_cast<std::size_t>(model.rods[rod].coefficients)];
}

std::optional<StaticDeflection> at_rest(const SceneModel& model, const SpeedResult& result, std::size_t rod) {
  return static_deflection(*body_at(*model.linkage(), result.rods[rod].link), coefficients_of(model, rod),
                           result.rods[rod].num_modes);
}

// Empty where the scene gives no section.
std::optional<StressCycle> cycle_of(const SceneModel& model, const SpeedResult& result, std::size_t rod) {
  const RodResult& entry = result.rods[rod];
  if (!entry.stress || !entry.stress->height_known) return std::nullopt;
  return stress_cycle(*body_at(*model.linkage(), entry.link), coefficients_of(model, rod), result.speed,
                      entry.steady->q, entry.more_modes, entry.steady->error_bound);
}

// "safety 2.31 +- 0.01": digits as its error leaves.
std::string safety_text(const SafetyFactor& safety) {
  if (!std::isfinite(safety.value)) return "safety without bound: no stress";
  if (!std::isfinite(safety.error))
    return fmt::format("safety {:.3g}, not known: the error is as large as the stress", safety.value);
  return fmt::format("safety {:.{}g}, error {:.1e}", safety.value,
                     std::min(4, trusted_digits(safety.value, safety.error)), safety.error);
}

}  // namespace

std::string stress_rows(const StressCycle& cycle, const Body& link, const OutputUnits& units) {
  // w to the left with w'' > 0 pulls at the right.
  const auto fibre = [](int side) { return side > 0 ? "right" : "left"; };
  std::string text = fmt::format(
      "  together          {:.3g} MPa at x = {:.4g} {}, crank angle {:.2f} deg, {} side; error {:.1e} MPa\n"
      "  stress cycle      mean {:.3g} MPa, amplitude {:.3g} MPa at x = {:.4g} {}, {} side\n",
      cycle.max_abs * units.megapascal, cycle.x, units.length, cycle.crank_angle * degrees_per_radian,
      fibre(cycle.side), cycle.error * units.megapascal, cycle.mean * units.megapascal,
      cycle.amplitude * units.megapascal, cycle.amplitude_x, units.length, fibre(cycle.amplitude_side));
  const Strength& strength = link.elastic->strength;
  if (cycle.yield)
    text += fmt::format("  against yielding  {} of {:.4g} MPa{}\n", safety_text(*cycle.yield),
                        strength.yield * units.megapascal,
                        cycle.yield->value < 1 ? "; THE ROD YIELDS, beyond this model" : "");
  if (const auto& fatigue = cycle.fatigue)
    text += fmt::format(
        "  against fatigue   {}, {} line: mean {:.3g} MPa, amplitude {:.3g} MPa at x = {:.4g} {}, {} side{}\n",
        safety_text(fatigue->factor), to_string(fatigue_line(strength)), fatigue->mean * units.megapascal,
        fatigue->amplitude * units.megapascal, fatigue->x, units.length, fibre(fatigue->side),
        fatigue->factor.value < 1 ? "; IT FAILS IN THE END" : "");
  return text;
}

std::string stress_rows(const SceneModel& model, const SpeedResult& result, std::size_t rod) {
  const std::optional<StressCycle> cycle = cycle_of(model, result, rod);
  if (!cycle) return "";
  return stress_rows(*cycle, *body_at(*model.linkage(), result.rods[rod].link), output_units(model.scene));
}

std::optional<std::string> yield_warning(const std::string& name, const StressCycle& cycle, const Body& link,
                                         const OutputUnits& units) {
  if (!cycle.yield || !(cycle.yield->value < 1)) return std::nullopt;
  return fmt::format("{}: it yields: {:.3g} MPa where it bears {:.4g} MPa; beyond this model", name,
                     cycle.max_abs * units.megapascal, link.elastic->strength.yield * units.megapascal);
}

std::vector<std::string> strength_warnings(const SceneModel& model, const SpeedResult& result) {
  std::vector<std::string> sentences;
  const OutputUnits units = output_units(model.scene);
  for (std::size_t r = 0; model.linkage() && r < result.rods.size(); ++r) {
    const Body& link = *body_at(*model.linkage(), result.rods[r].link);
    if (!link.elastic || !(link.elastic->strength.yield > 0)) continue;
    const std::optional<StressCycle> cycle = cycle_of(model, result, r);
    if (!cycle) continue;
    if (std::optional<std::string> sentence = yield_warning(result.rods[r].name, *cycle, link, units))
      sentences.push_back(std::move(*sentence));
  }
  return sentences;
}

void add_stress_cycle(Json& stress, const StressCycle& cycle, const Body& link, const Units& units) {
  stress["max_abs"] = cycle.max_abs;
  stress["x"] = cycle.x;
  stress["crank_angle"] = scene_angle(cycle.crank_angle, units);
  stress["side"] = cycle.side;
  stress["mean"] = cycle.mean;
  stress["amplitude"] = cycle.amplitude;
  stress["amplitude_x"] = cycle.amplitude_x;
  stress["amplitude_side"] = cycle.amplitude_side;
  stress["error"] = number(cycle.error);
  if (cycle.yield) {
    stress["yield_safety"] = number(cycle.yield->value);
    stress["yield_safety_error"] = number(cycle.yield->error);
  }
  if (const auto& fatigue = cycle.fatigue) {
    stress["fatigue_safety"] = number(fatigue->factor.value);
    stress["fatigue_safety_error"] = number(fatigue->factor.error);
    stress["fatigue_line"] = to_string(fatigue_line(link.elastic->strength));
    stress["fatigue_mean"] = fatigue->mean;
    stress["fatigue_amplitude"] = fatigue->amplitude;
    stress["fatigue_x"] = fatigue->x;
    stress["fatigue_side"] = fatigue->side;
  }
}

void add_stress_cycle(Json& stress, const SceneModel& model, const SpeedResult& result, std::size_t rod) {
  if (const std::optional<StressCycle> cycle = cycle_of(model, result, rod))
    add_stress_cycle(stress, *cycle, *body_at(*model.linkage(), result.rods[rod].link), model.scene.units);
}

std::string static_row(const SceneModel& model, const SpeedResult& result, std::size_t rod) {
  if (!model.linkage() || !result.rods[rod].shape) return "";
  const OutputUnits units = output_units(model.scene);
  const std::optional<StaticDeflection> found = at_rest(model, result, rod);
  if (!found) return "  at rest           no value: its load at rest is beyond its buckling load\n";
  const double value = found->peak.max_abs;
  if (value == 0) return "  at rest           not bent: no load across it\n";
  return fmt::format(
      "  at rest           {:.{}g} {} at x = {:.4g} {}, crank angle {:.2f} deg: under gravity and applied "
      "forces alone\n",
      value, std::min(6, trusted_digits(value, found->error)), units.length, found->peak.x, units.length,
      found->peak.crank_angle * degrees_per_radian);
}

namespace {

// "; error 1.2e-07 N"; nothing where it is not known.
std::string error_words(double error, const char* unit) {
  return error > 0 && std::isfinite(error) ? fmt::format("; error {:.1e} {}", error, unit) : std::string();
}

std::string bearing_rows(const MachineLoads& loads, const OutputUnits& units) {
  std::string text = fmt::format("\n  {:<22}  {:>12}  {:>12}  {:>12}  {:>12}\n", "largest resultant [N]", "rigid",
                                 "elastic", "at [deg]", "mean");
  for (const BearingLoad& load : loads.bearings)
    text += fmt::format("  {:<22}  {:>12.6g}  {:>12.6g}  {:>12.2f}  {:>12.6g}\n", load.joint,
                        load.rigid.value * units.force, load.elastic.value * units.force,
                        load.elastic.crank_angle * degrees_per_radian, load.mean * units.force);
  if (std::isfinite(loads.bearing_error))
    text += fmt::format("  error of each elastic value {:.1e} N\n", loads.bearing_error * units.force);
  return text;
}

std::string drive_rows(const MachineLoads& loads, double speed, const Scene& scene) {
  const Drive& drive = loads.drive;
  const std::optional<double>& fluctuation = loads.speed_fluctuation;
  const double moment = output_units(scene).moment, W = watt(scene.units);
  const double size = std::max(std::abs(drive.largest_power), std::abs(drive.smallest_power)) / speed;
  const double error = std::max(1e-13 * size, loads.torque_error);
  // The mean comes near its error where nothing but damping takes power; the others are as large as the torque.
  const double mean = std::abs(drive.mean) > error ? drive.mean : 0;  // what its error hides
  const int digits = std::min(6, trusted_digits(size, error)), of_mean = std::min(6, trusted_digits(mean, error));
  std::string text = fmt::format(
      "  driving torque: mean {:.{}g} +/- {:.1e} N m, rms {:.{}g} N m; power: mean {:.{}g} +/- {:.1e} W, rms {:.{}g} "
      "W, "
      "{:.{}g} .. {:.{}g} W\n",
      mean * moment, of_mean, error * moment, drive.rms * moment, digits, speed * mean * W, of_mean, speed * error * W,
      drive.rms_power * W, digits, drive.smallest_power * W, digits, drive.largest_power * W, digits);
  if (const std::optional<double>& theory = loads.mean_theory_error)
    text += fmt::format("  theory error of the means: {:.1e} N m, {:.1e} W{}\n", *theory * moment, speed * *theory * W,
                        *theory < std::abs(drive.mean) ? "" : ", not less than the means themselves");
  text += fmt::format("  energy that a flywheel takes up and gives back: {:.{}g} J a turn",
                      drive.energy_fluctuation * moment, digits);
  if (fluctuation)
    text += *fluctuation > 0.1
                ? "; with the crank's inertia alone the speed would fluctuate by more than 10 %, beyond what this "
                  "estimate tells"
                : fmt::format("; with the crank's inertia the speed would fluctuate by {:.3g} %", 100 * *fluctuation);
  return text + "\n";
}

}  // namespace

std::string machine_rows(const MachineLoads& loads, const std::vector<SliderMotion>& sliders, double speed,
                         const Scene& scene) {
  const OutputUnits units = output_units(scene);
  const FrameForces& frame = loads.frame;
  const Extremum &shaking = loads.shaking_force, &rigid = loads.shaking_force_rigid;
  std::string text = bearing_rows(loads, units);
  text += fmt::format(
      "  shaking force on the frame: x {} N, y {} N, resultant up to {:.6g} N at {:.2f} deg (rigid {:.6g} N){}\n"
      "  shaking moment about the crank's pivot: {} N m (rigid {} N m){}\n",
      range_of(frame.elastic, 0, units.force, 6), range_of(frame.elastic, 1, units.force, 6),
      shaking.value * units.force, shaking.crank_angle * degrees_per_radian, rigid.value * units.force,
      error_words(loads.shaking_force_error * units.force, "N"), range_of(frame.elastic, 2, units.moment, 6),
      range_of(frame.rigid, 2, units.moment, 6), error_words(loads.shaking_moment_error * units.moment, "N m"));
  text += drive_rows(loads, speed, scene);
  for (const SliderMotion& slider : sliders) {
    const Range position = fourier::range(slider.position, 0);
    text += fmt::format("  {}: stroke {:.6g} {} ({:.6g} .. {:.6g}), velocity {} {}/{}, acceleration {} {}/{}^2\n",
                        slider.name, position.max.value - position.min.value, units.length, position.min.value,
                        position.max.value, range_of(slider.velocity(), 0, 1, 6), units.length, units.time,
                        range_of(slider.acceleration(), 0, 1, 6), units.length, units.time);
  }
  return text;
}

std::string machine_rows(const SceneModel& model, const SpeedResult& result) {
  const std::optional<MachineLoads> loads = machine_loads(model, result);
  if (!loads) return "";
  return machine_rows(*loads, slider_motions(*model.linkage(), result.speed), result.speed, model.scene);
}

Json static_json(const SceneModel& model, const SpeedResult& result, std::size_t rod) {
  const std::optional<StaticDeflection> found = at_rest(model, result, rod);
  if (!found) return nullptr;
  Json json = peak_json(found->peak, model.scene.units);
  json["error"] = found->error;
  return json;
}

namespace {

Json frame_json(const MachineLoads& loads, const Units& units) {
  Json on_frame;
  const char* const names[] = {"x", "y", "moment"};
  for (Index c = 0; c < 3; ++c) {
    on_frame[names[c]] = range_json(loads.frame.elastic, c);
    on_frame[std::string(names[c]) + "_rigid"] = range_json(loads.frame.rigid, c);
  }
  on_frame["max"] = loads.shaking_force.value;
  on_frame["crank_angle"] = scene_angle(loads.shaking_force.crank_angle, units);
  on_frame["max_rigid"] = loads.shaking_force_rigid.value;
  on_frame["force_error"] = number(loads.shaking_force_error);
  on_frame["moment_error"] = number(loads.shaking_moment_error);
  return on_frame;
}

Json bearings_json(const MachineLoads& loads, const Units& units) {
  Json bearings = Json::object();
  for (const BearingLoad& load : loads.bearings)
    bearings[load.joint] = {{"max", load.elastic.value},
                            {"crank_angle", scene_angle(load.elastic.crank_angle, units)},
                            {"mean", load.mean},
                            {"rms", load.rms},
                            {"error", number(loads.bearing_error)},
                            {"max_rigid", load.rigid.value},
                            {"crank_angle_rigid", scene_angle(load.rigid.crank_angle, units)}};
  return bearings;
}

void add_drive(Json& document, const MachineLoads& loads, double speed) {
  const Drive &drive = loads.drive, &rigid = loads.drive_rigid;
  document["torque"]["mean"] = drive.mean;
  document["torque"]["rms"] = drive.rms;
  document["torque"]["error"] = number(loads.torque_error);
  document["torque"]["rigid"]["mean"] = rigid.mean;
  document["torque"]["rigid"]["rms"] = rigid.rms;
  document["power"] = {{"min", drive.smallest_power},
                       {"max", drive.largest_power},
                       {"mean", drive.mean_power},
                       {"rms", drive.rms_power},
                       {"error", number(loads.power_error(speed))}};
  document["flywheel"] = {{"energy_fluctuation", drive.energy_fluctuation},
                          {"energy_fluctuation_error", number(loads.energy_error)},
                          {"inertia", loads.inertia},
                          {"speed_fluctuation", number(loads.speed_fluctuation)},
                          {"speed_fluctuation_error", number(loads.speed_fluctuation_error)}};
}

Json slider_json(const SliderMotion& slider) {
  Json json;
  const char* const names[] = {"position", "velocity", "acceleration"};
  const FourierSeries series[] = {slider.position, slider.velocity(), slider.acceleration()};
  for (std::size_t k = 0; k < 3; ++k) {
    json[names[k]] = range_json(series[k], 0);
    json[names[k]]["error"] = number(slider.errors[k]);
  }
  return json;
}

}  // namespace

void add_machine(Json& document, const MachineLoads& loads, const std::vector<SliderMotion>& sliders, double speed,
                 const Units& units) {
  document["bearings"] = bearings_json(loads, units);
  document["frame"] = frame_json(loads, units);
  add_drive(document, loads, speed);
  Json motions = Json::object();
  for (const SliderMotion& slider : sliders) motions[slider.name] = slider_json(slider);
  if (!motions.empty()) document["sliders"] = std::move(motions);
}

void add_machine(Json& document, const SceneModel& model, const SpeedResult& result) {
  const std::optional<MachineLoads> loads = machine_loads(model, result);
  if (!loads) return;
  add_machine(document, *loads, slider_motions(*model.linkage(), result.speed), result.speed, model.scene.units);
  if (!result.theory) return;
  const std::optional<double>& theory = loads->mean_theory_error;
  document["torque"]["mean_theory_error"] = number(theory);
  document["power"]["mean_theory_error"] = theory ? number(result.speed * *theory) : Json(nullptr);
}

MachineFiles machine_files(const SceneModel& model, const SpeedResult& result) {
  constexpr Index points = 101;
  MachineFiles files;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const RodResult& rod = result.rods[r];
    files.envelopes.emplace_back();
    if (rod.stress && rod.stress->height_known)
      files.envelopes.back() = stress_envelope(*body_at(*model.linkage(), rod.link), coefficients_of(model, r),
                                               result.speed, rod.steady->q, points);
  }
  if (!result.forces) return files;
  files.frame = result.forces->frame;
  files.sliders = slider_motions(*model.linkage(), result.speed);
  return files;
}

CsvFile stress_csv(const Scene& scene, double speed, const std::string& rod, const StressEnvelope& envelope) {
  const OutputUnits units = output_units(scene);
  CsvFile file;
  file.name = file_name("stress_" + rod) + ".csv";
  file.comment = {fmt::format("{}, {}: {}, axial and bending stress together along the rod, over one turn",
                              scene_name(scene), speed_text(speed, scene), rod),
                  "fibres right and left of the way from joint 0 to joint 1; tension positive"};
  file.columns = {"x" + bracketed(units.length), "right smallest [MPa]", "right largest [MPa]", "left smallest [MPa]",
                  "left largest [MPa]"};
  file.rows.resize(envelope.x.size(), 5);
  file.rows << envelope.x, units.megapascal * envelope.smallest[0], units.megapascal * envelope.largest[0],
      units.megapascal * envelope.smallest[1], units.megapascal * envelope.largest[1];
  return file;
}

CsvFile frame_csv(const Scene& scene, double speed, const FrameForces& frame) {
  const OutputUnits units = output_units(scene);
  const Index N = samples_for(std::max(frame.elastic.num_harmonics(), frame.rigid.num_harmonics()));
  CsvFile file;
  file.name = "frame_forces.csv";
  file.comment = {fmt::format("{}, {}: shaking force and moment on the frame over one turn, elastic beside rigid",
                              scene_name(scene), speed_text(speed, scene)),
                  "global axes; moment about the crank's pivot; motor and applied slider forces act against the frame"};
  file.columns = {"crank angle [deg]", "x [N]", "y [N]", "moment [N m]", "x rigid [N]", "y rigid [N]",
                  "moment rigid [N m]"};
  const Eigen::Vector3d factor(units.force, units.force, units.moment);
  file.rows.resize(N + 1, 7);
  file.rows << turn_angles(N), closed(frame.elastic, N) * factor.asDiagonal(),
      closed(frame.rigid, N) * factor.asDiagonal();
  return file;
}

std::vector<CsvFile> slider_csvs(const Scene& scene, double speed, const std::vector<SliderMotion>& sliders) {
  const OutputUnits units = output_units(scene);
  std::vector<CsvFile> files;
  for (const SliderMotion& slider : sliders) {
    const Index N = samples_for(slider.position.num_harmonics());
    CsvFile file;
    file.name = file_name("slider_" + slider.name) + ".csv";
    file.comment = {fmt::format("{}, {}: {}, motion along its guide over one turn, from the guide's point",
                                scene_name(scene), speed_text(speed, scene), slider.name)};
    file.columns = {"crank angle [deg]", fmt::format("position [{}]", units.length),
                    fmt::format("velocity [{}/{}]", units.length, units.time),
                    fmt::format("acceleration [{}/{}^2]", units.length, units.time)};
    file.rows.resize(N + 1, 4);
    file.rows << turn_angles(N), closed(slider.position, N), closed(slider.velocity(), N),
        closed(slider.acceleration(), N);
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace hb::tools
