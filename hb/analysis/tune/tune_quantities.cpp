#include "hb/analysis/tune/tune_quantities.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/bearing_load.hpp"
#include "hb/analysis/tune/tune_stress.hpp"
#include "hb/engine/design/worst_case.hpp"
#include "hb/engine/exponents/hill_sensitivity.hpp"
#include "lib/rod/rod_functional.hpp"
#include "lib/rod/shear.hpp"

namespace hb {

std::optional<FourierSeries> rod_unknowns(const RodModel& rod, double speed, const Settings& settings) {
  SteadyState state = solve_steady_state(rod.system, speed, response_options(settings));
  if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
  return std::move(state.q);
}

std::optional<FourierSeries> rod_response(const RodModel& rod, double speed, const Settings& settings) {
  std::optional<FourierSeries> unknowns = rod_unknowns(rod, speed, settings);
  if (unknowns && rod.system.num_modes() != rod.num_modes) return ritz_coordinates(*unknowns, rod.num_modes);
  return unknowns;
}

RodShape shape_of(const SceneModel& model, const RodModel& rod, double speed, const FourierSeries& q) {
  if (rod.link >= 0)
    return rod_shape(*body_at(*model.linkage(), rod.link),
                     model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)], speed, q);
  RodShape shape;
  for (Eigen::Index i = 0; i < q.num_components(); ++i) {
    const Extremum peak = fourier::max_abs(q, i);
    if (peak.value > shape.deflection.max_abs)
      shape.deflection = {peak.value, static_cast<double>(i), peak.crank_angle};
  }
  return shape;
}

Body with_height(const SceneModel& model, const RodModel& rod, const SectionHeights& heights, const Metric& metric) {
  const auto named = heights.find(rod.name), all = heights.find("*");
  const auto height = named != heights.end() ? named : all;
  if (height == heights.end())
    throw RequestError(metric.text, fmt::format("no section height of {}", rod.name),
                       fmt::format("@height {}=H, or a section in the scene", rod.name));
  Body link = *body_at(*model.linkage(), rod.link);
  link.elastic->section_height = height->second;
  return link;
}

double in_megapascal(const Units& units) {
  return units.force_in_newton() / (units.length_in_m * units.length_in_m) * 1e-6;
}

double stress_factor(const SceneModel& model, const RodModel& rod, const SectionHeights& heights,
                     const Metric& metric) {
  const Elastic elastic = *with_height(model, rod, heights, metric).elastic;
  return elastic.section_height / (2 * elastic.second_moment) * in_megapascal(model.scene.units);
}

JointForces forces_of(const SceneModel& model, double speed, const std::vector<FourierSeries>& q, double tolerance) {
  std::vector<LinkResponse> responses;
  for (std::size_t r = 0; r < q.size(); ++r) responses.push_back({model.rods[r].link, q[r]});
  return joint_forces(*model.influence, speed, responses, tolerance);
}

JointQuantities joint_quantities(const JointForces& forces) {
  JointQuantities result;
  for (const JointForce& joint : forces.joints) {
    const Extremum peak = fourier::largest_length(joint.elastic);
    result.names.push_back(joint.name);
    result.force.push_back(peak.value);
    result.at.push_back(peak.crank_angle);
  }
  result.torque = fourier::range(forces.torque, 0);
  return result;
}

std::vector<double> theory_of(const SceneModel& model, double speed, const std::vector<FourierSeries>& q) {
  std::vector<LinearRod> linear;
  std::vector<Eigen::Index> modes;
  for (std::size_t r = 0; r < q.size(); ++r) {
    linear.push_back({&model.rods[r].system, &q[r]});
    modes.push_back(model.rods[r].num_modes);
  }
  std::optional<ExactModel> own;
  if (!model.exact) own.emplace(theory_model(*model.linkage(), modes));
  const TheoryErrors errors = theory_errors(own ? *own : *model.exact, speed, linear);
  std::vector<double> values;
  for (const TheoryErrors::Rod& rod : errors.rods) values.push_back(rod.q.value_or(1 + errors.steepest));
  return values;
}

