#include "hb/engine/boundaries/stability_map.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "hb/engine/boundaries/finite_growth.hpp"
#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/map_ahead.hpp"
#include "hb/engine/boundaries/map_curves.hpp"
#include "hb/engine/boundaries/map_grid.hpp"
#include "hb/engine/boundaries/map_mesh.hpp"
#include "hb/engine/boundaries/separate_pair.hpp"
#include "hb/engine/boundaries/surface_grid.hpp"
#include "hb/engine/boundaries/surface_search.hpp"

namespace hb {

namespace {

template <class Visit>
void visit_curve_point(Visit& visit, CurvePoint& point) {
  visit(point.place.x);
  visit(point.place.y);
  visit(point.place.error);
  visit_as_number(visit, point.place.along_x);
  visit_as_number(visit, point.kind);
  visit_as_number(visit, point.unstable_above);
  visit_as_number(visit, point.converged);
}

class MapSearch {
 public:
  MapSearch(const MapSystemAt& at, MapAxis x, MapAxis y, bool every_value, const MapOptions& options)
      : at_(at),
        options_(options),
        every_value_(every_value),
        grid_alone_(every_value && !options.boundaries),
        mesh_(std::move(x), std::move(y)) {
    along_edges_ = options.search;
    constexpr double rough_tolerance = 1e-9;
    along_edges_.stability.tolerance = std::max(options.search.stability.tolerance, rough_tolerance);
    at_nodes_ = along_edges_.stability;
    at_nodes_.leading_only = grid_alone_;
    at_nodes_.verdict_only = grid_alone_ && options.verdict_only;
    along_curves_ = along_edges_;
    along_curves_.stability.leading_only = true;
    left_.nodes = distinct(mesh_.nodes().size(), [&](std::size_t n) { return place_of(mesh_.nodes()[n]); });
    if (!grid_alone_) left_.edges = distinct(mesh_.num_edges(), [&](std::size_t e) { return line_of(e); });
  }

  void sample() {
    find_surface();
    constexpr std::size_t one_of = 16, least = 12, most = 48;
    const std::size_t all = mesh_.num_edges(), count = std::min(all, std::clamp(all / one_of, least, most));
    if (grid_alone_ || surface_ || count == all) return;
    std::vector<std::size_t> edges;
    for (std::size_t k = 0; k < count; ++k) edges.push_back((2 * k + 1) * all / (2 * count));
    std::set<std::size_t> nodes;
    for (const std::size_t e : edges) {
      const MapEdge& edge = mesh_.edge(e);
      nodes.insert({edge.a, edge.b, edge.before, edge.after});
      for (const std::size_t n : mesh_.farther(e)) nodes.insert(n);
    }
    nodes.erase(no_node);
    evaluate_nodes({nodes.begin(), nodes.end()});
    std::erase_if(edges, [this](std::size_t e) { return !may_be_crossed(e); });
    std::vector<SearchedInterval> found = searched(edges, "edge");
    for (std::size_t k = 0; k < edges.size(); ++k) sampled_[edges[k]] = std::move(found[k]);
    left_.foresee_by(sampled_, options_.boundaries);
  }

  void begin() {
    find_surface();
    if (surface_alone()) return;
    evaluate_all_nodes();
  }

  void finish() {
    if (surface_ && !every_value_ && !options_.curves_only) evaluate_grid();
    if (grid_alone_ || surface_alone()) return;
    search_edges();
    growth_range();
    do refine();
    while (options_.boundaries && refine_curves());
    left_ = {};
  }

  PartsAhead left() const { return left_.parts(); }

  StabilityMap result() {
    StabilityMap map;
    if (!options_.curves_only) map.points = surface_ && !every_value_ ? std::move(points_) : map_grid(mesh_, samples_);
    if (options_.boundaries) {
      for (const CurveChain& chain : curves_.chains()) {
        const std::vector<CurvePoint> points = curves_.points(chain);
        std::ranges::move(pieces_of_one_kind(points, chain.closed), std::back_inserter(map.boundaries));
        map.not_converged += static_cast<std::size_t>(std::count_if(
            points.begin() + chain.closed, points.end(), [&](const CurvePoint& point) { return !reached(point); }));
      }
    }
    map.samples = num_samples_;
    map.not_excluded = std::move(not_excluded_);
    map.x = mesh_.x().values;
    map.y = mesh_.y().values;
    return map;
  }

