#include "hb/engine/boundaries/map_grid.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace hb {

static_assert(sizeof(MapPoint) == 24, "a map of 1e7 points has 240 MB of them");

float rounded_up(double error) {
  const auto near = static_cast<float>(error);
  return near < error ? std::nextafter(near, HUGE_VALF) : near;
}

MapPoint map_point(const StabilitySample& sample) {
  const Stability& s = sample.stability;
  MapPoint point;
  point.source = MapSource::evaluated;
  point.verdict = s.verdict;
  point.kind = boundary_kind(s, sample.speed);
  point.converged = s.converged;
  point.growth_error = rounded_up(s.growth_error);
  point.speed = sample.speed;
  point.growth_rate = s.growth_rate;
  return point;
}

std::vector<MapPoint> map_grid(const MapMesh& mesh, const std::vector<std::optional<StabilitySample>>& samples) {
  const MapAxis &along_x = mesh.x(), &along_y = mesh.y();
  const std::size_t nx = along_x.values.size(), ny = along_y.values.size();
  std::vector<MapPoint> points(nx * ny);
  std::vector<bool> done(nx * ny, false);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const MapNode& node = mesh.nodes()[n];
    if (node.i % along_x.units != 0 || node.j % along_y.units != 0) continue;
    const std::size_t place =
        static_cast<std::size_t>(node.i / along_x.units) + nx * static_cast<std::size_t>(node.j / along_y.units);
    done[place] = true;
    if (samples[n]) points[place] = map_point(*samples[n]);
  }
  for (const MapCell& cell : mesh.cells()) {
    if (cell.halved || (mesh.width(cell) <= along_x.units && mesh.height(cell) <= along_y.units)) continue;
    const MapNode &low = mesh.nodes()[cell.corners[0]], &high = mesh.nodes()[cell.corners[2]];
    std::array<MapPoint, 4> corner;
    for (std::size_t k = 0; k < 4; ++k) {
      if (const auto& s = samples[cell.corners[k]]) corner[k] = map_point(*s);
    }
    for (int j = (low.j + along_y.units - 1) / along_y.units; j * along_y.units <= high.j; ++j) {
      for (int i = (low.i + along_x.units - 1) / along_x.units; i * along_x.units <= high.i; ++i) {
        const std::size_t place = static_cast<std::size_t>(i) + nx * static_cast<std::size_t>(j);
        if (done[place]) continue;
        done[place] = true;
        const double u = static_cast<double>(i * along_x.units - low.i) / (high.i - low.i);
        const double v = static_cast<double>(j * along_y.units - low.j) / (high.j - low.j);
        const std::array<double, 4> weight = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
        MapPoint& point = points[place];
        if (corner[0].source == MapSource::missing) continue;
        point = corner[0];
        point.source = MapSource::interpolated;
        point.growth_error = std::numeric_limits<float>::quiet_NaN();
        point.growth_rate = point.speed = 0;
        for (std::size_t k = 0; k < 4; ++k) {
          point.growth_rate += weight[k] * corner[k].growth_rate;
          point.speed += weight[k] * corner[k].speed;
          point.converged = point.converged && corner[k].converged;
        }
      }
    }
  }
  return points;
}

}  // namespace hb
