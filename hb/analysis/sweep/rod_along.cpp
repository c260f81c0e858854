#include "hb/analysis/sweep/rod_along.hpp"

#include <utility>

#include "hb/analysis/rod_steady.hpp"

namespace hb {

std::optional<ScaledSystem> RodAlong::system(double x) const {
  ++evaluations_;
  const ScenePlace place = scene_.at(x);
  if (!place.model) return std::nullopt;
  return scale_system(place.model->rods[rod_].system, place.speed);
}

std::optional<FourierSeries> RodAlong::response(double x, double tolerance) const {
  ++evaluations_;
  const ScenePlace place = scene_.at(x);
  if (!place.model) return std::nullopt;
  SteadyOptions options;
  options.method = scene_.settings().steady_method;
  options.tolerance = tolerance;
  const RodModel& rod = place.model->rods[rod_];
  SteadyState state = solve_rod(rod.system, rod.num_modes, place.speed, options);
  if (state.status == SteadyStatus::singular || !state.q.c.allFinite()) return std::nullopt;
  return std::move(state.q);
}

ResponseAt RodAlong::largest(int component, double tolerance) const {
  return [this, component, tolerance](double x) -> std::optional<double> {
    const std::optional<FourierSeries> q = response(x, tolerance);
    if (!q) return std::nullopt;
    return fourier::max_abs(*q, component).value;
  };
}

}  // namespace hb
