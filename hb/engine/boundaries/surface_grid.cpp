#include "hb/engine/boundaries/surface_grid.hpp"

#include <algorithm>
#include <cmath>

#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MapPoint point_of(const DiscriminantSurface& surface, const DiscriminantValue& value, double tolerance) {
  MapPoint point;
  SettledGrowth growth;
  if (!settled(value, surface.undamped(), growth)) return point;
  point.source = MapSource::interpolated;
  point.speed = surface.speed_of(value);
  point.growth_rate = growth.growth_rate;
  point.growth_error = rounded_up(growth.growth_error);
  point.verdict = growth.verdict;
  point.kind = growth.real ? surface.kind(value.value > 0) : BoundaryKind::complex;
  point.converged = growth.growth_error <= tolerance * std::max(point.speed, std::abs(growth.growth_rate));
  return point;
}

// Numbers of the values from `low` to `high`, ascending values.
std::array<std::size_t, 2> inside(const std::vector<double>& values, double low, double high) {
  const auto first = std::ranges::lower_bound(values, low), last = std::ranges::upper_bound(values, high);
  return {static_cast<std::size_t>(first - values.begin()), static_cast<std::size_t>(last - values.begin())};
}

}  // namespace

std::vector<MapPoint> surface_grid(const DiscriminantSurface& surface, const std::vector<double>& x,
                                   const std::vector<double>& y, double tolerance, const ForEach& for_each,
                                   std::vector<std::size_t>& open) {
  const std::size_t nx = x.size();
  std::vector<MapPoint> points(nx * y.size());
  constexpr std::size_t rows_at_once = 64;  // matrices that stay in the cache
  const auto rows = [&](std::size_t task) {
    const std::size_t first = task * rows_at_once, end = std::min(first + rows_at_once, y.size());
    for (const DiscriminantPatch& patch : surface.patches()) {
      const auto [i0, i1] = inside(x, patch.box.low[0], patch.box.high[0]);
      const auto [low, high] = inside(y, patch.box.low[1], patch.box.high[1]);
      const std::size_t j0 = std::max(low, first), j1 = std::min(high, end);
      if (i0 == i1 || j0 >= j1) continue;
      end_if_wished();
      VectorXd u(static_cast<Index>(i1 - i0)), v(static_cast<Index>(j1 - j0));
      for (std::size_t i = i0; i < i1; ++i) u(static_cast<Index>(i - i0)) = patch.box.unit(0, x[i]);
      for (std::size_t j = j0; j < j1; ++j) v(static_cast<Index>(j - j0)) = patch.box.unit(1, y[j]);
      const MatrixXd value = patch.value.at_all(u, v), damping = patch.damping.at_all(u, v),
                     speed = patch.speed.at_all(u, v);
      for (std::size_t j = j0; j < j1; ++j)
        for (std::size_t i = i0; i < i1; ++i) {
          const auto k = static_cast<Index>(i - i0), l = static_cast<Index>(j - j0);
          points[i + nx * j] = point_of(
              surface,
              {value(k, l), 1, patch.error, damping(k, l), patch.damping_error, speed(k, l), patch.speed_error},
              tolerance);
        }
    }
  };
  do_each(for_each, (y.size() + rows_at_once - 1) / rows_at_once, rows);
  for (std::size_t p = 0; p < points.size(); ++p)
    if (points[p].source == MapSource::missing) open.push_back(p);
  return points;
}

MapPoint surface_point(const DiscriminantSurface& surface, double x, double y, double tolerance) {
  return point_of(surface, surface.at(x, y), tolerance);
}

}  // namespace hb
