// Verdicts and boundary curves of maps of random systems against single verdicts.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "hb/hb.hpp"
#include "lib/stop_wish.hpp"
#include "lib/stopwatch.hpp"
#include "tests/support/band_systems.hpp"
#include "tools/attack/case_flags.hpp"

namespace hb::attack {
namespace {

using stress::BandKind;
using stress::Random;

struct Options {
  int cases = 2;
  double seconds = HUGE_VAL;
  std::uint64_t seed = 1;
  std::string family;
};

constexpr std::array names = {"nearly-conservative", "undamped", "one-way", "gyroscopic", "partly-driven"};
constexpr std::array kinds = {BandKind::nearly_conservative, BandKind::undamped, BandKind::one_way,
                              BandKind::gyroscopic, BandKind::partly_driven};

struct Tally {
  int maps = 0, unfinished = 0, nodes = 0, wrong_nodes = 0, undecided = 0, curves = 0, curve_points = 0,
      wrong_curve_points = 0, edge_places = 0, wrong_edges = 0, inner_places = 0, wrong_inner = 0, listed = 0;
  double slowest = 0;

  void add(const Tally& t) {
    maps += t.maps;
    unfinished += t.unfinished;
    nodes += t.nodes;
    wrong_nodes += t.wrong_nodes;
    undecided += t.undecided;
    curves += t.curves;
    curve_points += t.curve_points;
    wrong_curve_points += t.wrong_curve_points;
    edge_places += t.edge_places;
    wrong_edges += t.wrong_edges;
    inner_places += t.inner_places;
    wrong_inner += t.wrong_inner;
    listed += t.listed;
    slowest = std::max(slowest, t.slowest);
  }
};

struct Point {
  double x = 0, y = 0;
};

// A system over its speed x and the strength y of what is periodic.
class Plane {
 public:
  Plane(HillSystem system, Point low, Point high) : system_(std::move(system)), low_(low), high_(high) {}

  HillSystem at(double strength) const {
    HillSystem changed = system_;
    FourierSeries& series = changed.stiffness[0];
    series.c.rightCols(series.c.cols() - 1) *= strength;
    return changed;
  }
  Verdict verdict(Point p) const {
    return analyse_stability(at(p.y), p.x, {.tolerance = 1e-10, .method = StabilityMethod::propagation}).verdict;
  }
  Point scaled(Point p) const { return {(p.x - low_.x) / (high_.x - low_.x), (p.y - low_.y) / (high_.y - low_.y)}; }

