#include "tools/work/map_key.hpp"

#include <complex>
#include <optional>

#include "tools/work/checkpoint.hpp"

namespace hb::tools {
namespace {

double at(const Along& along, double share) {
  const double from = along.values.front(), to = along.values.back();
  return from + share * (to - from);
}

}  // namespace

std::uint64_t map_key(const MapTask& task) {
  const ScenePlane& plane = task.plane();
  const Along &x = task.x(), &y = task.y();
  const Settings& settings = task.settings();
  TaskKey key;
  key.add("map");
  for (const Along* range : {&x, &y}) {
    key.add(range->path);
    for (const double value : range->values) key.add(value);
  }
  key.add(settings.tolerance)
      .add(settings.boundary_tolerance)
      .add(settings.boundaries)
      .add(settings.only.growth)
      .add(settings.only.verdict)
      .add(task.stress())
      .add(static_cast<double>(settings.stability_method));
  const auto& factors = task.damping_range();
  key.add(factors ? factors->front() : -1).add(factors ? factors->back() : -1);
  if (const auto& band = task.band()) key.add(to_string(band->parameter)).add(band->from).add(band->to);
  for (const double s : {0.0, 0.37, 1.0}) {
    for (const double t : {0.0, 0.61, 1.0}) {
      for (std::size_t r = 0; r < plane.rods().size(); ++r) {
        key.add(plane.rods()[r]);
        const std::optional<ScaledSystem> system = plane.system(r, at(x, s), at(y, t));
        key.add(system ? static_cast<double>(system->num_modes()) : -1);
        if (!system) continue;
        key.add(system->speed);
        for (const double value : system->G.reshaped()) key.add(value);
        for (const std::complex<double> value : system->K.c.reshaped()) key.add(value.real()).add(value.imag());
      }
    }
  }
  return key.value();
}

}  // namespace hb::tools