// Its exponents are those of q plus m:   M p'' + (B - 2 m M) p' + (C - m B + m^2 M) p
HillSystem shifted(const HillSystem& system, double m) {
  HillSystem result = system;
  if (m == 0) return result;
  const Eigen::MatrixXd &M = system.mass, &B = system.damping;
  result.damping = B - 2 * m * M;
  if (result.stiffness[0].c.size() == 0) result.stiffness[0] = FourierSeries(M.size(), 0);
  const Eigen::MatrixXd added = m * m * M - m * B;
  result.stiffness[0].c.col(0) +=
      Eigen::Map<const Eigen::VectorXd>(added.data(), added.size()).cast<std::complex<double>>();
  return result;
}

Stability shifted(Stability stability, double m) {
  for (Exponent& exponent : stability.exponents) exponent.value += m;
  for (Exponent& exponent : stability.uncertain) exponent.value += m;
  stability.growth_rate += m;
  stability.growth_low += m;
  stability.growth_high += m;
  stability.others_below += m;
  const double low = stability.growth_rate - stability.growth_error, high = growth_of(stability);
  stability.verdict = high < 0 ? Verdict::stable : low > 0 ? Verdict::unstable : Verdict::undecided;
  return stability;
}

std::vector<ModeState> mean_modes(const ScaledSystem& system) {
  const Eigen::VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  std::vector<ModeState> modes;
  for (Eigen::Index i = 0; i < w2.size(); ++i) {
    const double square = w2(i) - b(i) * b(i) / 4;
    ModeState mode;
    mode.frequency = square > 0 ? std::sqrt(square) * system.speed : std::numeric_limits<double>::quiet_NaN();
    mode.growth = mode.growth_low = -b(i) / 2 * system.speed;
    modes.push_back(mode);
  }
  return modes;
}

Stability leading_stability(const ScaledSystem& system, const Settings& settings) {
  StabilityOptions options = exponent_options(settings);
  options.leading_only = true;
  Stability stability = analyse_stability(system, options);
  if (std::isfinite(stability.growth_rate + stability.growth_error)) return stability;
  options.leading_only = false;
  return analyse_stability(system, options);
}

double growth_of(const Stability& stability) { return stability.growth_rate + stability.growth_error; }

double mass_of(const SceneModel& model, const std::string& name) {
  double sum = 0;
  for (const RodModel& rod : model.rods)
    if (rod.reported && (name.empty() || name == rod.name)) sum += body_at(*model.linkage(), rod.link)->mass;
  return sum;
}

double lowest_frequency(const HillSystem& system) {
  // At rest only the part without speed is left: M^-1 mean(C_0).
  HillSystem at_rest = system;
  at_rest.stiffness[1] = at_rest.stiffness[2] = FourierSeries();
  at_rest.load = {};
  return frequency_ratio(at_rest, 1);
}

