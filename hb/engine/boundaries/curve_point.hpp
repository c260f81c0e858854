// Points of boundary curves: one more between two neighbours that are known, and curves made of them.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "hb/engine/boundaries/boundary_curve.hpp"

namespace hb {

// Empty where there is no system (a linkage that does not close). Same place, same result; called from several threads
// when the parts are computed by several.
using MapSystemAt = std::function<std::optional<ScaledSystem>(double x, double y)>;

class DiscriminantSurface;

struct CurvePoint {
  BoundaryPoint place;
  BoundaryKind kind = BoundaryKind::complex;
  bool unstable_above = false;  // along x or along y, as the place says
  bool converged = false;
};

struct CurveStretch {
  std::optional<CurvePoint> before, after;  // the curve's points next to it
  CurvePoint a, b;
  double low_x, high_x, low_y, high_y;  // the curve stays in this box
  bool crowded = false;  // other curves pass the box: a band or a gap may be too thin for verdicts to show it
};

// Near the middle of the stretch, by a cubic through its ends (hb/engine/README.md, (B8)), then along x or y, whichever
// is more across the curve. `wide`, `high`: of the map, which scale x and y. Empty if no boundary is there that has the
// same side unstable as both ends. `surface` (or null) is of this map.
[[nodiscard]] std::optional<CurvePoint> point_between(const MapSystemAt& at, const CurveStretch& stretch, double wide,
                                                      double high, const SweepOptions& options,
                                                      const DiscriminantSurface* surface = nullptr);

// The curve through these points, apart where its kind changes. `closed`: the last point repeats the first.
[[nodiscard]] std::vector<BoundaryCurve> pieces_of_one_kind(const std::vector<CurvePoint>& points, bool closed);

}  // namespace hb