 private:
  template <class Result, class Visit>
  std::vector<Result> results(std::size_t count, const std::function<Result(std::size_t)>& compute, const Visit& visit,
                              const std::string& kind = {}) const {
    return computed_parts<Result>(options_.parts, count, compute, visit, kind);
  }

  // Results of nodes or edges; along an axis on which the system does not depend those of one key have one.
  template <class Result, class Key, class Compute, class Visit>
  std::vector<Result> results_of(const std::vector<std::size_t>& things, const Key& key_of, const Compute& compute,
                                 const Visit& visit, const std::string& kind) const {
    if (!curves_bend()) return shared_parts<Result>(options_.parts, things, key_of, compute, visit, kind);
    return results<Result>(
        things.size(), [&](std::size_t k) { return compute(things[k]); }, visit, kind);
  }

  template <class Key>
  double distinct(std::size_t things, const Key& key_of) const {
    if (curves_bend()) return static_cast<double>(things);
    std::set<decltype(key_of(std::size_t{}))> keys;
    for (std::size_t k = 0; k < things; ++k) keys.insert(key_of(k));
    return static_cast<double>(keys.size());
  }

  // Error within ten times what was asked, or, where that is no less, within what searches promise.
  bool reached(const CurvePoint& point) const {
    const double within = 10 * options_.search.tolerance,
                 size = std::abs(point.place.along_x ? point.place.x : point.place.y);
    return point.place.error <= within * size || (point.converged && within >= 0.9 * promised_of_boundaries);
  }

  // --- One mode: the surface of its discriminant ---

  void find_surface() {
    if (surface_sought_ || grid_alone_ || at_nodes_.method != StabilityMethod::automatic) return;
    surface_sought_ = true;
    const std::vector<double>&x = mesh_.x().values, &y = mesh_.y().values;
    constexpr std::size_t least_evaluations = 4000, points_for_one = 3;
    const DiscriminantSurface::Request request{
        .box = {{x.front(), y.front()}, {x.back(), y.back()}},
        .varies = options_.varies,
        .most_evaluations = least_evaluations + x.size() * y.size() / points_for_one,
        .parts = options_.parts};
    surface_ = DiscriminantSurface::over([this](double u, double v) { return system(u, v); }, request);
  }

  // The grid is all that is asked for, and the surface tells it.
  bool surface_alone() const { return surface_ && !every_value_ && !options_.boundaries; }

  void evaluate_grid() {
    using Sample = std::optional<StabilitySample>;
    const std::vector<double>&x = mesh_.x().values, &y = mesh_.y().values;
    std::vector<std::size_t> open;
    points_ = surface_grid(*surface_, x, y, at_nodes_.tolerance, options_.for_each, open);
    const std::vector<Sample> samples = results<Sample>(
        open.size(), [&](std::size_t k) { return single_answer(x[open[k] % x.size()], y[open[k] / x.size()]); },
        [](auto& visit, Sample& sample) {
          visit_if_there(visit, sample, [&](StabilitySample& there) { visit_sample(visit, there); });
        });
    for (std::size_t k = 0; k < open.size(); ++k)
      if (samples[k]) points_[open[k]] = map_point(*samples[k]);
  }

  std::optional<StabilitySample> single_answer(double x, double y) const {
    const std::optional<ScaledSystem> there = system(x, y);
    if (!there) return std::nullopt;
    return StabilitySample{x, there->speed, with_finite_growth(*there, at_nodes_)};
  }

  std::optional<StabilitySample> sample_by_surface(double x, double y) const {
    if (!surface_ || every_value_) return std::nullopt;
    const MapPoint point = surface_point(*surface_, x, y, at_nodes_.tolerance);
    if (point.source == MapSource::missing) return std::nullopt;
    StabilitySample sample;
    sample.x = x;
    sample.speed = point.speed;
    sample.stability.growth_rate = point.growth_rate;
    sample.stability.growth_error = point.growth_error;
    sample.stability.verdict = point.verdict;
    return sample;
  }

