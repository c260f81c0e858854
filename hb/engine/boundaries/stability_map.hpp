// Stability of one system over two of its parameters x, y: growth rate and verdict on a grid, and the curves where the
// verdict changes. Tongues that lie between grid lines are looked for along every cell's edges (interval_search.hpp).
// With one mode the discriminant, interpolated over the whole map, tells both (discriminant_surface.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/boundary_curve.hpp"
#include "hb/engine/boundaries/curve_point.hpp"
#include "hb/engine/boundaries/part.hpp"
#include "hb/engine/boundaries/sweep.hpp"
#include "hb/engine/exponents/stability.hpp"

namespace hb {

struct MapOptions {
  SweepOptions search;  // of the boundary along an edge; its stability options hold at the nodes too
  std::size_t evaluate_all = 40000;  // grids of at most so many points have exponents computed at every point
  std::size_t evaluate_all_alone = 160000;  // of several modes, where no curve is asked for
  double sag = 5e-4;  // of a boundary's chord, relative to the map's width and height
  bool boundaries = true;  // false: the grid alone
  bool verdict_only = false;  // of a grid without boundaries: growth where no bound proves stability
  bool curves_only = false;  // no grid values; the grid serves the search alone
  // Whether the system depends on x and on y. Along an axis on which it does not, one line is computed for all.
  std::array<bool, 2> varies = {true, true};
  PartsOf parts;  // who computes the parts of a step; empty: one after the other
  ForEach for_each = {};  // who does what is short
};

enum class MapSource {
  evaluated,
  interpolated,  // inside a cell whose corners and edges have one verdict, growth bilinear; or by the discriminant
  missing,  // no system here
};

// Maps have millions of these: 24 bytes.
struct MapPoint {
  MapSource source : 8 = MapSource::missing;
  Verdict verdict : 8 = Verdict::undecided;
  BoundaryKind kind : 8 = BoundaryKind::complex;  // of the leading exponent
  bool converged : 8 = false;
  // 1/time, as that of exponents, rounded upwards; estimate where the discriminant tells, NaN where bilinear.
  float growth_error = 0;
  double speed = 0;  // rad per unit time
  double growth_rate = 0;  // 1/time
};

// An error as a number of fewer digits that is not less.
[[nodiscard]] float rounded_up(double error);

struct StabilityMap {
  std::vector<double> x, y;
  std::vector<MapPoint> points;  // x fastest: point (i, j) is [i + nx j]
  std::vector<BoundaryCurve> boundaries;
  std::size_t samples = 0;  // places where the exponents were computed
  std::size_t not_converged = 0;  // boundary points whose bracket stayed wider than asked
  // x, y of the ends of pieces of cell edges where a tongue or a gap may have been missed.
  std::vector<std::array<double, 4>> not_excluded = {};

  const MapPoint& at(std::size_t i, std::size_t j) const { return points[i + x.size() * j]; }
};

// A map in steps, so that several systems over one plane have their grids before any curve is followed. `system` and
// options.parts are called until the end.
struct StabilityMapSearch {
  // A few edges spread over the map, and the nodes that they need, before all others: where parts have a kind, what
  // these take tells what the whole will. May be left out.
  std::function<void()> sample;
  std::function<void()> begin;  // the grid
  std::function<void()>
      finish;  // crossings along the cells' edges, cells halved where they leave something open, curves
  std::function<StabilityMap()> result;
  // What is to come after the step under way, "node", "edge", "halved edge", "curve point": an estimate, of edges to be
  // halved and of curves by the crossings so far.
  std::function<PartsAhead()> left;
};
// x and y ascending, at least two values each; throws std::invalid_argument otherwise.
[[nodiscard]] StabilityMapSearch stability_map_search(const MapSystemAt& system, std::vector<double> x,
                                                      std::vector<double> y, const MapOptions& options);

// Both steps; throws std::invalid_argument as above.
[[nodiscard]] StabilityMap stability_map(const MapSystemAt& system, std::vector<double> x, std::vector<double> y,
                                         const MapOptions& options = {});

}  // namespace hb
