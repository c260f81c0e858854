#include "hb/engine/boundaries/stability_map.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hb/engine/boundaries/finite_growth.hpp"
#include "hb/engine/boundaries/interval_search.hpp"

namespace hb {

namespace {

// Places are numbered on a lattice: per axis `units` steps (a power of two) between two values that the caller gave.
struct Axis {
  std::vector<double> values;
  int units = 1;
  int base = 1;  // steps of a cell of the first mesh, a power of two

  int last() const { return static_cast<int>(values.size() - 1) * units; }
  double at(int i) const {
    const int k = i / units, r = i % units;
    const double v = values[static_cast<std::size_t>(k)];
    return r == 0 ? v : v + (values[static_cast<std::size_t>(k) + 1] - v) * (static_cast<double>(r) / units);
  }
  double scaled(double v) const { return (v - values.front()) / (values.back() - values.front()); }
};

// Cells of the first mesh per axis at least, and the finest division of an axis for thin or curved boundaries.
constexpr int first_cells = 24;
constexpr int finest_cells = 8192;

int floor_power(int n) { return static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(n, 1)))); }

Axis make_axis(std::vector<double> values, bool every_value, const char* name) {
  if (values.size() < 2 || values.size() > 1000000) {
    throw std::invalid_argument(std::string("stability_map: ") + name + " needs 2 to 1000000 values");
  }
  for (std::size_t k = 0; k + 1 < values.size(); ++k) {
    if (!(values[k] < values[k + 1]) || !std::isfinite(values[k]) || !std::isfinite(values[k + 1])) {
      throw std::invalid_argument(std::string("stability_map: ") + name + " must ascend and be finite");
    }
  }
  const int cells = static_cast<int>(values.size() - 1);
  Axis axis{std::move(values), floor_power(finest_cells / cells), 1};
  axis.base = floor_power(static_cast<int>(static_cast<long long>(cells) * axis.units / first_cells));
  if (every_value) axis.base = std::min(axis.base, axis.units);
  return axis;
}

// Where a stretch is halved: at the lattice's coarsest place inside.
int middle_of(int a, int b) { return a + floor_power(b - a - 1); }

struct Node {
  int i, j;
  std::optional<StabilitySample> sample;

  bool unstable() const { return sample && is_unstable(*sample); }
};

struct Crossing {
  std::size_t edge;
  StabilityBoundary boundary;
};

constexpr std::size_t none = static_cast<std::size_t>(-1);

struct Edge {
  Edge(std::size_t from, std::size_t to, bool horizontal) : a(from), b(to), along_x(horizontal) {}
  std::size_t a, b;
  bool along_x;
  std::size_t before = none, after = none;  // nodes next to its ends on the same line
  std::array<std::size_t, 2> children{};
  std::size_t middle = 0;
  bool halved = false;
  std::vector<std::size_t> crossings;  // ascending; of a halved edge those of its children count
};

// Corners and edges counter-clockwise from the lower left: bottom, right, top, left.
struct Cell {
  std::array<std::size_t, 4> corners, edges;
  bool halved = false;
};

class Mesh {
 public:
  Mesh(const MapSystemAt& at, Axis x, Axis y, bool every_value, const MapOptions& options)
      : at_(at),
        x_(std::move(x)),
        y_(std::move(y)),
        options_(options),
        grid_alone_(every_value && !options.boundaries) {
    along_edges_ = options.search;
    constexpr double rough_tolerance = 1e-9;
    along_edges_.stability.tolerance = std::max(options.search.stability.tolerance, rough_tolerance);
    at_nodes_ = along_edges_.stability;
    at_nodes_.leading_only = grid_alone_;
    at_nodes_.verdict_only = grid_alone_ && options.verdict_only;
    leading_ = at_nodes_;
    leading_.leading_only = true;
  }

  void build() {
    first_mesh();
    evaluate();
    if (grid_alone_) return;
    growth_range();
    for (;;) {
      refine();
      if (!options_.boundaries || !refine_curves()) break;
    }
  }

