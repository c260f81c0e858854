// Cells of a stability map: a quadtree on a lattice of places, with the crossings found on its edges. Topology alone:
// nothing is evaluated here.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "hb/engine/boundaries/boundary.hpp"

namespace hb {

// Places of one axis on a lattice: `units` steps (a power of two) between two values that the caller gave.
struct MapAxis {
  std::vector<double> values;  // ascending
  int units = 1;
  int base = 1;  // steps of a cell of the first mesh, a power of two

  int last() const { return static_cast<int>(values.size() - 1) * units; }
  [[nodiscard]] double at(int i) const;
  double scaled(double v) const { return (v - values.front()) / (values.back() - values.front()); }
};

// `every_value`: the first mesh has every value as a place. Throws std::invalid_argument where the values do not
// ascend, with `name`.
[[nodiscard]] MapAxis make_map_axis(std::vector<double> values, bool every_value, const char* name);

inline constexpr std::size_t no_node = static_cast<std::size_t>(-1);

struct MapNode {
  int i, j;
};

struct MapEdge {
  std::size_t a, b;  // nodes
  bool along_x;
  std::size_t before = no_node, after = no_node;  // nodes next to its ends on the same line
  std::array<std::size_t, 2> children{};
  std::size_t middle = 0;
  bool halved = false;
  std::vector<std::size_t> crossings = {};  // ascending; of a halved edge those of its children count
};

// Corners and edges counter-clockwise from the lower left: bottom, right, top, left.
struct MapCell {
  std::array<std::size_t, 4> corners, edges;
  bool halved = false;
};

struct MapCrossing {
  std::size_t edge;
  StabilityBoundary boundary;
};

class MapMesh {
 public:
  MapMesh(MapAxis x, MapAxis y);

  const MapAxis& x() const { return x_; }
  const MapAxis& y() const { return y_; }
  const std::vector<MapNode>& nodes() const { return nodes_; }
  const std::vector<MapCell>& cells() const { return cells_; }
  const std::vector<MapCrossing>& crossings() const { return crossings_; }
  const MapEdge& edge(std::size_t e) const { return edges_[e]; }
  std::size_t num_edges() const { return edges_.size(); }

  double x_of(std::size_t node) const { return x_.at(nodes_[node].i); }
  double y_of(std::size_t node) const { return y_.at(nodes_[node].j); }
  double coordinate(std::size_t node, bool along_x) const { return along_x ? x_of(node) : y_of(node); }
  int width(const MapCell& cell) const { return nodes_[cell.corners[1]].i - nodes_[cell.corners[0]].i; }
  int height(const MapCell& cell) const { return nodes_[cell.corners[3]].j - nodes_[cell.corners[0]].j; }

  bool divisible(const MapCell& cell) const { return width(cell) >= 2 && height(cell) >= 2; }

  // Of an edge of the first mesh up to two nodes beyond each of those next to it.
  [[nodiscard]] std::vector<std::size_t> farther(std::size_t edge) const;

  // The edge may have a crossing where both ends have one verdict; its half has not, if the whole was searched.
  bool searched_as_a_whole(std::size_t edge) const { return searched_[edge]; }

  void set_crossings(std::size_t edge, const std::vector<StabilityBoundary>& found);

  // Crossings of an edge or of what it was divided into, ascending.
  [[nodiscard]] std::vector<std::size_t> crossings_along(std::size_t edge) const;
  // Of a cell, counter-clockwise from the lower left corner.
  [[nodiscard]] std::vector<std::size_t> rim(const MapCell& cell) const;
  // A curve leaves the cell through the side by which it entered: how far it reaches in between is not known.
  [[nodiscard]] bool holds_tip(const MapCell& cell) const;

  // Adds nodes and edges at the end.
  void halve(std::size_t cell);

 private:
  std::size_t add_node(int i, int j);
  std::size_t add_edge(std::size_t a, std::size_t b, bool along_x);
  void halve_edge(std::size_t e);
  void append_crossings(std::size_t e, std::vector<std::size_t>& all) const;

  MapAxis x_, y_;
  std::size_t first_nodes_ = 0, first_edges_ = 0;
  std::vector<MapNode> nodes_;
  std::vector<MapEdge> edges_;
  std::vector<bool> searched_;  // by edge
  std::vector<MapCell> cells_;
  std::vector<MapCrossing> crossings_;
};

}  // namespace hb
