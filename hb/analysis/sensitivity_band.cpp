#include "hb/analysis/sensitivity_band.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "hb/analysis/tune/tune_gradient.hpp"

namespace hb {
namespace {

constexpr const char* band_words = "damping=0.5:2, E=0.9:1.1 or mass=0.9:1.1: factors, the smaller first";

[[noreturn]] void refuse_band(const std::string& text) {
  throw RequestError("band", fmt::format("\"{}\"", text), band_words);
}

std::optional<double> factor_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

void scale_link(Body& body, BandParameter parameter, double factor) {
  if (!body.elastic) return;
  Elastic& elastic = *body.elastic;
  switch (parameter) {
    case BandParameter::damping:
      elastic.internal_damping *= factor;
      elastic.damping_x *= factor;
      elastic.damping_y *= factor;
      break;
    case BandParameter::youngs_modulus:
      elastic.youngs_modulus *= factor;
      break;
    case BandParameter::mass:
      elastic.density *= factor;
      body.mass *= factor;
      body.inertia *= factor;
      break;
  }
}

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

const char* to_string(BandParameter parameter) {
  switch (parameter) {
    case BandParameter::damping:
      return "damping";
    case BandParameter::youngs_modulus:
      return "E";
    case BandParameter::mass:
      break;
  }
  return "mass";
}

BandRequest parse_band(const std::string& text) {
  const std::size_t sign = text.find('='), colon = text.find(':', sign == std::string::npos ? 0 : sign);
  if (sign == std::string::npos || colon == std::string::npos) refuse_band(text);
  BandRequest band;
  bool known = false;
  for (const BandParameter one : {BandParameter::damping, BandParameter::youngs_modulus, BandParameter::mass})
    if (text.substr(0, sign) == to_string(one)) band.parameter = one, known = true;
  const std::optional<double> from = factor_of(text.substr(sign + 1, colon - sign - 1)),
                              to = factor_of(text.substr(colon + 1));
  if (!known || !from || !to || !(*from < *to)) refuse_band(text);
  const bool positive = *from > 0 || (*from == 0 && band.parameter == BandParameter::damping);
  if (!positive || !(*from >= 0 && *to <= 1e6)) refuse_band(text);
  band.from = *from;
  band.to = *to;
  return band;
}

Scene scaled_scene(Scene scene, BandParameter parameter, double factor) {
  if (auto* system = std::get_if<HillSystem>(&scene.model)) {
    if (parameter != BandParameter::damping)
      throw RequestError("band", fmt::format("{} of a [hill] scene", to_string(parameter)), "damping=A:B");
    system->damping *= factor;
    return scene;
  }
  auto& linkage = std::get<Linkage>(scene.model);
  if (elastic_links(linkage).empty())
    throw RequestError("band", "a linkage without elastic links", "a scene with elastic links");
  for (Dyad& dyad : linkage.dyads) {
    scale_link(dyad.coupler, parameter, factor);
    if (auto* rocker = std::get_if<Rocker>(&dyad.closing)) scale_link(rocker->body, parameter, factor);
  }
  return scene;
}

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

namespace {

// The scenes of a sweep with their elastic links changed; along the speed one scene.
SceneFamily scaled_family(const SceneFamily& family, const Along& x, BandParameter parameter, double factor) {
  if (is_speed(x.path)) return scaled_scene(family.scene(), parameter, factor);
  const Scene first = some_scene(family, {&x});
  const auto scaled = [=](const std::vector<double>& values) {
    return scaled_scene(family.scene({{x.path, values[0]}}), parameter, factor).model;
  };
  return {Numbers{{x.path, x.values.front()}}, scaled, first.units};
}

}  // namespace

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
      return sweep(scaled_family(family, request.x, band.parameter, factor), request, work);
    };
    found.push_back({band, swept(band.from), swept(band.to)});
  }
  return found;
}

}  // namespace hb