  // Empty where the surface leaves something open, or says something else than the verdicts at both ends.
  std::optional<SearchedInterval> crossings_by_surface(const MapLine& line, bool unstable_first,
                                                       bool unstable_last) const {
    const auto zeros = surface_zeros(*surface_, line);
    if (!zeros) return std::nullopt;
    SearchedInterval found;
    bool inside = unstable_first;
    for (const SurfaceZero& zero : *zeros) {
      const auto boundary = boundary_at(*surface_, along(line), line, zero, options_.search.tolerance);
      if (!boundary || boundary->unstable_above == inside) return std::nullopt;
      if (!found.boundaries.empty() && !(found.boundaries.back().x < boundary->x)) return std::nullopt;
      inside = !inside;
      found.boundaries.push_back(*boundary);
    }
    if (inside != unstable_last) return std::nullopt;
    return found;
  }

  SystemAt along(const MapLine& line) const {
    return [this, line](double t) { return line.along_x ? system(t, line.fixed) : system(line.fixed, t); };
  }

  // --- What the system says ---

  std::optional<ScaledSystem> system(double x, double y) const {
    ++num_samples_;
    return at_(x, y);
  }

  // At a node all exponents, where the leading ones do not suffice to search its edges.
  std::optional<StabilitySample> node_sample(double x, double y) const {
    if (grid_alone_) return single_answer(x, y);
    const std::optional<ScaledSystem> there = system(x, y);
    if (!there) return std::nullopt;
    StabilityOptions leading = at_nodes_;
    leading.leading_only = true;
    StabilitySample sample = stability_sample(*there, x, leading);
    if (!is_apart(sample)) sample.stability = with_finite_growth(*there, at_nodes_);
    return sample;
  }

  bool unstable(std::size_t node) const { return samples_[node] && is_unstable(*samples_[node]); }

  // What is new after cells were halved.
  void evaluate() {
    evaluate_all_nodes();
    search_edges();
  }

  void evaluate_all_nodes() {
    evaluated_.resize(mesh_.nodes().size());
    std::vector<std::size_t> nodes;
    for (std::size_t node = 0; node < evaluated_.size(); ++node)
      if (!evaluated_[node]) nodes.push_back(node);
    evaluate_nodes(nodes);
  }

  void evaluate_nodes(const std::vector<std::size_t>& nodes) {
    using Sample = std::optional<StabilitySample>;
    left_.nodes = std::max(0.0, left_.nodes - static_cast<double>(nodes.size()));
    std::vector<Sample> samples = results_of<Sample>(
        nodes, [&](std::size_t node) { return place_of(mesh_.nodes()[node]); },
        [&](std::size_t node) {
          const double x = mesh_.x_of(node), y = mesh_.y_of(node);
          const Sample told = sample_by_surface(x, y);
          return told ? told : node_sample(x, y);
        },
        [](auto& visit, Sample& sample) {
          visit_if_there(visit, sample, [&](StabilitySample& there) { visit_sample(visit, there); });
        },
        "node");
    samples_.resize(mesh_.nodes().size());
    evaluated_.resize(mesh_.nodes().size());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      samples_[nodes[k]] = std::move(samples[k]);
      evaluated_[nodes[k]] = true;
    }
  }

  // Nodes of one place have one system.
  std::array<int, 2> place_of(const MapNode& node) const {
    return {options_.varies[0] ? node.i : 0, options_.varies[1] ? node.j : 0};
  }

  // Edges with one of these have one search.
  std::array<int, 6> line_of(std::size_t e) const {
    const MapEdge& edge = mesh_.edge(e);
    const auto at = [&](std::size_t node) {
      return node == no_node ? -1 : place_of(mesh_.nodes()[node])[edge.along_x ? 0 : 1];
    };
    const int fixed = place_of(mesh_.nodes()[edge.a])[edge.along_x ? 1 : 0];
    return {edge.along_x, fixed, at(edge.a), at(edge.b), at(edge.before), at(edge.after)};
  }

  void search_edges() {
    std::vector<std::size_t> edges;
    for (std::size_t e = searched_edges_; e < mesh_.num_edges(); ++e)
      if (may_be_crossed(e)) edges.push_back(e);
    const bool first = searched_edges_ == 0;
    searched_edges_ = mesh_.num_edges();
    left_.edges = 0;
    const std::vector<SearchedInterval> found = searched(edges, first ? "edge" : "halved edge");
    for (std::size_t k = 0; k < found.size(); ++k) {
      mesh_.set_crossings(edges[k], found[k].boundaries);
      for (const auto& [from, to] : found[k].not_excluded) not_excluded_.push_back(piece_of(edges[k], from, to));
    }
  }

