#include "hb/engine/boundaries/map_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace hb {

namespace {

// Cells of the first mesh per axis at least, and the finest division of an axis for thin or curved boundaries.
constexpr int first_cells = 16;
constexpr int finest_cells = 8192;

int floor_power(int n) { return static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(n, 1)))); }

// Where a stretch is halved: at the lattice's coarsest place inside.
int middle_of(int a, int b) { return a + floor_power(b - a - 1); }

std::vector<int> first_places(const MapAxis& axis) {
  std::vector<int> places;
  for (int i = 0; i < axis.last(); i += axis.base) places.push_back(i);
  places.push_back(axis.last());
  return places;
}

}  // namespace

double MapAxis::at(int i) const {
  const int k = i / units, r = i % units;
  const double v = values[static_cast<std::size_t>(k)];
  return r == 0 ? v : v + (values[static_cast<std::size_t>(k) + 1] - v) * (static_cast<double>(r) / units);
}

MapAxis make_map_axis(std::vector<double> values, bool every_value, const char* name) {
  if (values.size() < 2 || values.size() > 1000000) {
    throw std::invalid_argument(std::string("stability_map: ") + name + " needs 2 to 1000000 values");
  }
  for (std::size_t k = 0; k + 1 < values.size(); ++k) {
    if (!(values[k] < values[k + 1]) || !std::isfinite(values[k]) || !std::isfinite(values[k + 1])) {
      throw std::invalid_argument(std::string("stability_map: ") + name + " must ascend and be finite");
    }
  }
  const int cells = static_cast<int>(values.size() - 1);
  MapAxis axis{std::move(values), floor_power(finest_cells / cells), 1};
  axis.base = floor_power(static_cast<int>(static_cast<long long>(cells) * axis.units / first_cells));
  if (every_value) axis.base = std::min(axis.base, axis.units);
  return axis;
}

MapMesh::MapMesh(MapAxis x, MapAxis y) : x_(std::move(x)), y_(std::move(y)) {
  const std::vector<int> is = first_places(x_), js = first_places(y_);
  const std::size_t nx = is.size(), ny = js.size();
  for (const int j : js) {
    for (const int i : is) add_node(i, j);
  }
  std::vector<std::size_t> bottom, left;  // edges that leave a node to the right and upward
  const auto edge_along = [&](std::size_t node, std::size_t k, std::size_t n, std::size_t step, bool along_x) {
    const std::size_t e = add_edge(node, node + step, along_x);
    edges_[e].before = k > 0 ? node - step : no_node;
    edges_[e].after = k + 2 < n ? node + 2 * step : no_node;
    return e;
  };
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      const std::size_t node = i + nx * j;
      bottom.push_back(i + 1 < nx ? edge_along(node, i, nx, 1, true) : 0);
      left.push_back(j + 1 < ny ? edge_along(node, j, ny, nx, false) : 0);
    }
  }
  for (std::size_t j = 0; j + 1 < ny; ++j) {
    for (std::size_t i = 0; i + 1 < nx; ++i) {
      const std::size_t node = i + nx * j;
      cells_.push_back(
          {{node, node + 1, node + nx + 1, node + nx}, {bottom[node], left[node + 1], bottom[node + nx], left[node]}});
    }
  }
  first_nodes_ = nodes_.size();
  first_edges_ = edges_.size();
}

std::vector<std::size_t> MapMesh::farther(std::size_t e) const {
  std::vector<std::size_t> nodes;
  if (e >= first_edges_) return nodes;
  const MapEdge& edge = edges_[e];
  const std::size_t step = edge.b - edge.a;
  const auto on_line = [&](std::size_t node) {
    return node < first_nodes_ &&
           (edge.along_x ? nodes_[node].j == nodes_[edge.a].j : nodes_[node].i == nodes_[edge.a].i);
  };
  for (const std::size_t k : {std::size_t(2), std::size_t(3)}) {
    if (edge.a >= k * step && on_line(edge.a - k * step)) nodes.push_back(edge.a - k * step);
    if (on_line(edge.b + k * step)) nodes.push_back(edge.b + k * step);
  }
  return nodes;
}