namespace {

// A difference of two answers, the second with half as many modes again, is at least half of the first one's error.
constexpr double safety = 2;

// The largest |w| or |EJ w''| over speed, place and crank angle at once, from where it was found speed by speed.
void seek_jointly(MetricValue& value, const SceneModel& model, const SpeedSpan& span, const Settings& settings,
                  bool stress) {
  const RodModel& rod = model.rods[value.index];
  const std::optional<FourierSeries> q = rod_response(rod, *value.speed, settings);
  if (!q || rod.link < 0 || !(value.value > 0)) return;
  const RodShape shape = shape_of(model, rod, *value.speed, *q);
  const RodPeak& peak = stress ? shape.bending_moment : shape.deflection;
  const Body& link = *body_at(*model.linkage(), rod.link);
  const RodCoefficients& coefficients = model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
  const auto at = [&](const Eigen::VectorXd& x) {  // part of the length, crank angle, and speed where there are several
    const double speed = x.size() > 2 ? x(2) : *value.speed;
    const std::optional<FourierSeries> response = rod_response(rod, speed, settings);
    if (!response) return std::numeric_limits<double>::quiet_NaN();
    const RodFunctional J =
        rod_functional(link, coefficients, speed, response->num_components(), response->num_harmonics(),
                       stress ? RodQuantity::bending_moment : RodQuantity::deflection, x(0) * link.length, x(1));
    return value.factor * std::abs(J.offset + fourier::mean_product(J.g, *response));
  };
  // A neighbourhood: what lies further away was seen speed by speed.
  constexpr double part = 0.02, angle = 0.05, ratio = 0.002;
  const double place = peak.x / link.length, speed = *value.speed;
  Eigen::VectorXd x(3), lower(3), upper(3);
  x << place, peak.crank_angle, speed;
  lower << std::max(0.0, place - part), peak.crank_angle - angle, std::max(span.from, speed * (1 - ratio));
  upper << std::min(1.0, place + part), peak.crank_angle + angle, std::min(span.to, speed * (1 + ratio));
  const Eigen::Index n = lower(2) < upper(2) ? 3 : 2;
  const WorstPoint worst = worst_point(at, x.head(n), lower.head(n), upper.head(n));
  if (!(worst.value > value.value)) return;
  value.value = worst.value;
  if (n == 3) value.speed = worst.x(2);
}

void complete_shape(MetricValue& value, const SceneModel& model, const SpeedResult& at, bool stress) {
  const RodModel& rod = model.rods[value.index];
  const RodResult& result = at.rods[value.index];
  if (rod.link < 0) {
    value.crank_angle = shape_of(model, rod, at.speed, result.steady->q).deflection.crank_angle;
    // |error of q_i| <= bound max |q|, in their sum at most I times that.
    value.error =
        static_cast<double>(result.steady->q.num_components()) * result.steady->error_bound * std::abs(value.value);
    return;
  }
  const RodPeak& peak = stress ? result.shape->bending_moment : result.shape->deflection;
  value.position = peak.x / body_at(*model.linkage(), rod.link)->length;
  value.crank_angle = peak.crank_angle;
  value.error = HUGE_VAL;
  if (!result.peak_errors) return;
  const double error = stress ? result.peak_errors->bending_moment : result.peak_errors->deflection;
  value.error = peak.max_abs > 0 ? error / peak.max_abs * std::abs(value.value) : 0;
}

void complete_force(MetricValue& value, const SpeedResult& at, bool torque) {
  const JointQuantities quantities = joint_quantities(*at.forces);
  const ForceErrors& errors = *at.force_errors;
  if (torque) {
    value.crank_angle = quantities.torque.max.crank_angle;
    const double size = std::max(std::abs(quantities.torque.max.value), std::abs(quantities.torque.min.value));
    value.error = 2 * (errors.torque + errors.torque_cut) * size * value.factor;  // of both extremes
    return;
  }
  value.crank_angle = quantities.at[value.index];
  // Errors are of components, relative to the largest at any joint, which no length falls below.
  const double size = *std::ranges::max_element(quantities.force);
  value.error = std::numbers::sqrt2 * (errors.force + errors.force_cut) * size * value.factor;
}

void complete_whole_stress(MetricValue& value, const SceneModel& model, const SectionHeights& heights,
                           const SpeedResult& at, const Metric& metric) {
  const RodModel& rod = model.rods[value.index];
  const RodResult& result = at.rods[value.index];
  const Body link = with_height(model, rod, heights, metric);
  const RodCoefficients& coefficients = model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
  const StressPeak peak = stress_peak(
      metric.kind,
      stress_cycle(link, coefficients, at.speed, result.steady->q, result.more_modes, result.steady->error_bound),
      link.elastic->strength);
  value.position = peak.x / link.length;
  value.crank_angle = peak.largest_at;
  value.against = peak.against;
  const double error = result.more_modes.c.size() > 0 ? peak.error : HUGE_VAL;
  value.error = metric.kind == MetricKind::safety ? safety_factor(peak.value, error).error : value.factor * error;
}

// What more modes change of the theory error of a rod.
double theory_error_of_modes(const SceneModel& model, std::size_t rod, double speed, const Settings& settings) {
  Settings asked = settings;
  asked.only = {false, false, true, false};
  asked.rods.clear();
  const auto value = [&](Eigen::Index modes) {
    asked.modes = static_cast<int>(modes);
    const SceneModel other = make_model(model.scene, asked);
    std::vector<FourierSeries> q;
    for (const RodModel& each : other.rods) q.push_back(rod_response(each, speed, asked).value_or(FourierSeries()));
    return theory_of(other, speed, q)[rod];
  };
  const Eigen::Index I = model.rods[rod].num_modes;
  return safety * std::abs(value(more_modes(I)) - value(I));
}

// In the unit of the value. A ripple is the difference of two extremes, each wrong by so much of the largest.
std::optional<double> theory_error_of(const MetricValue& value, const SpeedResult& at, const Metric& metric) {
  const bool of_forces = metric.kind == MetricKind::force || metric.kind == MetricKind::torque_ripple;
  if (!at.theory || (of_forces && !at.forces)) return std::nullopt;
  const auto part_of = [](const std::optional<double>& part, double size) {
    return part ? *part * std::abs(size) : HUGE_VAL;
  };
  switch (metric.kind) {
    case MetricKind::deflection:
      return part_of(at.theory->rods[value.index].deflection, value.value);
    case MetricKind::force:
      return part_of(at.theory->force, value.factor * std::ranges::max(joint_quantities(*at.forces).force));
    case MetricKind::torque_ripple: {
      const Range torque = joint_quantities(*at.forces).torque;
      return part_of(at.theory->torque,
                     2 * value.factor * std::max(std::abs(torque.min.value), std::abs(torque.max.value)));
    }
    case MetricKind::margin:
      return at.theory->growth.value_or(HUGE_VAL);
    case MetricKind::margin_per_turn:
      return 2 * std::numbers::pi / at.speed * at.theory->growth.value_or(HUGE_VAL);
    default:
      return std::nullopt;
  }
}

// Of a margin, which is not computed with the response.
std::optional<double> theory_error_of_margin(const MetricValue& value, const SceneModel& model,
                                             const Settings& settings, const Metric& metric) {
  if (!model.linkage()) return std::nullopt;
  Settings asked = settings;
  asked.only = {.steady = true, .stability = true, .reactions = false, .shape = false, .growth = true};
  asked.rods.clear();
  return theory_error_of(value, analyse(model, *value.speed, asked), metric);
}

// What its error bar and the modes left out may change of the growth rate. Changes that do not shrink with more modes
// are carried on in proportion to their number squared, to sixty: every mode may be damped less than the one before.
// Where that leaves the sign open, the growth rate is computed with up to sixty modes instead.
double growth_error(const SceneModel& model, const RodModel& rod, double speed, const Settings& settings) {
  const auto stability = [&](const HillSystem& system) {
    return leading_stability(scale_system(system, speed), settings);
  };
  const Stability own = stability(rod.system);
  if (rod.link < 0) return own.growth_error;
  const Body& link = *body_at(*model.linkage(), rod.link);
  const RodCoefficients& coefficients = model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
  const auto square = [](Eigen::Index modes) { return static_cast<double>(modes * modes); };
  const Eigen::Index more = comparison_modes(rod.num_modes), still_more = comparison_modes(more);
  const Stability second = stability(ritz_system(link, coefficients, more)),
                  third = stability(ritz_system(link, coefficients, still_more));
  const double change = std::abs(second.growth_rate - own.growth_rate),
               next = std::abs(third.growth_rate - second.growth_rate);
  double error = own.growth_error + safety * change;
  if (!(next <= change / 2 + second.growth_error + third.growth_error))
    error += safety * next * std::max(1.0, (square(max_modes) - square(more)) / (square(still_more) - square(more)));
  if (error < std::abs(own.growth_rate) || rod.num_modes >= max_modes) return error;
  error = 0;
  for (Eigen::Index modes = still_more;; modes = more_modes(modes)) {
    const Stability direct = modes == still_more ? third : stability(ritz_system(link, coefficients, modes));
    error = std::max(error, std::abs(direct.growth_rate - own.growth_rate) + direct.growth_error);
    if (modes >= max_modes) break;
  }
  return own.growth_error + std::max(error, change + second.growth_error);
}

}  // namespace

