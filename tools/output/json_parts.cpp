#include "tools/output/json_parts.hpp"

#include <cmath>
#include <numbers>

#include "tools/output/output_units.hpp"

namespace hb::tools {

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

void add_shape(Json& rod, const RodShape& shape, const std::optional<PeakErrors>& errors, const Units& units) {
  rod["deflection"] = peak_json(shape.deflection, units);
  if (errors) rod["deflection"]["error"] = number(errors->deflection);
  rod["bending_moment"] = peak_json(shape.bending_moment, units);
  if (errors) rod["bending_moment"]["error"] = number(errors->bending_moment);
}

Json stability_json(const Stability& stability, Eigen::Index num_exponents) {
  Json json;
  Json exponents = Json::array(), errors = Json::array();
  for (const Exponent& exponent : stability.exponents) {
    exponents.push_back(pair(exponent.value));
    errors.push_back(exponent.error);
  }
  json["exponents"] = std::move(exponents);
  json["exponent_errors"] = std::move(errors);
  json["exponents_unresolved"] = stability.method == StabilityMethod::bound
                                     ? 0
                                     : num_exponents - static_cast<Eigen::Index>(stability.exponents.size());
  Json& uncertain = json["exponents_uncertain"] = Json::array();
  for (const Exponent& exponent : stability.uncertain)
    uncertain.push_back({{"exponent", pair(exponent.value)}, {"error", exponent.error}});
  json["growth_rate"] = stability.growth_rate + 0.0;
  json["exponent_error"] = stability.growth_error;
  json["growth_interval"] = {stability.growth_low + 0.0, stability.growth_high + 0.0};
  json["verdict"] = to_string(stability.verdict);
  json["stability_method"] = to_string(stability.method);
  json["stability_converged"] = stability.converged;
  return json;
}

// Of each exponent the frequency in Hz and the damping ratio -Re lambda/|Re lambda + i nu|, nu the frequency. What
// bounds the error of lambda bounds both: by error/(2 pi), and by error/|Re lambda + i nu|.
void add_modes(Json& json, const std::vector<Exponent>& exponents, double speed, const Units& units) {
  Json frequencies = Json::array(), multipliers = Json::array();
  Json hertz = Json::array(), hertz_errors = Json::array(), ratios = Json::array(), ratio_errors = Json::array();
  for (const Exponent& exponent : exponents) {
    const double per_second = 1 / (2 * std::numbers::pi * units.time_in_s);
    const double size = std::hypot(exponent.value.real(), exponent.frequency);
    frequencies.push_back(exponent.frequency);
    multipliers.push_back(pair(exponent.multiplier(speed)));
    hertz.push_back(number(exponent.frequency * per_second));
    hertz_errors.push_back(number(exponent.error * per_second));
    ratios.push_back(size > 0 ? number(-exponent.value.real() / size + 0.0) : Json(nullptr));
    ratio_errors.push_back(size > 0 ? number(exponent.error / size) : Json(nullptr));
  }
  json["frequencies"] = std::move(frequencies);
  json["frequencies_hz"] = std::move(hertz);
  json["frequencies_hz_errors"] = std::move(hertz_errors);
  json["damping_ratios"] = std::move(ratios);
  json["damping_ratio_errors"] = std::move(ratio_errors);
  json["multipliers"] = std::move(multipliers);
}

Json joints_json(const JointForces& forces) {
  Json joints = object_with_room(forces.joints.size());
  for (const JointForce& joint : forces.joints) {
    Json& entry = joints[joint.name] = object_with_room(4);
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

Json exponents_json(const std::vector<Exponent>& exponents) {
  Json list = Json::array();
  for (const Exponent& e : exponents) list.push_back({number(e.value.real()), number(e.value.imag())});
  return list;
}

}  // namespace hb::tools
