#include "hb/analysis/sensitivity_band.hpp"

#include <fmt/core.h>

#include <cmath>

#include "hb/analysis/tune/tune_gradient.hpp"

namespace hb {
namespace {

struct NamedMetric {
  Metric metric;
  std::string quantity;
};

Metric metric_of(MetricKind kind, std::string name, const char* word) {
  Metric metric;
  metric.kind = kind;
  metric.text = name.empty() ? word : fmt::format("{}:{}", word, name);
  metric.name = std::move(name);
  return metric;
}

SectionHeights heights_of(const SceneModel& model) {
  SectionHeights heights;
  if (!model.linkage()) return heights;
  for (const RodModel& rod : model.rods)
    if (const double height = body_at(*model.linkage(), rod.link)->elastic->section_height; height > 0)
      heights[rod.name] = height;
  return heights;
}

std::vector<NamedMetric> metrics_of(const SteadyResult& result) {
  std::vector<NamedMetric> metrics;
  const bool linkage = result.model->linkage() != nullptr;
  if (linkage && result.computed.shape)
    for (const RodResult& rod : result.rods)
      if (rod.reported) {
        metrics.push_back({metric_of(MetricKind::deflection, rod.name, "deflection"), "deflection"});
        if (heights_of(*result.model).contains(rod.name))
          metrics.push_back({metric_of(MetricKind::total_stress, rod.name, "total-stress"), "stress, together"});
      }
  if (result.computed.stability) metrics.push_back({metric_of(MetricKind::margin, "", "stable"), "growth rate"});
  if (result.forces)
    for (const JointForce& joint : result.forces->joints)
      metrics.push_back({metric_of(MetricKind::force, joint.name, "force"), "bearing"});
  return metrics;
}

// Each metric for itself: one without a derivative leaves the others theirs.
std::vector<BandSlope> slopes_of(const Scene& scene, const SteadyResult& result, BandParameter parameter) {
  std::vector<BandSlope> slopes;
  Settings settings = result.settings;
  if (is_auto(settings.modes)) settings.modes = most_modes(result.rods);
  const auto model = [&](double factor) { return make_model(scaled_scene(scene, parameter, factor), settings); };
  const DesignFamily family{
      [&](const std::vector<double>& x) { return model(x[0]); }, heights_of, {0.5}, {2}, settings};
  const SceneModel here = model(1);
  const Work work;
  DesignAnalysis analysis(here, settings, {result.speed, result.speed, 1}, heights_of(here), work);
  for (const NamedMetric& each : metrics_of(result)) {
    const MetricValue value = analysis.value(each.metric);
    if (!std::isfinite(value.value) || value.value == 0) continue;
    const std::optional<Eigen::MatrixXd> gradient = metric_gradients(family, {1}, {each.metric}, {value});
    if (!gradient || !gradient->allFinite()) continue;
    slopes.push_back(
        {each.metric.name.empty() ? value.where : each.metric.name, each.quantity, (*gradient)(0, 0) / value.value});
  }
  return slopes;
}

}  // namespace

std::vector<SensitivityBand> sensitivity_bands(const Scene& scene, const Request& request,
                                               const std::vector<BandRequest>& bands) {
  if (bands.empty()) return {};
  const SteadyResult nominal = steady(scene, request);
  std::vector<SensitivityBand> found;
  for (const BandRequest& band : bands)
    found.push_back({band, steady(scaled_scene(scene, band.parameter, band.from), request),
                     steady(scaled_scene(scene, band.parameter, band.to), request),
                     slopes_of(scene, nominal, band.parameter)});
  return found;
}

std::vector<SweepBand> sweep_bands(const SceneFamily& family, SweepRequest request,
                                   const std::vector<BandRequest>& bands, Work& work) {
  if (bands.empty()) return {};
  // What the scene's [analysis] says, which a family of functions does not.
  const Scene scene = some_scene(family, {&request.x});
  const Settings settings = settings_of(request, scene);
  request.modes = settings.modes;
  request.tolerance = settings.tolerance;
  if (!is_speed(request.x.path)) {
    const Speed speed = speed_of(request, scene);
    (speed.in_rpm ? request.rpm : request.omega) = speed.in_rpm ? speed.rpm : speed.omega;
  }
  request.search = false;
  std::vector<SweepBand> found;
  for (const BandRequest& band : bands) {
    const auto swept = [&](double factor) {
      return sweep(scaled_family(family, {&request.x}, band.parameter, factor), request, work);
    };
    found.push_back({band, swept(band.from), swept(band.to)});
  }
  return found;
}

}  // namespace hb
