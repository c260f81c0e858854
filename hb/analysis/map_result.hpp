// A stability map of a scene: every elastic link by itself, the worst of them, and what belongs on the picture.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "hb/analysis/map_loads.hpp"
#include "hb/analysis/map_theory.hpp"
#include "hb/analysis/request.hpp"
#include "hb/analysis/resonance_lines.hpp"
#include "hb/analysis/scene_band.hpp"
#include "hb/analysis/scene_plane.hpp"
#include "hb/engine/boundaries/stability_map.hpp"

namespace hb {

struct RodCurve {
  std::size_t rod = 0;
  BoundaryCurve curve;
};

// Points without a system for one reason.
struct MissingPoints {
  std::size_t count = 0;
  double x = 0, y = 0;  // the first
  std::string message;  // there
};

struct BandEnd {
  double factor = 1;
  std::vector<RodCurve> boundaries;
};

struct MapResult {
  PlaneAxis x_axis, y_axis;
  std::vector<std::string> rods;
  std::vector<StabilityMap> maps;  // one per rod
  std::vector<MapPoint> worst_of_several;  // empty for one rod
  std::vector<RodCurve> boundaries;  // of the worst: each rod's where no other rod is unstable
  std::vector<BandEnd> band;  // both ends of MapRequest::damping_range or band
  BandParameter band_of = BandParameter::damping;  // what the factors multiply
  std::vector<ResonanceLine> lines;  // of the first rod
  std::vector<MissingPoints> missing;
  bool theory_judged = false;  // the theory error was looked at: of a linkage whose steady state is asked for
  std::vector<TheoryPlace> theory;  // where
  std::vector<PlaceLoads> loads;  // at every point, as `worst()`; empty: not asked for

  // Largest growth over the rods; x fastest.
  const std::vector<MapPoint>& worst() const { return maps.size() > 1 ? worst_of_several : maps.front().points; }
  const std::vector<double>& x() const { return maps.front().x; }
  const std::vector<double>& y() const { return maps.front().y; }
};

// What the settings mean for the search.
[[nodiscard]] MapOptions map_options(const Settings& settings);

// Of all rods, the error beyond what was asked.
[[nodiscard]] std::size_t boundary_points_not_reached(const MapResult& result);

// Boundaries of the worst rod alone.
[[nodiscard]] std::vector<RodCurve> worst_boundaries(const ScenePlane& plane, const std::vector<StabilityMap>& maps,
                                                     const MapOptions& search);

[[nodiscard]] StabilityMap rod_map(const ScenePlane& plane, std::size_t rod, std::vector<double> x,
                                   std::vector<double> y, const MapOptions& search);

// What the maps of all rods take, before they are begun.
[[nodiscard]] PartsAhead parts_of_maps(const ScenePlane& plane, const std::vector<double>& x,
                                       const std::vector<double>& y, const MapOptions& search);

// Everything but the bands.
[[nodiscard]] MapResult compute_map(const ScenePlane& plane, const PlaneAxis& x_axis, std::vector<double> x,
                                    const PlaneAxis& y_axis, std::vector<double> y, const MapOptions& search);

}  // namespace hb