  StabilityMap result() {
    StabilityMap map;
    if (!options_.curves_only) fill(map);
    for (const CurveChain& chain : chains_) add_curves(chain, map.boundaries);
    for (const Crossing& crossing : crossings_) map.not_converged += options_.boundaries && !reached(crossing.boundary);
    map.samples = samples_;
    map.x = x_.values;
    map.y = y_.values;
    return map;
  }

 private:
  template <class Result, class Visit>
  std::vector<Result> results(std::size_t count, const std::function<Result(std::size_t)>& compute,
                              const Visit& visit) const {
    return computed_parts<Result>(options_.parts, count, compute, visit);
  }

  // Error within ten times what was asked, or within what searches promise.
  bool reached(const StabilityBoundary& boundary) const {
    return boundary.converged || boundary.error <= 10 * options_.search.tolerance * std::abs(boundary.x);
  }

  // All exponents at a node; the leading ones suffice elsewhere.
  std::optional<StabilitySample> sample(double x, double y, const StabilityOptions& stability) const {
    ++samples_;
    if (!grid_alone_) return stability_sample([&](double t) { return at_(t, y); }, x, stability);
    const std::optional<ScaledSystem> system = at_(x, y);
    if (!system) return std::nullopt;
    return StabilitySample{x, system->speed, with_finite_growth(*system, stability)};
  }

  std::size_t add_node(int i, int j) {
    nodes_.push_back({i, j, std::nullopt});
    return nodes_.size() - 1;
  }

  std::size_t add_edge(std::size_t a, std::size_t b, bool along_x) {
    edges_.emplace_back(a, b, along_x);
    new_edges_.push_back({edges_.size() - 1, true});
    return edges_.size() - 1;
  }

  void set_beside(std::size_t edge, std::size_t before, std::size_t after) {
    edges_[edge].before = before;
    edges_[edge].after = after;
  }

  static std::vector<int> first_places(const Axis& axis) {
    std::vector<int> places;
    for (int i = 0; i < axis.last(); i += axis.base) places.push_back(i);
    places.push_back(axis.last());
    return places;
  }

