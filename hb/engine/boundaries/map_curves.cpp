#include "hb/engine/boundaries/map_curves.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hb {

namespace {

// Stretches of a curve shorter than this part of the map are not divided.
constexpr double shortest_stretch = 1.0 / 8192;

}  // namespace

CurvePoint MapCurves::crossing(std::size_t k) const {
  const MapCrossing& c = mesh_.crossings()[k];
  const MapEdge& edge = mesh_.edge(c.edge);
  const double fixed = mesh_.coordinate(edge.a, !edge.along_x), found = c.boundary.x;
  const BoundaryPoint place{edge.along_x ? found : fixed, edge.along_x ? fixed : found, c.boundary.error, edge.along_x};
  return {place, c.boundary.kind, c.boundary.unstable_above, c.boundary.converged};
}

BoundaryPoint MapCurves::scaled(const CurvePoint& point) const {
  return {mesh_.x().scaled(point.place.x), mesh_.y().scaled(point.place.y), 0, point.place.along_x};
}

void MapCurves::join(const UnstableNode& unstable, const UnstableCentres& unstable_centres) {
  std::vector<std::size_t> crossed, unclear;
  std::vector<std::vector<std::size_t>> rims(mesh_.cells().size());
  for (std::size_t c = 0; c < rims.size(); ++c) {
    if (mesh_.cells()[c].halved) continue;
    rims[c] = mesh_.rim(mesh_.cells()[c]);
    if (rims[c].size() >= 2 && rims[c].size() % 2 == 0) crossed.push_back(c);
    if (rims[c].size() > 2 && rims[c].size() % 2 == 0) unclear.push_back(c);
  }
  const std::vector<char> centre_unstable = unstable_centres(unclear);
  std::vector<CurveLink> links;
  std::size_t next_unclear = 0;
  for (const std::size_t c : crossed) {
    const std::vector<std::size_t>& r = rims[c];
    if (r.size() == 2) {
      links.push_back({{r[0], r[1]}, c});
      continue;
    }
    const bool start = unstable(mesh_.cells()[c].corners[0]);
    for (const auto& [p, q] : joined_in_cell(r.size(), start, centre_unstable[next_unclear]))
      links.push_back({{r[p], r[q]}, c});
    ++next_unclear;
  }
  unclear_ = {unclear.begin(), unclear.end()};
  chains_ = hb::chains(mesh_.crossings().size(), links);
}

MapCurves::Curve MapCurves::curve(const CurveChain& chain) const {
  Curve curve;
  curve.points.push_back(crossing(chain.points[0]));
  for (std::size_t k = 0; k < chain.cells.size(); ++k) {
    const std::size_t a = chain.points[k], b = chain.points[k + 1];
    const MapLink link{chain.cells[k], std::min(a, b), std::max(a, b)};
    std::vector<CurvePoint> between;
    if (const auto it = inserted_.find(link); it != inserted_.end()) between = it->second;
    if (a > b) std::ranges::reverse(between);
    for (std::size_t p = 0; p <= between.size(); ++p) curve.stretches.push_back({link, a > b ? between.size() - p : p});
    std::ranges::copy(between, std::back_inserter(curve.points));
    curve.points.push_back(crossing(b));
  }
  return curve;
}

std::set<std::size_t> MapCurves::cells_with_turns() const {
  std::set<std::size_t> cells;
  for (const CurveChain& chain : chains_) {
    const Curve c = curve(chain);
    const std::size_t n = c.stretches.size();
    const auto turns_back = [&](std::size_t before, std::size_t after) {
      const auto along = [&](std::size_t k, auto coordinate) {
        return scaled(c.points[k + 1]).*coordinate - scaled(c.points[k]).*coordinate;
      };
      return along(before, &BoundaryPoint::x) * along(after, &BoundaryPoint::x) +
                 along(before, &BoundaryPoint::y) * along(after, &BoundaryPoint::y) <
             0;
    };
    for (std::size_t from = 0, to = 0; from < n; from = to) {
      while (to < n && c.stretches[to].first == c.stretches[from].first) ++to;
      const std::size_t cell = c.stretches[from].first.cell;
      const std::size_t before = from > 0 || chain.closed ? (from + n - 1) % n : from;
      const std::size_t after = to < n || chain.closed ? to % n : to - 1;
      if (mesh_.divisible(mesh_.cells()[cell]) && turns_back(before, after)) cells.insert(cell);
    }
  }
  return cells;
}

std::vector<WantedPoint> MapCurves::coarse_stretches() const {
  std::vector<WantedPoint> wanted;
  for (const CurveChain& chain : chains_) {
    const Curve c = curve(chain);
    std::vector<BoundaryPoint> places;
    for (const CurvePoint& point : c.points) places.push_back(scaled(point));
    std::vector<bool> coarse = coarse_chords(places, chain.closed, sag_);
    for (std::size_t k = 0; k < c.stretches.size(); ++k) {
      const auto& [link, position] = c.stretches[k];
      const bool changes_kind = c.points[k].kind != c.points[k + 1].kind;
      const bool unconfirmed = unclear_.contains(link.cell) && !inserted_.contains(link) && bend_;
      if (closed_.contains(link) || !(coarse[k] || changes_kind || unconfirmed)) continue;
      if (std::hypot(places[k + 1].x - places[k].x, places[k + 1].y - places[k].y) < shortest_stretch) continue;
      wanted.push_back({link, position, stretch(c, k, chain.closed)});
    }
  }
  return wanted;
}

CurveStretch MapCurves::stretch(const Curve& c, std::size_t k, bool closed) const {
  const std::size_t n = c.stretches.size();
  const MapCell& cell = mesh_.cells()[c.stretches[k].first.cell];
  CurveStretch s{{},
                 {},
                 c.points[k],
                 c.points[k + 1],
                 mesh_.x_of(cell.corners[0]),
                 mesh_.x_of(cell.corners[2]),
                 mesh_.y_of(cell.corners[0]),
                 mesh_.y_of(cell.corners[2])};
  s.crowded = unclear_.contains(c.stretches[k].first.cell);
  if (k > 0 || closed) s.before = c.points[k > 0 ? k - 1 : n - 1];
  if (k + 1 < n || closed) s.after = c.points[k + 1 < n ? k + 2 : 1];
  return s;
}

// From the back, so that positions stay what they are.
std::set<std::size_t> MapCurves::insert(const std::vector<WantedPoint>& wanted,
                                        const std::vector<std::optional<CurvePoint>>& found) {
  std::map<MapLink, std::map<std::size_t, CurvePoint, std::greater<>>> new_points;
  std::set<std::size_t> cells;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const MapLink& link = wanted[k].link;
    if (found[k]) {
      new_points[link].emplace(wanted[k].position, *found[k]);
    } else if (mesh_.divisible(mesh_.cells()[link.cell])) {
      cells.insert(link.cell);
    } else {
      closed_.insert(link);
    }
  }
  for (const auto& [link, points] : new_points) {
    std::vector<CurvePoint>& all = inserted_[link];
    for (const auto& [position, point] : points) all.insert(all.begin() + static_cast<std::ptrdiff_t>(position), point);
  }
  return cells;
}

void MapCurves::forget(const std::set<std::size_t>& cells) {
  std::erase_if(inserted_, [&](const auto& link) { return cells.contains(link.first.cell); });
}

}  // namespace hb
