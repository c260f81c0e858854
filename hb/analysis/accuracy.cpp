#include "hb/analysis/accuracy.hpp"

#include <algorithm>
#include <variant>

namespace hb {

double default_boundary_tolerance(double tolerance) { return std::clamp(0.1 * tolerance, 1e-14, 1e-6); }

SteadyOptions response_options(const Settings& settings) {
  SteadyOptions options;
  options.tolerance = settings.tolerance;
  options.method = settings.steady_method;
  options.bound = settings.bound;
  // The difference between two numbers of modes must not drown in the error of either.
  if (is_auto(settings.modes)) options.tolerance = std::max(0.05 * settings.tolerance, 1e-14);
  return options;
}

SteadyOptions pole_options(const Settings& settings) {
  return {.tolerance = std::max(settings.tolerance, 1e-5), .method = settings.steady_method, .without_bound = true};
}

StabilityOptions exponent_options(const Settings& settings) {
  StabilityOptions options;
  options.method = settings.stability_method;
  options.tolerance = std::clamp(10 * settings.tolerance, 1e-12, 0.1);
  options.verdict_only = settings.only.verdict;
  options.leading_only = settings.only.verdict || settings.only.growth;
  return options;
}

StabilityOptions growth_comparison_options(const Settings& settings) {
  StabilityOptions options = exponent_options(settings);
  options.tolerance = std::clamp(0.01 * settings.tolerance, 1e-12, options.tolerance);
  return options;
}

SweepOptions boundary_options(const Settings& settings) {
  SweepOptions options;
  options.stability.method = settings.stability_method;
  options.stability.tolerance = std::clamp(settings.tolerance, 1e-13, 1e-9);
  options.tolerance = default_boundary_tolerance(settings.tolerance);
  return options;
}

PeakAccuracy peak_accuracy(const Settings& settings) {
  return {1e-5, std::clamp(0.01 * settings.tolerance, 1e-14, 1e-9), std::clamp(0.5 * settings.tolerance, 5e-14, 1e-6)};
}

double integration_tolerance(const Settings& settings) { return std::max(settings.tolerance, 1e-9); }

std::vector<SolverTolerance> solver_tolerances(const Settings& settings) {
  const PeakAccuracy peak = peak_accuracy(settings);
  return {{"response", response_options(settings).tolerance},
          {"exponents", exponent_options(settings).tolerance},
          {"compared_modes", growth_comparison_options(settings).tolerance},
          {"boundary_exponents", boundary_options(settings).stability.tolerance},
          {"boundaries", settings.boundary_tolerance},
          {"peak_responses", peak.fine},
          {"peaks", peak.height},
          {"time_integration", integration_tolerance(settings)}};
}

}  // namespace hb
