#include "hb/analysis/scene_band.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

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

// A family of a function's, of the numbers that vary; along the speed alone one scene.
SceneFamily scaled_family(const SceneFamily& family, const std::vector<const Along*>& axes, BandParameter parameter,
                          double factor) {
  Numbers varied;
  for (const Along* axis : axes)
    if (!is_speed(axis->path)) varied.push_back({axis->path, axis->values.front()});
  if (varied.empty()) return scaled_scene(family.scene(), parameter, factor);
  const Scene first = scaled_scene(some_scene(family, axes), parameter, factor);
  const auto scaled = [=](const std::vector<double>& values) {
    Numbers numbers = varied;
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i].value = values[i];
    return scaled_scene(family.scene(numbers), parameter, factor).model;
  };
  return {varied, scaled, first.units};
}

}  // namespace hb
