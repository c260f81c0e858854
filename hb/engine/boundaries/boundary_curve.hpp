// Curves of a stability map made of the points where its cells' edges cross them.
#pragma once

#include <array>
#include <vector>

#include "hb/engine/boundaries/sweep.hpp"

namespace hb {

struct BoundaryPoint {
  double x = 0, y = 0;
  double error = 0;  // half of the bracket that is left, along x or along y
  bool along_x = true;
};

struct BoundaryCurve {
  BoundaryKind kind = BoundaryKind::complex;
  bool closed = false;  // the last point repeats the first
  std::vector<BoundaryPoint> points;
};

// Crossings (by number) that one cell joins.
struct CurveLink {
  std::array<std::size_t, 2> ends;
  std::size_t cell = 0;
};

// Links in the order in which they follow each other.
struct CurveChain {
  std::vector<std::size_t> points;  // crossings
  std::vector<std::size_t> cells;  // of the links between them: one less
  bool closed = false;  // the last point repeats the first
};

// Every link in one chain; a crossing has at most two links. Open chains first, by their smaller end, then closed ones.
[[nodiscard]] std::vector<CurveChain> chains(std::size_t num_points, const std::vector<CurveLink>& links);

// How the crossings on a cell's rim, numbered counter-clockwise, are joined inside: of the pieces of the rim between
// them those that differ from the centre are cut off. `start_unstable`: verdict where the numbering starts.
[[nodiscard]] std::vector<std::array<std::size_t, 2>> joined_in_cell(std::size_t num_crossings, bool start_unstable,
                                                                     bool centre_unstable);

// Of the stretches between these points those whose chord leaves the curve by more than `sag`, in coordinates scaled to
// the map: an arc of length s that turns by t leaves its chord by s t/8.
[[nodiscard]] std::vector<bool> coarse_chords(const std::vector<BoundaryPoint>& scaled, bool closed, double sag);

}  // namespace hb