  std::vector<SearchedInterval> searched(const std::vector<std::size_t>& edges, const std::string& kind) const {
    return results_of<SearchedInterval>(
        edges, [&](std::size_t e) { return line_of(e); },
        [&](std::size_t e) {
          const auto sampled = sampled_.find(e);
          return sampled == sampled_.end() ? crossings_of(e) : sampled->second;
        },
        [](auto& visit, SearchedInterval& crossings) { visit_interval(visit, crossings); }, kind);
  }

  // Not where the crossings that the edge has from its parent agree with the verdicts at its ends.
  bool may_be_crossed(std::size_t e) const {
    const MapEdge& edge = mesh_.edge(e);
    if (!samples_[edge.a] || !samples_[edge.b]) return false;
    const bool changes = unstable(edge.a) != unstable(edge.b), odd = edge.crossings.size() % 2 == 1;
    return changes != odd || (edge.crossings.empty() && !mesh_.searched_as_a_whole(e));
  }

  SearchedInterval crossings_of(std::size_t e) const {
    const MapEdge& edge = mesh_.edge(e);
    if (!options_.varies[edge.along_x ? 0 : 1]) return {};
    const MapLine line{edge.along_x, mesh_.coordinate(edge.a, !edge.along_x), mesh_.coordinate(edge.a, edge.along_x),
                       mesh_.coordinate(edge.b, edge.along_x)};
    if (surface_)
      if (auto found = crossings_by_surface(line, unstable(edge.a), unstable(edge.b))) return *found;
    const auto sample_at = [&](std::size_t node) {
      std::optional<StabilitySample> sample;
      if (node == no_node) return sample;
      const double t = mesh_.coordinate(node, edge.along_x);
      // What the surface told has no exponents.
      sample =
          surface_ && !every_value_ && samples_[node] ? stability_sample(along(line), t, at_nodes_) : samples_[node];
      if (sample) sample->x = t;
      return sample;
    };
    const auto before = sample_at(edge.before), first = sample_at(edge.a), last = sample_at(edge.b),
               after = sample_at(edge.after);
    if (!first || !last) return {};
    std::vector<StabilitySample> farther;
    for (const std::size_t node : surface_ ? std::vector<std::size_t>() : mesh_.farther(e))
      if (auto sample = sample_at(node)) farther.push_back(*std::move(sample));
    SearchedInterval found = search_interval(along(line), *first, *last, before ? &*before : nullptr,
                                             after ? &*after : nullptr, along_edges_, farther);
    found.samples.clear();
    return found;
  }

  std::array<double, 4> piece_of(std::size_t e, double from, double to) const {
    const MapEdge& edge = mesh_.edge(e);
    const double fixed = mesh_.coordinate(edge.a, !edge.along_x);
    if (edge.along_x) return {from, fixed, to, fixed};
    return {fixed, from, fixed, to};
  }

  // --- The quadtree ---

  void growth_range() {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const auto& sample : samples_) {
      if (!sample) continue;
      low = std::min(low, sample->stability.growth_rate);
      high = std::max(high, sample->stability.growth_rate);
    }
    range_ = high > low ? high - low : 0;
  }

  bool larger_than_the_grid(const MapCell& cell) const {
    return mesh_.width(cell) > mesh_.x().units || mesh_.height(cell) > mesh_.y().units;
  }

  bool wants_halving(std::size_t c) const {
    const MapCell& cell = mesh_.cells()[c];
    if (!mesh_.divisible(cell)) return false;
    const auto present = std::ranges::count_if(cell.corners, [&](std::size_t n) { return samples_[n].has_value(); });
    const std::size_t crossings = mesh_.rim(cell).size();
    if (larger_than_the_grid(cell)) {
      if (surface_ || options_.curves_only)
        return (crossings != 0 && crossings != 2) || mesh_.holds_tip(cell) || holds_island(c, crossings);
      return crossings != 0 || (present > 0 && present < 4) || (present == 4 && uneven(cell));
    }
    return present == 4 && (crossings > 2 ? !thin_band(cell) : mesh_.holds_tip(cell));
  }

