// Boundary curves of a stability map: the crossings of its mesh joined cell by cell, with points between them until
// their chords are straight. Says where points are wanted; nothing is evaluated here.
#pragma once

#include <compare>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "hb/engine/boundaries/curve_point.hpp"
#include "hb/engine/boundaries/map_mesh.hpp"

namespace hb {

// A piece of a curve inside one cell, between two crossings, the smaller number first.
struct MapLink {
  std::size_t cell, from, to;
  auto operator<=>(const MapLink&) const = default;
};

// Where on a curve a point is wanted.
struct WantedPoint {
  MapLink link;
  std::size_t position;  // among the points that the link has
  CurveStretch stretch;
};

class MapCurves {
 public:
  using UnstableNode = std::function<bool(std::size_t node)>;
  using UnstableCentres = std::function<std::vector<char>(const std::vector<std::size_t>& cells)>;

  // Chords leave the curves by up to `sag`. `bend`: the system depends on x and on y.
  MapCurves(const MapMesh& mesh, double sag, bool bend) : mesh_(mesh), sag_(sag), bend_(bend) {}

  // Crossings into chains, by the verdicts in the middle of cells that more than one curve passes.
  void join(const UnstableNode& unstable, const UnstableCentres& unstable_centres);
  const std::vector<CurveChain>& chains() const { return chains_; }
  // Of a chain, with those put between its crossings.
  [[nodiscard]] std::vector<CurvePoint> points(const CurveChain& chain) const { return curve(chain).points; }

  // Cells in which a curve turns back: between its neighbours in the chain points show how wide the tip is, not how far
  // it reaches.
  [[nodiscard]] std::set<std::size_t> cells_with_turns() const;
  [[nodiscard]] std::vector<WantedPoint> coarse_stretches() const;
  // Points that were wanted. Cells to be halved: those in which one was not found.
  [[nodiscard]] std::set<std::size_t> insert(const std::vector<WantedPoint>& wanted,
                                             const std::vector<std::optional<CurvePoint>>& found);
  // The points in these cells.
  void forget(const std::set<std::size_t>& cells);

 private:
  // A chain with the points put between its crossings, and for each stretch the link that it belongs to and the place
  // that a point in it would have there.
  struct Curve {
    std::vector<CurvePoint> points;
    std::vector<std::pair<MapLink, std::size_t>> stretches;
  };

  [[nodiscard]] Curve curve(const CurveChain& chain) const;
  [[nodiscard]] CurvePoint crossing(std::size_t k) const;
  [[nodiscard]] BoundaryPoint scaled(const CurvePoint& point) const;
  [[nodiscard]] CurveStretch stretch(const Curve& c, std::size_t k, bool closed) const;

  const MapMesh& mesh_;
  double sag_;
  bool bend_;
  std::vector<CurveChain> chains_;
  std::set<std::size_t> unclear_;  // cells that more than one curve passes
  std::map<MapLink, std::vector<CurvePoint>> inserted_;  // from the crossing of the smaller number
  std::set<MapLink> closed_;  // no more points are found there
};

}  // namespace hb