std::size_t MapMesh::add_node(int i, int j) {
  nodes_.push_back({i, j});
  return nodes_.size() - 1;
}

std::size_t MapMesh::add_edge(std::size_t a, std::size_t b, bool along_x) {
  edges_.push_back({.a = a, .b = b, .along_x = along_x});
  searched_.push_back(false);
  return edges_.size() - 1;
}

void MapMesh::set_crossings(std::size_t edge, const std::vector<StabilityBoundary>& found) {
  edges_[edge].crossings.clear();
  for (const StabilityBoundary& boundary : found) {
    edges_[edge].crossings.push_back(crossings_.size());
    crossings_.push_back({edge, boundary});
  }
}

void MapMesh::append_crossings(std::size_t e, std::vector<std::size_t>& all) const {
  const MapEdge& edge = edges_[e];
  if (edge.halved) {
    append_crossings(edge.children[0], all);
    append_crossings(edge.children[1], all);
  } else {
    all.insert(all.end(), edge.crossings.begin(), edge.crossings.end());
  }
}

std::vector<std::size_t> MapMesh::crossings_along(std::size_t edge) const {
  std::vector<std::size_t> all;
  append_crossings(edge, all);
  return all;
}

std::vector<std::size_t> MapMesh::rim(const MapCell& cell) const {
  std::vector<std::size_t> all;
  for (std::size_t side = 0; side < 4; ++side) {
    const auto start = static_cast<std::ptrdiff_t>(all.size());
    append_crossings(cell.edges[side], all);
    if (side >= 2) std::reverse(all.begin() + start, all.end());
  }
  return all;
}

bool MapMesh::holds_tip(const MapCell& cell) const {
  return rim(cell).size() == 2 &&
         std::ranges::any_of(cell.edges, [&](std::size_t e) { return crossings_along(e).size() == 2; });
}

void MapMesh::halve_edge(std::size_t e) {
  if (edges_[e].halved) return;
  const MapEdge edge = edges_[e];
  const MapNode a = nodes_[edge.a], b = nodes_[edge.b];
  const std::size_t middle = edge.along_x ? add_node(middle_of(a.i, b.i), a.j) : add_node(a.i, middle_of(a.j, b.j));
  const double t = coordinate(middle, edge.along_x);
  const std::array<std::size_t, 2> children = {add_edge(edge.a, middle, edge.along_x),
                                               add_edge(middle, edge.b, edge.along_x)};
  for (const std::size_t c : edge.crossings)
    edges_[children[crossings_[c].boundary.x < t ? 0 : 1]].crossings.push_back(c);
  edges_[children[0]].before = edge.before;
  edges_[children[0]].after = edge.b;
  edges_[children[1]].before = edge.a;
  edges_[children[1]].after = edge.after;
  for (const std::size_t child : children) searched_[child] = edge.crossings.empty();
  edges_[e].children = children;
  edges_[e].middle = middle;
  edges_[e].halved = true;
}

void MapMesh::halve(std::size_t c) {
  cells_[c].halved = true;
  const MapCell cell = cells_[c];
  for (const std::size_t e : cell.edges) halve_edge(e);
  std::array<std::size_t, 4> m{};
  for (std::size_t side = 0; side < 4; ++side) m[side] = edges_[cell.edges[side]].middle;
  const std::size_t centre = add_node(nodes_[m[0]].i, nodes_[m[1]].j);
  const std::size_t down = add_edge(m[0], centre, false), up = add_edge(centre, m[2], false);
  const std::size_t left = add_edge(m[3], centre, true), right = add_edge(centre, m[1], true);
  const auto half = [&](std::size_t side, std::size_t k) { return edges_[cell.edges[side]].children[k]; };
  const auto& corner = cell.corners;
  cells_.push_back({{corner[0], m[0], centre, m[3]}, {half(0, 0), down, left, half(3, 0)}});
  cells_.push_back({{m[0], corner[1], m[1], centre}, {half(0, 1), half(1, 0), right, down}});
  cells_.push_back({{centre, m[1], corner[2], m[2]}, {right, half(1, 1), half(2, 1), up}});
  cells_.push_back({{m[3], centre, m[2], corner[3]}, {left, up, half(2, 0), half(3, 1)}});
}

}  // namespace hb