  // No curve crosses the rim, but one may lie inside.
  bool holds_island(std::size_t c, std::size_t crossings) const {
    if (!surface_ || crossings != 0 || c < islands_sought_) return false;
    const MapCell& cell = mesh_.cells()[c];
    return verdict_may_change(*surface_, {{mesh_.x_of(cell.corners[0]), mesh_.y_of(cell.corners[0])},
                                          {mesh_.x_of(cell.corners[2]), mesh_.y_of(cell.corners[2])}});
  }

  // Two crossings of one kind on each of two sides: a tongue, or the gap between two, passes through. Points on both
  // sides of it confirm that (MapCurves::coarse_stretches).
  bool thin_band(const MapCell& cell) const {
    std::vector<std::size_t> all;
    for (const std::size_t e : cell.edges) {
      const std::vector<std::size_t> own = mesh_.crossings_along(e);
      if (!own.empty() && own.size() != 2) return false;
      all.insert(all.end(), own.begin(), own.end());
    }
    const auto kind = [&](std::size_t c) { return mesh_.crossings()[c].boundary.kind; };
    // A gap between two tongues has two kinds.
    return all.size() == 4 && (unstable(cell.corners[0]) ||
                               std::ranges::all_of(all, [&](std::size_t c) { return kind(c) == kind(all[0]); }));
  }

  // Corners of different verdicts, growth that changes too much to be interpolated (2 % of the map's range), or that
  // may pass through zero inside.
  bool uneven(const MapCell& cell) const {
    double low = HUGE_VAL, high = -HUGE_VAL, nearest = HUGE_VAL, bars = 0;
    const Verdict verdict = samples_[cell.corners[0]]->stability.verdict;
    for (const std::size_t corner : cell.corners) {
      const Stability& s = samples_[corner]->stability;
      if (s.verdict != verdict) return true;
      low = std::min(low, s.growth_rate);
      high = std::max(high, s.growth_rate);
      nearest = std::min(nearest, std::abs(s.growth_rate));
      bars += s.growth_error;
    }
    const double spread = high - low;
    return !(spread <= 0.02 * range_) || (spread > 10 * bars && nearest <= spread);
  }

  // Until no cell wants halving; a halved edge may change what the cell on its other side wants.
  void refine() {
    for (bool changed = true; changed;) {
      changed = false;
      double halvings = 0;
      const std::size_t count = mesh_.cells().size();
      for (std::size_t c = 0; c < count; ++c) {
        const MapCell& cell = mesh_.cells()[c];
        if (cell.halved || !wants_halving(c)) continue;
        constexpr double most = 1.5;
        halvings += std::min(most, std::log2(std::min(mesh_.width(cell), mesh_.height(cell))) - 1);
        mesh_.halve(c);
        changed = true;
      }
      islands_sought_ = count;
      left_.foresee_by(halvings, mesh_.crossings().size(), options_.boundaries);
      evaluate();
    }
  }

  // --- Curves ---

  // Joins the crossings into chains and puts points between them until their chords are straight. True if cells were
  // halved instead, where no point was found.
  bool refine_curves() {
    curves_.join([this](std::size_t node) { return unstable(node); },
                 [this](const std::vector<std::size_t>& cells) {
                   return results<char>(
                       cells.size(), [&](std::size_t k) -> char { return unstable_centre(mesh_.cells()[cells[k]]); },
                       [](auto& visit, char& unstable) { visit_as_number(visit, unstable); });
                 });
    for (;;) {
      if (halve(curves_.cells_with_turns())) return true;
      const std::vector<WantedPoint> wanted = curves_.coarse_stretches();
      if (wanted.empty()) return false;
      left_.points = 0.5 * static_cast<double>(wanted.size());  // of chords that are not straight yet
      left_.after_edges = 0;
      using Found = std::optional<CurvePoint>;
      const std::vector<Found> found = results<Found>(
          wanted.size(),
          [&](std::size_t k) {
            const MapSystemAt counted = [this](double x, double y) { return system(x, y); };
            return point_between(counted, wanted[k].stretch, wide(), high(), along_curves_,
                                 surface_ ? &*surface_ : nullptr);
          },
          [](auto& visit, Found& point) {
            visit_if_there(visit, point, [&](CurvePoint& there) { visit_curve_point(visit, there); });
          },
          "curve point");
      left_.points = 0;
      if (halve(curves_.insert(wanted, found))) return true;
    }
  }