  const HillSystem system_;
  const Point low_, high_;
};

bool unstable(Verdict v) { return v == Verdict::unstable; }

double cross(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }
bool crosses(Point a, Point b, Point c, Point d) {
  return (cross(a, b, c) > 0) != (cross(a, b, d) > 0) && (cross(c, d, a) > 0) != (cross(c, d, b) > 0);
}
double distance(Point p, Point a, Point b) {
  const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
  const double t = square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0;
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

// All curves, in coordinates scaled to the map.
struct Curves {
  std::vector<std::array<Point, 2>> stretches;

  Curves(const StabilityMap& map, const Plane& plane) {
    for (const BoundaryCurve& curve : map.boundaries)
      for (std::size_t k = 0; k + 1 < curve.points.size(); ++k)
        stretches.push_back({plane.scaled({curve.points[k].x, curve.points[k].y}),
                             plane.scaled({curve.points[k + 1].x, curve.points[k + 1].y})});
  }
  int crossings(Point a, Point b) const {
    return int(std::ranges::count_if(stretches, [&](const auto& s) { return crosses(a, b, s[0], s[1]); }));
  }
  double nearest(Point p) const {
    double least = HUGE_VAL;
    for (const auto& s : stretches) least = std::min(least, distance(p, s[0], s[1]));
    return least;
  }
};

void check_nodes(const StabilityMap& map, const Plane& plane, const std::string& name, Tally& tally) {
  for (std::size_t j = 0; j < map.y.size(); ++j)
    for (std::size_t i = 0; i < map.x.size(); ++i) {
      const MapPoint& node = map.at(i, j);
      ++tally.nodes;
      const Verdict single = plane.verdict({map.x[i], map.y[j]});
      if (node.verdict == Verdict::undecided || single == Verdict::undecided) {
        ++tally.undecided;
        continue;
      }
      if (unstable(node.verdict) == unstable(single)) continue;
      ++tally.wrong_nodes;
      fmt::print("  NODE {}: {:.12g}, {:.12g} {}, alone {}\n", name, map.x[i], map.y[j], to_string(node.verdict),
                 to_string(single));
    }
}

// Within `reach` of a point of a curve both verdicts are met: beside it, or between where a band or a gap is narrower
// than that.
enum class Change { met, open, none };
Change change_within(const Plane& plane, const BoundaryPoint& p, double reach) {
  constexpr unsigned bits = 10;
  std::array<bool, 3> met{};  // stable, unstable, undecided
  for (unsigned k = 0; k <= 1u << bits; ++k) {  // one end, halves, quarters and so on between the two, the other end
    unsigned reversed = k >> bits << bits;
    for (unsigned bit = 0; bit < bits; ++bit) reversed |= (k >> bit & 1u) << (bits - 1 - bit);
    const double step = reach * (2.0 * reversed / (1u << bits) - 1);
    const Verdict v = plane.verdict(p.along_x ? Point{p.x + step, p.y} : Point{p.x, p.y + step});
    met[v == Verdict::undecided ? 2 : std::size_t(unstable(v))] = true;
    if (met[0] && met[1]) return Change::met;
  }
  return met[2] ? Change::open : Change::none;
}

// The verdict changes within twice the error of each point of a curve, or 1e-10 of its coordinate.
void check_curves(const StabilityMap& map, const Plane& plane, const std::string& name, Random& random, Tally& tally) {
  constexpr double part = 0.2;  // of the points
  for (const BoundaryCurve& curve : map.boundaries) {
    ++tally.curves;
    for (const BoundaryPoint& p : curve.points) {
      if (!random.chance(part)) continue;
      ++tally.curve_points;
      switch (change_within(plane, p, std::max(2 * p.error, 1e-10 * (p.along_x ? p.x : p.y)))) {
        case Change::met:
          break;
        case Change::open:
          ++tally.undecided;
          break;
        case Change::none:
          ++tally.wrong_curve_points;
          fmt::print("  CURVE {}: {:.12g}, {:.12g} along {} +/- {:.2g}, one verdict\n", name, p.x, p.y,
                     p.along_x ? "x" : "y", p.error);
      }
    }
  }
}

// From a node to a place the verdict changes as often as a curve is crossed; not so near a curve that its chord or a
// narrow band decides.
void check_places(const StabilityMap& map, const Plane& plane, const std::string& name, Random& random, Tally& tally) {
  constexpr double clear = 2e-3;
  const Curves curves(map, plane);
  for (std::size_t j = 0; j + 1 < map.y.size(); ++j)
    for (std::size_t i = 0; i + 1 < map.x.size(); ++i)
      for (const bool on_edge : {true, false}) {
        const double u = random(0, 1), v = random(0, 1);
        Point place{map.x[i] + u * (map.x[i + 1] - map.x[i]), map.y[j]};
        if (!on_edge) place.y += v * (map.y[j + 1] - map.y[j]);
        const Point from = plane.scaled({map.x[i], map.y[j]}), to = plane.scaled(place);
        if (map.at(i, j).verdict == Verdict::undecided || curves.nearest(to) < clear || curves.nearest(from) < 1e-6)
          continue;
        const bool open = std::ranges::any_of(map.not_excluded, [&](const auto& piece) {
          return distance(to, plane.scaled({piece[0], piece[1]}), plane.scaled({piece[2], piece[3]})) < clear;
        });
        const Verdict single = plane.verdict(place);
        if (single == Verdict::undecided) {
          ++tally.undecided;
          continue;
        }
        ++(on_edge ? tally.edge_places : tally.inner_places);
        const bool expected = unstable(map.at(i, j).verdict) != (curves.crossings(from, to) % 2 == 1);
        if (expected == unstable(single)) continue;
        if (open) {
          ++tally.listed;
          continue;
        }
        ++(on_edge ? tally.wrong_edges : tally.wrong_inner);
        fmt::print("  {} {}: {:.12g}, {:.12g} is {}, {} crossings from node {}, {}\n", on_edge ? "EDGE" : "INSIDE",
                   name, place.x, place.y, to_string(single), curves.crossings(from, to), i, j);
      }
}

// Given up after so many seconds.
Tally run_map(std::size_t kind, std::uint64_t number, double seconds) {
  constexpr double slow = 30;  // seconds
  Random random(number * 1000003 + kind * 7919 + 4);
  Tally tally;
  const HillSystem system = stress::band_system(kinds[kind], random);
  const double from = random(0.4, 1.5), to = from * random(1.2, 2.5), most = random.power(0, 0.7);
  const Plane plane(system, {from, 0.05 * most}, {to, most});
  const std::string name = fmt::format("{} {}", names[kind], number);
  MapRequest request;
  request.x = along("omega", from, to, std::size_t(random.integer(4, 9)));
  request.y = along("strength", 0.05 * most, most, std::size_t(random.integer(3, 6)));
  request.only = {.steady = false, .stability = true, .reactions = false, .shape = false};
  const SceneFamily family({{"strength", 1}}, [&plane](const auto& values) { return plane.at(values[0]); });
  const Stopwatch watch;
  const auto size = [&] { return fmt::format("{} x {}", request.x.values.size(), request.y.values.size()); };
  try {
    const StopWish limit([&] { return watch.seconds() > seconds; });
    const Map result = map(family, request);
    tally.slowest = watch.seconds();
    ++tally.maps;
    if (tally.slowest > slow) fmt::print("  SLOW {}: {}, {:.0f} s\n", name, size(), tally.slowest);
    const StabilityMap& rod = result.maps.front();
    check_nodes(rod, plane, name, tally);
    check_curves(rod, plane, name, random, tally);
    check_places(rod, plane, name, random, tally);
  } catch (const Stopped&) {
    ++tally.unfinished;
    fmt::print("  UNFINISHED {}: {} in {:.0f} s\n", name, size(), watch.seconds());
  }
  return tally;
}

int run(const Options& options) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // what was found is not lost with the rest
  constexpr double longest = 120;  // seconds for one map and its comparison
  const Stopwatch watch;
  std::vector<Tally> tallies(kinds.size());
  for (int k = 0; k < options.cases && watch.seconds() < options.seconds; ++k)
    for (std::size_t f = 0; f < kinds.size() && watch.seconds() < options.seconds; ++f)
      if (options.family.empty() || options.family == names[f])
        tallies[f].add(run_map(f, options.seed * 1000000 + std::uint64_t(k),
                               std::min(longest, options.seconds - watch.seconds())));
  fmt::print("maps, seed {}\n", options.seed);
  fmt::print("  {:<20} {:>5} {:>10} {:>6} {:>5} {:>7} {:>6} {:>5} {:>6} {:>5} {:>6} {:>5} {:>6} {:>9} {:>9}\n",
             "family", "maps", "unfinished", "nodes", "wrong", "curves", "points", "wrong", "edges", "wrong", "inside",
             "wrong", "listed", "undecided", "slowest");
  Tally all;
  const auto print = [](const char* name, const Tally& t) {
    fmt::print("  {:<20} {:>5} {:>10} {:>6} {:>5} {:>7} {:>6} {:>5} {:>6} {:>5} {:>6} {:>5} {:>6} {:>9} {:>7.1f} s\n",
               name, t.maps, t.unfinished, t.nodes, t.wrong_nodes, t.curves, t.curve_points, t.wrong_curve_points,
               t.edge_places, t.wrong_edges, t.inner_places, t.wrong_inner, t.listed, t.undecided, t.slowest);
  };
  for (std::size_t f = 0; f < kinds.size(); ++f) {
    if (tallies[f].maps + tallies[f].unfinished == 0) continue;
    print(names[f], tallies[f]);
    all.add(tallies[f]);
  }
  print("all", all);
  // Islands that no line of the grid meets may be missed inside.
  return all.wrong_nodes + all.wrong_curve_points + all.wrong_edges == 0 ? 0 : 1;
}

}  // namespace
}  // namespace hb::attack

int main(int argc, char** argv) {
  using namespace hb::attack;
  CLI::App app{"Maps of random systems against single verdicts"};
  Options options;
  add_case_flags(app, options, "of each family");
  app.add_option("--family", options.family, "this one only")
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
