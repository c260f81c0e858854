#include "tools/tune_quantities.hpp"

#include <fmt/core.h>

#include <cmath>

#include "tools/command.hpp"

namespace hb::tools {

std::optional<FourierSeries> rod_response(const RodModel& rod, double speed, const Settings& settings) {
  SteadyOptions options;
  options.tolerance = settings.tolerance;
  options.method = settings.steady_method;
  SteadyState state = solve_steady_state(rod.system, speed, options);
  if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
  return std::move(state.q);
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

double stress_factor(const SceneModel& model, const RodModel& rod, const SectionHeights& heights,
                     const Metric& metric) {
  const auto named = heights.find(rod.name), all = heights.find("*");
  const auto height = named != heights.end() ? named : all;
  if (height == heights.end())
    throw UsageError(fmt::format("{}: found no section height of {}, allowed: --height {}=H, or a section in the scene",
                                 metric.text, rod.name, rod.name));
  const Units& units = model.scene.units;
  const double pascal = units.force_in_newton() / (units.length_in_m * units.length_in_m);
  return height->second / (2 * body_at(*model.linkage(), rod.link)->elastic->second_moment) * pascal * 1e-6;
}

JointForces forces_of(const SceneModel& model, double speed, const std::vector<FourierSeries>& q, double tolerance) {
  std::vector<LinkResponse> responses;
  for (std::size_t r = 0; r < q.size(); ++r) responses.push_back({model.rods[r].link, q[r]});
  return joint_forces(*model.linkage(), speed, responses, tolerance);
}

namespace {

// Largest length of a force given by its components.
Extremum largest_length(const FourierSeries& force) {
  if (force.num_harmonics() < 0) return {};
  if (force.num_components() == 1) return fourier::max_abs(force, 0);
  // Its square has twice the harmonics.
  const Eigen::MatrixXd samples = fourier::synthesise(force, 4 * force.num_harmonics() + 4);
  const Eigen::MatrixXd square = samples.colwise().squaredNorm();
  Extremum peak = fourier::range(fourier::analyse(square), 0).max;
  peak.value = std::sqrt(std::max(0.0, peak.value));
  return peak;
}

}  // namespace

JointQuantities joint_quantities(const JointForces& forces) {
  JointQuantities result;
  for (const JointForce& joint : forces.joints) {
    const Extremum peak = largest_length(joint.elastic);
    result.names.push_back(joint.name);
    result.force.push_back(peak.value);
    result.at.push_back(peak.crank_angle);
  }
  result.torque = fourier::range(forces.torque, 0);
  return result;
}

Stability leading_stability(const ScaledSystem& system, const Settings& settings) {
  StabilityOptions options;
  options.method = settings.stability_method;
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

double frequency_ratio(const HillSystem& system, double speed) {
  const double w2 = scale_system(system, speed).mean_diagonal().minCoeff();
  return w2 > 0 ? std::sqrt(w2) : 0.0;
}

double lowest_frequency(const HillSystem& system) {
  // At rest only the part without speed is left: M^-1 mean(C_0), nearly diagonal; its lowest w^2 by its diagonal in
  // scaled coordinates.
  HillSystem at_rest = system;
  at_rest.stiffness[1] = at_rest.stiffness[2] = FourierSeries();
  at_rest.load = {};
  return frequency_ratio(at_rest, 1);
}

}  // namespace hb::tools