  bool halve(const std::set<std::size_t>& cells) {
    if (cells.empty()) return false;
    for (const std::size_t c : cells) mesh_.halve(c);
    curves_.forget(cells);
    evaluate();
    return true;
  }

  bool unstable_centre(const MapCell& cell) const {
    if (thin_band(cell)) return !unstable(cell.corners[0]);
    const double x = 0.5 * (mesh_.x_of(cell.corners[0]) + mesh_.x_of(cell.corners[2]));
    const double y = 0.5 * (mesh_.y_of(cell.corners[0]) + mesh_.y_of(cell.corners[2]));
    const std::optional<ScaledSystem> there = system(x, y);
    return there && with_certain_verdict(*there, along_curves_.stability).verdict == Verdict::unstable;
  }

  bool curves_bend() const { return options_.varies[0] && options_.varies[1]; }
  double wide() const { return mesh_.x().values.back() - mesh_.x().values.front(); }
  double high() const { return mesh_.y().values.back() - mesh_.y().values.front(); }
  const MapSystemAt at_;
  const MapOptions options_;
  const bool every_value_;  // each point of the grid is a node
  const bool grid_alone_;  // every point evaluated, nothing between them
  SweepOptions along_edges_, along_curves_;  // along_curves_: the leading exponents suffice
  StabilityOptions at_nodes_;
  mutable std::atomic<std::size_t> num_samples_ = 0;
  MapMesh mesh_;
  MapCurves curves_{mesh_, options_.sag, curves_bend()};
  std::vector<std::optional<StabilitySample>> samples_;  // by node
  std::vector<bool> evaluated_;  // by node
  std::map<std::size_t, SearchedInterval> sampled_;  // by edge: those of sample()
  MapAhead left_;
  bool surface_sought_ = false;
  std::optional<DiscriminantSurface> surface_;
  std::vector<MapPoint> points_;  // of the grid, by the surface
  std::size_t searched_edges_ = 0, islands_sought_ = 0;
  std::vector<std::array<double, 4>> not_excluded_;
  double range_ = 0;
};

}  // namespace

namespace {

// Between points of one mode the discriminant tells; of several, looking there costs as much as some 100 000 points.
bool evaluates_all(const MapSystemAt& system, const std::vector<double>& x, const std::vector<double>& y,
                   const MapOptions& options) {
  const std::size_t count = x.size() * y.size();
  if (options.curves_only || count > std::max(options.evaluate_all, options.evaluate_all_alone)) return false;
  if (count <= options.evaluate_all) return true;
  if (options.boundaries) return false;
  for (const double u : {x.front(), x.back()})
    for (const double v : {y.front(), y.back()})
      if (const std::optional<ScaledSystem> corner = system(u, v)) return corner->num_modes() > 1;
  return false;
}

}  // namespace

StabilityMapSearch stability_map_search(const MapSystemAt& system, std::vector<double> x, std::vector<double> y,
                                        const MapOptions& options) {
  const bool every_value = evaluates_all(system, x, y, options);
  MapAxis along_x = make_map_axis(std::move(x), every_value, "x"),
          along_y = make_map_axis(std::move(y), every_value, "y");
  // Nothing between the places that were given where every one is evaluated and no curve is asked for.
  if (every_value && !options.boundaries)
    for (MapAxis* axis : {&along_x, &along_y}) axis->base = axis->units;
  const auto search = std::make_shared<MapSearch>(system, std::move(along_x), std::move(along_y), every_value, options);
  return {[search] { search->sample(); }, [search] { search->begin(); }, [search] { search->finish(); },
          [search] { return search->result(); }, [search] { return search->left(); }};
}

StabilityMap stability_map(const MapSystemAt& system, std::vector<double> x, std::vector<double> y,
                           const MapOptions& options) {
  const StabilityMapSearch search = stability_map_search(system, std::move(x), std::move(y), options);
  search.begin();
  search.finish();
  return search.result();
}

}  // namespace hb
