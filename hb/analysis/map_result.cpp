#include "hb/analysis/map_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "hb/analysis/accuracy.hpp"

namespace hb {
namespace {

constexpr std::size_t max_lines = 10;

// Least stable point of all rods: by the worst verdict, then by growth.
MapPoint worse(const MapPoint& a, const MapPoint& b) {
  if (a.source == MapSource::missing || b.source == MapSource::missing) return MapPoint();
  MapPoint result = b.growth_rate > a.growth_rate ? b : a;
  result.verdict = worst(a.verdict, b.verdict);
  if (a.source == MapSource::interpolated || b.source == MapSource::interpolated) {
    result.source = MapSource::interpolated;
  }
  result.converged = a.converged && b.converged;
  return result;
}

std::vector<MissingPoints> missing_points(const ScenePlane& plane, const StabilityMap& map) {
  // The message names the angle, which differs from place to place: the dyad tells reasons apart.
  std::map<std::pair<int, std::string>, MissingPoints> reasons;
  // Every reason of a large hole need not be asked for at every point.
  constexpr std::size_t max_asked = 5000;
  std::vector<std::size_t> places;
  for (std::size_t p = 0; p < map.points.size(); ++p) {
    if (map.points[p].source == MapSource::missing) places.push_back(p);
  }
  const std::size_t stride = 1 + places.size() / max_asked;
  std::pair<int, std::string> key;
  for (std::size_t n = 0; n < places.size(); ++n) {
    const double x = map.x[places[n] % map.x.size()], y = map.y[places[n] / map.x.size()];
    if (n % stride == 0) {
      const auto why = plane.absence(x, y);
      const std::string message = why ? why->message : "the system's mass is singular";
      key = {why ? why->dyad : -1, why && why->dyad >= 0 ? "" : message};
      if (!reasons.count(key)) reasons[key] = {0, x, y, message};
    }
    ++reasons[key].count;
  }
  std::vector<MissingPoints> result;
  for (auto& [ignored, points] : reasons) result.push_back(std::move(points));
  std::stable_sort(result.begin(), result.end(),
                   [](const MissingPoints& a, const MissingPoints& b) { return a.count > b.count; });
  return result;
}

}  // namespace

MapOptions map_options(const Settings& settings) {
  MapOptions options;
  options.search = boundary_options(settings);
  // Where no curves are asked for boundaries only tell which cells of a large grid have one verdict.
  options.search.tolerance = settings.boundaries ? settings.boundary_tolerance : 1e-3;
  options.boundaries = settings.boundaries;
  options.verdict_only = settings.only.verdict;
  return options;
}

std::size_t boundary_points_not_reached(const MapResult& result) {
  std::size_t count = 0;
  for (const StabilityMap& map : result.maps) count += map.not_converged;
  return count;
}

namespace {

// Parts of several rods take differently.
std::string kind_of_rod(const std::string& kind, std::size_t rod) { return fmt::format("{} of rod {}", kind, rod); }

PartsAhead of_rod(PartsAhead parts, std::size_t rod) {
  for (auto& [kind, count] : parts) kind = kind_of_rod(kind, rod);
  return parts;
}

// `left`: of all maps of the same work; each knows its own kinds by its number.
StabilityMapSearch rod_search(const ScenePlane& plane, std::size_t rod, std::vector<double> x, std::vector<double> y,
                              MapOptions search, const std::function<PartsAhead()>& left = {}) {
  search.varies = plane.varies(rod);
  if (search.parts)
    search.parts = [rod, left, outer = search.parts](const Parts& parts) {
      Parts own = parts;
      if (!parts.kind.empty()) own.kind = kind_of_rod(parts.kind, rod);
      if (left) own.ahead = left();
      outer(own);
    };
  return stability_map_search([&plane, rod](double u, double v) { return plane.system(rod, u, v); }, std::move(x),
                              std::move(y), search);
}

}  // namespace

StabilityMap rod_map(const ScenePlane& plane, std::size_t rod, std::vector<double> x, std::vector<double> y,
                     const MapOptions& search) {
  StabilityMapSearch one;
  one = rod_search(plane, rod, std::move(x), std::move(y), search, [&] { return of_rod(one.left(), rod); });
  one.begin();
  one.finish();
  return one.result();
}

PartsAhead parts_of_maps(const ScenePlane& plane, const std::vector<double>& x, const std::vector<double>& y,
                         const MapOptions& search) {
  PartsAhead all;
  for (std::size_t r = 0; r < plane.rods().size(); ++r)
    for (auto& kind : of_rod(rod_search(plane, r, x, y, search).left(), r)) all.push_back(std::move(kind));
  return all;
}

std::vector<RodCurve> worst_boundaries(const ScenePlane& plane, const std::vector<StabilityMap>& maps,
                                       const MapOptions& search) {
  struct Place {
    std::size_t rod;
    double x, y;
  };
  std::vector<Place> places;
  for (std::size_t r = 0; r < maps.size(); ++r) {
    for (const BoundaryCurve& curve : maps[r].boundaries) {
      for (const BoundaryPoint& p : curve.points) places.push_back({r, p.x, p.y});
    }
  }
  std::vector<char> hidden(places.size(), false);
  if (maps.size() > 1) {
    StabilityOptions options = search.search.stability;
    options.leading_only = true;
    hidden = computed_parts<char>(
        search.parts, places.size(),
        [&](std::size_t k) -> char {
          for (std::size_t r = 0; r < maps.size(); ++r) {
            if (r == places[k].rod) continue;
            const std::optional<ScaledSystem> system = plane.system(r, places[k].x, places[k].y);
            if (system && analyse_stability(*system, options).verdict == Verdict::unstable) return true;
          }
          return false;
        },
        [](auto& visit, char& is_hidden) { visit_as_number(visit, is_hidden); });
  }
  std::vector<RodCurve> result;
  std::size_t k = 0;
  for (std::size_t r = 0; r < maps.size(); ++r) {
    for (const BoundaryCurve& curve : maps[r].boundaries) {
      RodCurve piece{r, {curve.kind, false, {}}};
      bool whole = true;
      for (const BoundaryPoint& p : curve.points) {
        if (!hidden[k++]) {
          piece.curve.points.push_back(p);
          continue;
        }
        whole = false;
        if (!piece.curve.points.empty()) result.push_back(piece);
        piece.curve.points.clear();
      }
      piece.curve.closed = curve.closed && whole;
      if (!piece.curve.points.empty()) result.push_back(std::move(piece));
    }
  }
  return result;
}

MapResult compute_map(const ScenePlane& plane, const PlaneAxis& x_axis, std::vector<double> x, const PlaneAxis& y_axis,
                      std::vector<double> y, const MapOptions& search) {
  MapResult result;
  result.x_axis = x_axis;
  result.y_axis = y_axis;
  result.rods = plane.rods();
  std::vector<StabilityMapSearch> searches;
  const auto left = [&] {
    PartsAhead all;
    for (std::size_t r = 0; r < searches.size(); ++r)
      for (auto& kind : of_rod(searches[r].left(), r)) all.push_back(std::move(kind));
    return all;
  };
  for (std::size_t r = 0; r < result.rods.size(); ++r) searches.push_back(rod_search(plane, r, x, y, search, left));
  for (const StabilityMapSearch& one : searches) one.sample();
  for (const StabilityMapSearch& one : searches) one.begin();
  for (const StabilityMapSearch& one : searches) one.finish();
  for (const StabilityMapSearch& one : searches) result.maps.push_back(one.result());
  if (result.maps.size() > 1) result.worst_of_several = result.maps.front().points;
  for (std::size_t r = 1; r < result.maps.size(); ++r) {
    for (std::size_t p = 0; p < result.worst_of_several.size(); ++p) {
      MapPoint& point = result.worst_of_several[p];
      point = worse(point, result.maps[r].points[p]);
    }
  }
  if (search.boundaries) result.boundaries = worst_boundaries(plane, result.maps, search);
  result.lines = resonance_lines([&](double u, double v) { return plane.system(0, u, v); },
                                 {result.x().front(), result.x().back()}, {result.y().front(), result.y().back()},
                                 max_lines, search.for_each);
  result.missing = missing_points(plane, result.maps.front());
  return result;
}

}  // namespace hb