std::vector<double> numbers_of(const std::vector<MetricValue>& values) {
  std::vector<double> numbers;
  for (const MetricValue& value : values) numbers.push_back(value.value);
  return numbers;
}

void complete(MetricValue& value, const SceneModel& model, const SectionHeights& heights, const SpeedSpan& span,
              const Settings& settings, const Metric& metric) {
  if (!std::isfinite(value.value) || metric.kind == MetricKind::mass || metric.kind == MetricKind::speed_range) return;
  const RodModel& rod = model.rods[value.index < model.rods.size() ? value.index : 0];
  const auto change_with_more_modes = [&](const std::function<double(const HillSystem&)>& of) {
    if (rod.link < 0) return 0.0;
    const RodCoefficients& coefficients = model.coefficients.rods[static_cast<std::size_t>(rod.coefficients)];
    const HillSystem finer =
        ritz_system(*body_at(*model.linkage(), rod.link), coefficients, comparison_modes(rod.num_modes));
    return safety * std::abs(of(finer) - of(rod.system));
  };
  Settings asked = settings;
  switch (metric.kind) {
    case MetricKind::deflection:
    case MetricKind::stress:
    case MetricKind::total_stress:
    case MetricKind::safety:
    case MetricKind::force:
    case MetricKind::torque_ripple: {
      const bool forces = metric.kind == MetricKind::force || metric.kind == MetricKind::torque_ripple;
      asked.only = {!forces, false, forces, !forces};
      if (!forces && !is_whole_stress(metric))
        seek_jointly(value, model, span, settings, metric.kind == MetricKind::stress);
      const SpeedResult at = analyse(model, *value.speed, asked);
      if (std::ranges::any_of(at.rods, [](const RodResult& r) { return r.steady->status == SteadyStatus::singular; })) {
        value.error = HUGE_VAL;
      } else if (forces) {
        complete_force(value, at, metric.kind == MetricKind::torque_ripple);
      } else if (is_whole_stress(metric)) {
        complete_whole_stress(value, model, heights, at, metric);
      } else {
        complete_shape(value, model, at, metric.kind == MetricKind::stress);
      }
      value.theory_error = theory_error_of(value, at, metric);
      break;
    }
    case MetricKind::margin:
    case MetricKind::margin_per_turn: {
      value.error = growth_error(model, rod, *value.speed, settings);
      if (metric.kind == MetricKind::margin_per_turn) value.error *= 2 * std::numbers::pi / *value.speed;
      value.theory_error = theory_error_of_margin(value, model, settings, metric);
      break;
    }
    case MetricKind::theory:
      value.error = theory_error_of_modes(model, value.index, *value.speed, settings);
      break;
    case MetricKind::frequency:
      value.error = value.factor * change_with_more_modes(lowest_frequency);
      break;
    case MetricKind::clearance:
      value.error =
          change_with_more_modes([&](const HillSystem& system) { return frequency_ratio(system, *value.speed); });
      break;
    case MetricKind::mass:
    case MetricKind::speed_range:
      break;
  }
}

}  // namespace hb