  void first_mesh() {
    const std::vector<int> is = first_places(x_), js = first_places(y_);
    const std::size_t nx = is.size(), ny = js.size();
    for (const int j : js) {
      for (const int i : is) add_node(i, j);
    }
    std::vector<std::size_t> bottom, left;  // edges that leave a node to the right and upward
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i) {
        const std::size_t node = i + nx * j;
        bottom.push_back(i + 1 < nx ? add_edge(node, node + 1, true) : 0);
        if (i + 1 < nx) set_beside(bottom.back(), i > 0 ? node - 1 : none, i + 2 < nx ? node + 2 : none);
        left.push_back(j + 1 < ny ? add_edge(node, node + nx, false) : 0);
        if (j + 1 < ny) set_beside(left.back(), j > 0 ? node - nx : none, j + 2 < ny ? node + 2 * nx : none);
      }
    }
    for (std::size_t j = 0; j + 1 < ny; ++j) {
      for (std::size_t i = 0; i + 1 < nx; ++i) {
        const std::size_t node = i + nx * j;
        cells_.push_back({{node, node + 1, node + nx + 1, node + nx},
                          {bottom[node], left[node + 1], bottom[node + nx], left[node]}});
      }
    }
  }

  double coordinate(std::size_t node, bool along_x) const {
    return along_x ? x_.at(nodes_[node].i) : y_.at(nodes_[node].j);
  }

  // Samples at the nodes and crossings of the edges that are new.
  void evaluate() {
    using Sample = std::optional<StabilitySample>;
    std::vector<Sample> samples = results<Sample>(
        nodes_.size() - evaluated_nodes_,
        [this](std::size_t k) {
          const Node& node = nodes_[evaluated_nodes_ + k];
          return sample(x_.at(node.i), y_.at(node.j), at_nodes_);
        },
        [](auto& visit, Sample& sample) {
          visit_if_there(visit, sample, [&](StabilitySample& there) { visit_sample(visit, there); });
        });
    for (Sample& sample : samples) nodes_[evaluated_nodes_++].sample = std::move(sample);
    if (grid_alone_) return;

    using Found = std::optional<std::vector<StabilityBoundary>>;
    const std::vector<Found> found = results<Found>(
        new_edges_.size(), [this](std::size_t k) { return crossings_of(new_edges_[k]); },
        [](auto& visit, Found& crossings) {
          visit_if_there(visit, crossings, [&](std::vector<StabilityBoundary>& all) {
            visit_elements(visit, all, [&](StabilityBoundary& boundary) { visit_boundary(visit, boundary); });
          });
        });
    for (std::size_t k = 0; k < new_edges_.size(); ++k) {
      if (!found[k]) continue;
      Edge& edge = edges_[new_edges_[k].edge];
      edge.crossings.clear();
      for (const StabilityBoundary& boundary : *found[k]) {
        edge.crossings.push_back(crossings_.size());
        crossings_.push_back({new_edges_[k].edge, boundary});
      }
    }
    new_edges_.clear();
  }

  struct NewEdge {
    std::size_t edge;
    bool search;  // also between ends of one verdict without known crossings
  };

  // Crossings, or nothing if those that the edge has from its parent agree with the verdicts at its ends.
  std::optional<std::vector<StabilityBoundary>> crossings_of(const NewEdge& item) const {
    const Edge& edge = edges_[item.edge];
    const Node &a = nodes_[edge.a], &b = nodes_[edge.b];
    if (!a.sample || !b.sample) return std::nullopt;
    const bool changes = a.unstable() != b.unstable(), odd = edge.crossings.size() % 2 == 1;
    if (changes == odd && (!edge.crossings.empty() || !item.search)) return std::nullopt;
    const double fixed = edge.along_x ? y_.at(a.j) : x_.at(a.i);
    const SystemAt along = [&](double t) {
      ++samples_;
      return edge.along_x ? at_(t, fixed) : at_(fixed, t);
    };
    const auto sample_at = [&](std::size_t node) {
      std::optional<StabilitySample> sample;
      if (node != none) sample = nodes_[node].sample;
      if (sample) sample->x = coordinate(node, edge.along_x);
      return sample;
    };
    const auto before = sample_at(edge.before), first = sample_at(edge.a), last = sample_at(edge.b),
               after = sample_at(edge.after);
    return search_interval(along, *first, *last, before ? &*before : nullptr, after ? &*after : nullptr, along_edges_)
        .boundaries;
  }

  void growth_range() {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Node& node : nodes_) {
      if (!node.sample) continue;
      low = std::min(low, node.sample->stability.growth_rate);
      high = std::max(high, node.sample->stability.growth_rate);
    }
    range_ = high > low ? high - low : 0;
  }

  void append_crossings(std::size_t e, std::vector<std::size_t>& all) const {
    const Edge& edge = edges_[e];
    if (edge.halved) {
      append_crossings(edge.children[0], all);
      append_crossings(edge.children[1], all);
    } else {
      all.insert(all.end(), edge.crossings.begin(), edge.crossings.end());
    }
  }

  // Counter-clockwise from the lower left corner.
  std::vector<std::size_t> rim(const Cell& cell) const {
    std::vector<std::size_t> all;
    for (std::size_t side = 0; side < 4; ++side) {
      const auto start = static_cast<std::ptrdiff_t>(all.size());
      append_crossings(cell.edges[side], all);
      if (side >= 2) std::reverse(all.begin() + start, all.end());
    }
    return all;
  }

  int width(const Cell& cell) const { return nodes_[cell.corners[1]].i - nodes_[cell.corners[0]].i; }
  int height(const Cell& cell) const { return nodes_[cell.corners[3]].j - nodes_[cell.corners[0]].j; }

  bool wants_halving(const Cell& cell) const {
    const int w = width(cell), h = height(cell);
    if (w < 2 || h < 2) return false;
    int present = 0;
    for (const std::size_t corner : cell.corners) present += nodes_[corner].sample.has_value();
    const std::vector<std::size_t> crossings = rim(cell);
    if (w > x_.units || h > y_.units) {
      if (options_.curves_only) return !crossings.empty() && crossings.size() != 2;
      return !crossings.empty() || (present > 0 && present < 4) || (present == 4 && uneven(cell));
    }
    if (present < 4 || crossings.empty()) return false;
    if (crossings.size() > 2) return !thin_band(cell);
    const Crossing &p = crossings_[crossings[0]], &q = crossings_[crossings[1]];
    return p.boundary.kind != q.boundary.kind || one_side(cell);
  }

  // Two crossings of one kind on each of two sides, in a cell smaller than the grid's: a tongue, or the gap between
  // two, passes through.
  bool thin_band(const Cell& cell) const {
    if (width(cell) >= x_.units || height(cell) >= y_.units) return false;
    std::vector<std::size_t> all;
    for (const std::size_t e : cell.edges) {
      const std::size_t before = all.size();
      append_crossings(e, all);
      if (all.size() != before && all.size() != before + 2) return false;
    }
    const auto kind = [&](std::size_t c) { return crossings_[c].boundary.kind; };
    // A gap between two tongues has two kinds.
    return all.size() == 4 &&
           (nodes_[cell.corners[0]].unstable() ||
            std::all_of(all.begin(), all.end(), [&](std::size_t c) { return kind(c) == kind(all[0]); }));
  }

  // Both crossings on one side: the tip of a tongue.
  bool one_side(const Cell& cell) const {
    for (const std::size_t e : cell.edges) {
      std::vector<std::size_t> own;
      append_crossings(e, own);
      if (own.size() == 2) return true;
    }
    return false;
  }

  // Corners of different verdicts, growth that changes too much to be interpolated (2 % of the map's range), or that
  // may pass through zero inside.
  bool uneven(const Cell& cell) const {
    double low = HUGE_VAL, high = -HUGE_VAL, nearest = HUGE_VAL, bars = 0;
    const Verdict verdict = nodes_[cell.corners[0]].sample->stability.verdict;
    for (const std::size_t corner : cell.corners) {
      const Stability& s = nodes_[corner].sample->stability;
      if (s.verdict != verdict) return true;
      low = std::min(low, s.growth_rate);
      high = std::max(high, s.growth_rate);
      nearest = std::min(nearest, std::abs(s.growth_rate));
      bars += s.growth_error;
    }
    const double spread = high - low;
    return !(spread <= 0.02 * range_) || (spread > 10 * bars && nearest <= spread);
  }

  void halve_edge(std::size_t e) {
    if (edges_[e].halved) return;
    const Edge edge = edges_[e];
    const Node a = nodes_[edge.a], b = nodes_[edge.b];
    const std::size_t middle = edge.along_x ? add_node(middle_of(a.i, b.i), a.j) : add_node(a.i, middle_of(a.j, b.j));
    const double t = coordinate(middle, edge.along_x);
    std::array<std::size_t, 2> children = {add_edge(edge.a, middle, edge.along_x),
                                           add_edge(middle, edge.b, edge.along_x)};
    for (const std::size_t c : edge.crossings) {
      edges_[children[crossings_[c].boundary.x < t ? 0 : 1]].crossings.push_back(c);
    }
    set_beside(children[0], edge.before, edge.b);
    set_beside(children[1], edge.a, edge.after);
    // An edge without crossings was searched as a whole.
    new_edges_[new_edges_.size() - 2].search = new_edges_[new_edges_.size() - 1].search = !edge.crossings.empty();
    edges_[e].children = children;
    edges_[e].middle = middle;
    edges_[e].halved = true;
  }

  void halve(std::size_t c) {
    cells_[c].halved = true;
    const Cell cell = cells_[c];
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

  // Until no cell wants halving; a halved edge may change what the cell on its other side wants.
  void refine() {
    for (bool changed = true; changed;) {
      changed = false;
      const std::size_t count = cells_.size();
      for (std::size_t c = 0; c < count; ++c) {
        if (cells_[c].halved || !wants_halving(cells_[c])) continue;
        halve(c);
        changed = true;
      }
      evaluate();
    }
  }

  // Joins the crossings into chains; true if cells were halved because their chords are too coarse.
  bool refine_curves() {
    std::vector<std::size_t> crossed, unclear;
    std::vector<std::vector<std::size_t>> rims(cells_.size());
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      if (cells_[c].halved) continue;
      rims[c] = rim(cells_[c]);
      if (rims[c].size() >= 2 && rims[c].size() % 2 == 0) crossed.push_back(c);
      if (rims[c].size() > 2 && rims[c].size() % 2 == 0) unclear.push_back(c);
    }
    const std::vector<char> centre_unstable = results<char>(
        unclear.size(),
        [&](std::size_t k) -> char {
          const Cell& cell = cells_[unclear[k]];
          if (thin_band(cell)) return !nodes_[cell.corners[0]].unstable();
          const Node &low = nodes_[cell.corners[0]], &high = nodes_[cell.corners[2]];
          const auto s = sample(0.5 * (x_.at(low.i) + x_.at(high.i)), 0.5 * (y_.at(low.j) + y_.at(high.j)), leading_);
          return s && is_unstable(*s);
        },
        [](auto& visit, char& unstable) { visit_as_number(visit, unstable); });
    std::vector<CurveLink> links;
    std::size_t next_unclear = 0;
    for (const std::size_t c : crossed) {
      const std::vector<std::size_t>& r = rims[c];
      if (r.size() == 2) {
        links.push_back({{r[0], r[1]}, c});
        continue;
      }
      const bool start = nodes_[cells_[c].corners[0]].unstable();
      for (const auto& [p, q] : joined_in_cell(r.size(), start, centre_unstable[next_unclear])) {
        links.push_back({{r[p], r[q]}, c});
      }
      ++next_unclear;
    }
    chains_ = chains(crossings_.size(), links);

    std::vector<BoundaryPoint> scaled(crossings_.size());
    for (std::size_t k = 0; k < crossings_.size(); ++k) {
      const BoundaryPoint p = point(k);
      scaled[k] = {x_.scaled(p.x), y_.scaled(p.y), 0, p.along_x};
    }
    bool halved = false;
    for (const CurveChain& chain : chains_) {
      for (const std::size_t c : coarse_cells(chain, scaled, options_.sag)) {
        if (cells_[c].halved || width(cells_[c]) < 2 || height(cells_[c]) < 2) continue;
        halve(c);
        halved = true;
      }
    }
    evaluate();
    return halved;
  }

  BoundaryPoint point(std::size_t crossing) const {
    const Crossing& c = crossings_[crossing];
    const Edge& edge = edges_[c.edge];
    const Node& a = nodes_[edge.a];
    if (edge.along_x) return {c.boundary.x, y_.at(a.j), c.boundary.error, true};
    return {x_.at(a.i), c.boundary.x, c.boundary.error, false};
  }

  // Pieces of one kind.
  void add_curves(const CurveChain& chain, std::vector<BoundaryCurve>& curves) const {
    const std::size_t n = chain.points.size() - (chain.closed ? 1 : 0);
    const auto kind = [&](std::size_t k) { return crossings_[chain.points[k % n]].boundary.kind; };
    std::size_t start = 0;
    while (chain.closed && start < n && kind(start) == kind(start + n - 1)) ++start;
    if (start == n) start = 0;  // one kind all round
    BoundaryCurve curve;
    for (std::size_t k = start; k < start + n; ++k) {
      if (!curve.points.empty() && kind(k) != curve.kind) {
        curves.push_back(std::move(curve));
        curve = {};
      }
      curve.kind = kind(k);
      curve.points.push_back(point(chain.points[k % n]));
    }
    if (chain.closed && curve.points.size() == n) {
      curve.closed = true;
      curve.points.push_back(curve.points.front());
    }
    curves.push_back(std::move(curve));
  }

  static MapPoint known(const StabilitySample& sample) {
    const Stability& s = sample.stability;
    return {MapSource::evaluated,           sample.speed, s.growth_rate, s.growth_error, s.verdict,
            boundary_kind(s, sample.speed), s.converged};
  }

  // Values at the places that the caller gave: those of the nodes, and inside larger cells between the corners.
  void fill(StabilityMap& map) const {
    const std::size_t nx = x_.values.size(), ny = y_.values.size();
    map.points.assign(nx * ny, {});
    std::vector<bool> set(nx * ny, false);
    for (const Node& node : nodes_) {
      if (node.i % x_.units != 0 || node.j % y_.units != 0) continue;
      const std::size_t place =
          static_cast<std::size_t>(node.i / x_.units) + nx * static_cast<std::size_t>(node.j / y_.units);
      set[place] = true;
      if (node.sample) map.points[place] = known(*node.sample);
    }
    for (const Cell& cell : cells_) {
      if (cell.halved || (width(cell) <= x_.units && height(cell) <= y_.units)) continue;
      const Node &low = nodes_[cell.corners[0]], &high = nodes_[cell.corners[2]];
      std::array<MapPoint, 4> corner;
      for (std::size_t k = 0; k < 4; ++k) {
        if (const auto& s = nodes_[cell.corners[k]].sample) corner[k] = known(*s);
      }
      for (int j = (low.j + y_.units - 1) / y_.units; j * y_.units <= high.j; ++j) {
        for (int i = (low.i + x_.units - 1) / x_.units; i * x_.units <= high.i; ++i) {
          const std::size_t place = static_cast<std::size_t>(i) + nx * static_cast<std::size_t>(j);
          if (set[place]) continue;
          set[place] = true;
          const double u = static_cast<double>(i * x_.units - low.i) / (high.i - low.i);
          const double v = static_cast<double>(j * y_.units - low.j) / (high.j - low.j);
          const std::array<double, 4> weight = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
          MapPoint& point = map.points[place];
          if (corner[0].source == MapSource::missing) continue;
          point = corner[0];
          point.source = MapSource::interpolated;
          point.growth_error = std::numeric_limits<double>::quiet_NaN();
          point.growth_rate = point.speed = 0;
          for (std::size_t k = 0; k < 4; ++k) {
            point.growth_rate += weight[k] * corner[k].growth_rate;
            point.speed += weight[k] * corner[k].speed;
            point.converged = point.converged && corner[k].converged;
          }
        }
      }
    }
  }

  const MapSystemAt& at_;
  const Axis x_, y_;
  const MapOptions& options_;
  const bool grid_alone_;  // every point evaluated, nothing between them
  SweepOptions along_edges_;
  StabilityOptions at_nodes_, leading_;  // leading_: where the leading exponents suffice
  mutable std::atomic<std::size_t> samples_ = 0;
  std::vector<Node> nodes_;
  std::vector<Edge> edges_;
  std::vector<Cell> cells_;
  std::vector<Crossing> crossings_;
  std::vector<NewEdge> new_edges_;
  std::vector<CurveChain> chains_;
  std::size_t evaluated_nodes_ = 0;
  double range_ = 0;
};

}  // namespace

StabilityMap stability_map(const MapSystemAt& system, std::vector<double> x, std::vector<double> y,
                           const MapOptions& options) {
  const bool every_value = !options.curves_only && x.size() * y.size() <= options.evaluate_all;
  Axis along_x = make_axis(std::move(x), every_value, "x"), along_y = make_axis(std::move(y), every_value, "y");
  // Nothing between the places that were given where every one is evaluated and no curve is asked for.
  if (every_value && !options.boundaries)
    for (Axis* axis : {&along_x, &along_y}) axis->base = axis->units;
  Mesh mesh(system, std::move(along_x), std::move(along_y), every_value, options);
  mesh.build();
  return mesh.result();
}

}  // namespace hb
