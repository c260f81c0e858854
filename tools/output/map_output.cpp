#include "tools/output/map_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "lib/constants.hpp"
#include "lib/scene/scene_keys.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/map_loads_output.hpp"
#include "tools/output/map_members.hpp"
#include "tools/output/map_theory_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/path_unit.hpp"
#include "tools/output/printable.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

// Texts of the grids, where one rod is all there are.
using KeptGrids = std::map<std::string, std::vector<std::string>>;
constexpr std::size_t most_points_kept = 1'000'000;  // some 80 bytes each

void add_grids(Members& json, const StabilityMap& map, const std::vector<MapPoint>& points, KeptGrids* kept) {
  const auto add = [&](const std::string& key, auto value) {
    if (kept)
      json.add_grid(key, map, points, value, (*kept)[key]);
    else
      json.add_grid(key, map, points, value);
  };
  add("growth_rate", [](const MapPoint& p) { return p.growth_rate; });
  add("verdict", [](const MapPoint& p) { return to_string(p.verdict); });
  add("kind", [](const MapPoint& p) { return to_string(p.kind); });
  add("growth_error", [](const MapPoint& p) { return p.growth_error; });
}

Json points_json(const BoundaryCurve& curve) {
  Json points = Json::array();
  for (const BoundaryPoint& p : curve.points) points.push_back(Json::array({p.x, p.y}));
  return points;
}

Json curve_json(const BoundaryCurve& curve) {
  double error = 0;
  for (const BoundaryPoint& p : curve.points) error = std::max(error, p.error);
  return {{"kind", to_string(curve.kind)}, {"closed", curve.closed}, {"error", error}, {"points", points_json(curve)}};
}

Json curves_json(const MapResult& result, const std::vector<RodCurve>& curves) {
  Json json = Json::array();
  for (const RodCurve& c : curves) {
    Json entry = curve_json(c.curve);
    entry["rod"] = result.rods[c.rod];
    json.push_back(std::move(entry));
  }
  return json;
}

Json axis_json(const PlaneAxis& axis, const std::vector<double>& values) {
  return {{"path", axis.path}, {"values", values}};
}

std::string comment_line(const MapDocument& document, const std::string& what) {
  const MapResult& r = document.result;
  return fmt::format("{}: {} over {} and {}", scene_name(document.scene), what, r.x_axis.path, r.y_axis.path);
}

struct NodeCounts {
  std::size_t stable = 0, bounded = 0, undecided = 0, unstable = 0, missing = 0, interpolated = 0, without_error = 0;

  std::size_t& of(Verdict verdict) {
    switch (verdict) {
      case Verdict::stable:
        return stable;
      case Verdict::bounded:
        return bounded;
      case Verdict::undecided:
        break;
      case Verdict::unstable:
        return unstable;
    }
    return undecided;
  }
};

NodeCounts counts(const std::vector<MapPoint>& points) {
  NodeCounts n;
  for (const MapPoint& p : points) {
    if (missing(p)) {
      ++n.missing;
      continue;
    }
    ++n.of(p.verdict);
    n.interpolated += p.source == MapSource::interpolated;
    n.without_error += p.source == MapSource::interpolated && std::isnan(p.growth_error);
  }
  return n;
}

// What is not all that a map can be.
std::vector<std::string> map_notes(const MapDocument& document, const NodeCounts& n) {
  std::vector<std::string> notes;
  if (!document.complete) {
    std::vector<const char*> lacking;
    if (n.missing > 0) lacking.push_back("points without an answer were not computed");
    if (document.boundaries) lacking.push_back("boundaries may be missing");
    notes.push_back(fmt::format("ended before the answer was complete{}{}", lacking.empty() ? "" : ": ",
                                fmt::join(lacking, ", and ")));
  }
  const MapResult& r = document.result;
  std::size_t pieces = 0;
  for (const StabilityMap& map : r.maps) pieces += map.not_excluded.size();
  if (pieces > 0)
    notes.push_back(fmt::format(
        "narrow bands or gaps are not excluded on {} of the lines between neighbouring points (not_excluded "
        "in the JSON)",
        pieces));
  if (n.without_error > 0)
    notes.push_back(
        fmt::format("growth at {} points is bilinear between computed ones of the same verdict, without an error",
                    n.without_error));
  const std::size_t missed = boundary_points_not_reached(r);
  if (missed == 0) return notes;
  double worst = 0;
  for (const StabilityMap& map : r.maps)
    for (const BoundaryCurve& curve : map.boundaries)
      for (const BoundaryPoint& p : curve.points)
        worst = std::max(worst, p.error / (p.along_x ? r.x().back() - r.x().front() : r.y().back() - r.y().front()));
  notes.push_back(fmt::format("{} boundary {} known less well than the others, to {:.1e} of the axis at worst", missed,
                              missed == 1 ? "point is" : "points are", worst));
  return notes;
}

// Of the scenes, then of the linear theory.
std::vector<std::string> map_warnings(const MapDocument& document) {
  std::vector<std::string> warnings = document.warnings;
  for (std::string& sentence : map_theory_warnings(document)) warnings.push_back(std::move(sentence));
  return warnings;
}

// "mm^4"; empty where the number has none, or its name is it.
std::string unit_name(const PlaneAxis& axis, const Units& units) {
  if (axis.role == PlaneAxis::Role::rpm) return "";
  return axis.role == PlaneAxis::Role::omega ? "rad/" + units.time : path_unit(axis.path, units);
}

std::string unit_behind(const PlaneAxis& axis, const Units& units) {
  const std::string unit = unit_name(axis, units);
  return unit.empty() ? "" : " " + unit;
}

}  // namespace

std::string place_words(const MapDocument& document, double x, double y) {
  const auto number = [&](const PlaneAxis& axis, double value) {
    return fmt::format("{} = {:.6g}{}", axis.path, value, unit_behind(axis, document.scene.units));
  };
  return number(document.result.x_axis, x) + ", " + number(document.result.y_axis, y);
}

double growth_per_turn(const MapPoint& point) { return point.growth_rate * 2 * std::numbers::pi / point.speed; }

double tenfold_time(const MapPoint& point) {
  return point.growth_rate > 0 ? std::numbers::ln10 / point.growth_rate : HUGE_VAL;
}

MapDocument document_of(const Map& map) {
  return {map,
          map.scene,
          map.num_modes,
          map.boundary_tolerance,
          map.settings.boundaries,
          map.complete,
          map.warnings,
          map.settings.only.verdict};
}

void write_map(const MapDocument& document, const TextSink& sink, int num_threads) {
  const MapResult& r = document.result;
  const StabilityMap& first = r.maps.front();
  const NodeCounts n = counts(r.worst());
  Members json;
  json.add("title", document.scene.title);
  json.add("status", document.complete ? "reached" : "tolerance not reached");
  if (const std::vector<std::string> notes = map_notes(document, n); !notes.empty()) json.add("notes", notes);
  if (const std::vector<std::string> warnings = map_warnings(document); !warnings.empty())
    json.add("warnings", warnings);
  json.add("x", axis_json(r.x_axis, r.x()));
  json.add("y", axis_json(r.y_axis, r.y()));
  json.add("modes", document.num_modes);
  if (document.boundaries) json.add("boundary_tolerance", document.tolerance);
  KeptGrids kept;
  KeptGrids* const same = r.rods.size() == 1 && r.worst().size() <= most_points_kept ? &kept : nullptr;
  add_grids(json, first, r.worst(), same);
  json.add_grid("interpolated", first, r.worst(),
                [](const MapPoint& p) { return p.source == MapSource::interpolated; });
  json.add_grid("growth_per_turn", first, r.worst(), growth_per_turn);
  if (document.boundaries) json.add("boundaries", curves_json(r, r.boundaries));
  Members rods;
  for (std::size_t k = 0; k < r.rods.size(); ++k) {
    Members rod;
    add_grids(rod, r.maps[k], r.maps[k].points, same);
    if (document.boundaries) {
      Json curves = Json::array();
      for (const BoundaryCurve& curve : r.maps[k].boundaries) curves.push_back(curve_json(curve));
      rod.add("boundaries", std::move(curves));
      rod.add("not_excluded", r.maps[k].not_excluded);
    }
    if (!r.loads.empty()) {
      Json loads = Json::object();
      add_loads(loads, r, k, document.scene.units);
      for (auto& [key, grid] : loads.items()) rod.add(key, std::move(grid));
    }
    rods.add(r.rods[k], rod);
  }
  json.add("rods", rods);
  if (!r.band.empty()) {
    Json ends = Json::array();
    for (const BandEnd& end : r.band) {
      ends.push_back({{"parameter", to_string(r.band_of)},
                      {"factor", end.factor},
                      {"boundaries", curves_json(r, end.boundaries)}});
    }
    json.add(r.band_of == BandParameter::damping ? "damping_range" : "band", std::move(ends));
  }
  Json lines = Json::array();
  for (const ResonanceLine& line : r.lines) lines.push_back({{"speed", line.name(false)}, {"pieces", line.pieces}});
  json.add("resonance_lines", std::move(lines));
  if (r.theory_judged) json.add("theory_sample", theory_sample_json(document));
  if (document.boundaries) json.add("boundary_points_not_reached", boundary_points_not_reached(r));
  json.add("counts", {{"stable", n.stable},
                      {"bounded", n.bounded},
                      {"unstable", n.unstable},
                      {"undecided", n.undecided},
                      {"missing", n.missing},
                      {"interpolated", n.interpolated}});
  Json none = Json::array();
  for (const MissingPoints& m : r.missing)
    none.push_back({{"count", m.count}, {"x", m.x}, {"y", m.y}, {"reason", m.message}});
  json.add("missing", std::move(none));
  json.add("units", units_json(document.scene.units));
  if (document.settings) {
    Json stats = Json::object();
    add_stats(stats, document.stages, *document.settings);
    for (auto& [key, value] : stats.items()) json.add(key, std::move(value));
  }
  TextPieces pieces(sink, num_threads);
  json.write(pieces);
  pieces.add("\n");
  pieces.hand_on();
}

std::string map_text(const MapDocument& document) {
  std::string text;
  write_map(document, [&](std::string_view piece) { text += piece; });
  return text;
}

Json map_json(const MapDocument& document) { return Json::parse(map_text(document)); }

namespace {

// Without its rows.
CsvFile map_grid_file(const MapDocument& document) {
  const MapResult& r = document.result;
  const std::string time = document.scene.units.time;
  CsvFile file;
  file.name = "map_grid.csv";
  file.comment = {comment_line(document, "growth rate, largest over the rods"),
                  std::string(verdict_numbers) + "; interpolated 1: inside a cell of one verdict; nan: no system"};
  if (document.bounds) file.comment.push_back(bounds_among_growth);
  file.columns = {
      r.x_axis.path, r.y_axis.path, "growth [1/" + time + "]", "growth per turn", "tenfold time [" + time + "]",
      "verdict",     "interpolated"};
  for (const std::string& rod : r.rods) file.columns.push_back("growth " + rod + " [1/" + time + "]");
  return file;
}

// Of the points from `first` on, as many as there are rows.
void fill_map_rows(const MapResult& r, std::size_t first, Eigen::MatrixXd& rows) {
  const std::size_t nx = r.x().size();
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const std::size_t p = first + static_cast<std::size_t>(row);
    const MapPoint& point = r.worst()[p];
    const bool none = missing(point);
    rows(row, 0) = r.x()[p % nx];
    rows(row, 1) = r.y()[p / nx];
    rows(row, 2) = none ? nan : point.growth_rate;
    rows(row, 3) = none ? nan : growth_per_turn(point);
    rows(row, 4) = none ? nan : tenfold_time(point);
    rows(row, 5) = none ? nan : verdict_number(point.verdict);
    rows(row, 6) = none ? nan : double(point.source == MapSource::interpolated);
    for (std::size_t k = 0; k < r.rods.size(); ++k)
      rows(row, static_cast<Eigen::Index>(7 + k)) = none ? nan : r.maps[k].points[p].growth_rate;
  }
}

}  // namespace

CsvFile map_grid_csv(const MapDocument& document) {
  CsvFile file = map_grid_file(document);
  file.rows.resize(static_cast<Eigen::Index>(document.result.worst().size()),
                   static_cast<Eigen::Index>(file.columns.size()));
  fill_map_rows(document.result, 0, file.rows);
  return file;
}

void write_map_grid(const MapDocument& document, const TextSink& sink) {
  const MapResult& r = document.result;
  CsvFile file = map_grid_file(document);
  sink(csv_text(file));
  file.rows.resize(static_cast<Eigen::Index>(r.x().size()), static_cast<Eigen::Index>(file.columns.size()));
  for (std::size_t first = 0; first < r.worst().size(); first += r.x().size()) {
    fill_map_rows(r, first, file.rows);
    sink(csv_rows(file.rows));
  }
}

CsvFile map_boundary_csv(const MapDocument& document, const std::vector<RodCurve>& curves, const std::string& name,
                         const std::string& what) {
  const MapResult& r = document.result;
  CsvFile file;
  file.name = name;
  file.comment = {comment_line(document, what), fmt::format("rods: {}", fmt::join(r.rods, ", ")),
                  "kind 1: +1, -1: period doubling, 0: complex; error: half of the bracket that is left"};
  file.columns = {"curve", "rod", "kind", r.x_axis.path, r.y_axis.path, "error"};
  std::size_t count = 0;
  for (const RodCurve& c : curves) count += c.curve.points.size() + 1;
  file.rows = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(count), 6, nan);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const BoundaryKind kind = curves[k].curve.kind;
    const double number = kind == BoundaryKind::plus_one ? 1 : kind == BoundaryKind::minus_one ? -1 : 0;
    for (const BoundaryPoint& p : curves[k].curve.points) {
      file.rows.row(row++) << double(k + 1), double(curves[k].rod + 1), number, p.x, p.y, p.error;
    }
    ++row;
  }
  return file;
}

CsvFile map_resonance_csv(const MapDocument& document) {
  const MapResult& r = document.result;
  CsvFile file;
  file.name = "map_resonance.csv";
  file.comment = {comment_line(document, "parametric resonance lines of the mean frequencies of " + r.rods.front())};
  std::size_t count = 0;
  for (std::size_t k = 0; k < r.lines.size(); ++k) {
    file.comment.push_back(fmt::format("line {}: speed = {}", k + 1, r.lines[k].name(false)));
    for (const auto& piece : r.lines[k].pieces) count += piece.size() + 1;
  }
  file.columns = {"line", r.x_axis.path, r.y_axis.path};
  file.rows = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(count), 3, nan);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < r.lines.size(); ++k) {
    for (const auto& piece : r.lines[k].pieces) {
      for (const auto& p : piece) file.rows.row(row++) << double(k + 1), p[0], p[1];
      ++row;
    }
  }
  return file;
}

namespace {

// Empty where all elastic links are looked at.
std::string alone(const MapDocument& document) {
  const std::vector<std::string>& rods = document.result.rods;
  const auto* linkage = std::get_if<Linkage>(&document.scene.model);
  if (!linkage || rods.size() == elastic_links(*linkage).size()) return "";
  return fmt::format("{} alone: ", fmt::join(rods, ", "));
}

std::string verdict_of_points(const MapDocument& document, const NodeCounts& n) {
  const MapResult& r = document.result;
  const double all = static_cast<double>(r.worst().size() - n.missing);
  if (all == 0) return document.complete ? "no system at any point" : "no answer yet at any point";
  std::vector<std::string> because;
  for (std::size_t k = 0; k < r.rods.size(); ++k) {
    const std::vector<MapPoint>& points = r.maps[k].points;
    if (std::any_of(points.begin(), points.end(),
                    [](const MapPoint& p) { return !missing(p) && p.verdict == Verdict::unstable; }))
      because.push_back(r.rods[k]);
  }
  if (n.unstable > 0)
    return fmt::format("UNSTABLE at {:.3g} % of the points{}", 100 * static_cast<double>(n.unstable) / all,
                       std::holds_alternative<Linkage>(document.scene.model)
                           ? fmt::format(" because of {}", fmt::join(because, ", "))
                           : "");
  if (n.undecided > 0)
    return fmt::format("undecided at {:.3g} % of the points", 100 * static_cast<double>(n.undecided) / all);
  const std::string which = (n.missing == 0      ? ""
                             : document.complete ? " that have a system"
                                                 : " that were computed") +
                            std::string(r.boundaries.empty() ? "" : ", UNSTABLE in between") +
                            (document.complete ? "" : "; unfinished");
  return (n.bounded == 0  ? "stable at all points"
          : n.stable == 0 ? "bounded at all points"
                          : "stable or bounded at all points") +
         which;
}

std::string boundary_rows(const MapDocument& document) {
  const MapResult& r = document.result;
  const Units& units = document.scene.units;
  if (!document.boundaries) return "  boundaries were not asked for\n";
  if (r.boundaries.empty()) return "  no stability boundary\n";
  std::string text = fmt::format("\n  boundaries, ranges of their points\n    {:<8} {:<8} {:>6}  {:>25}  {:>25}\n",
                                 "rod", "kind", "points", r.x_axis.path + bracketed(unit_name(r.x_axis, units)),
                                 r.y_axis.path + bracketed(unit_name(r.y_axis, units)));
  constexpr std::size_t most = 30;
  for (std::size_t k = 0; k < r.boundaries.size() && k < most; ++k) {
    const auto& points = r.boundaries[k].curve.points;
    const auto [x0, x1] = std::minmax_element(points.begin(), points.end(),
                                              [](const BoundaryPoint& a, const BoundaryPoint& b) { return a.x < b.x; });
    const auto [y0, y1] = std::minmax_element(points.begin(), points.end(),
                                              [](const BoundaryPoint& a, const BoundaryPoint& b) { return a.y < b.y; });
    text += fmt::format("    {:<8} {:<8} {:>6}  {:>25}  {:>25}\n", r.rods[r.boundaries[k].rod],
                        to_string(r.boundaries[k].curve.kind), points.size(),
                        fmt::format("{:.6g} ... {:.6g}", x0->x, x1->x), fmt::format("{:.6g} ... {:.6g}", y0->y, y1->y));
  }
  if (r.boundaries.size() > most) text += fmt::format("    ... {} more (--json has all)\n", r.boundaries.size() - most);
  return text;
}

}  // namespace

std::string map_verdict(const MapDocument& document) {
  return alone(document) + verdict_of_points(document, counts(document.result.worst()));
}

std::string map_summary(const MapDocument& document) {
  const MapResult& r = document.result;
  const NodeCounts n = counts(r.worst());
  const Units& units = document.scene.units;
  const double all = static_cast<double>(r.worst().size());
  const bool linkage = std::holds_alternative<Linkage>(document.scene.model);
  std::string text =
      fmt::format("{}: {}\n", scene_name(document.scene), alone(document) + verdict_of_points(document, n));
  const auto axis = [&](const PlaneAxis& of, const std::vector<double>& values) {
    return fmt::format("{} = {:.10g} ... {:.10g}{}, {} values", of.path, values.front(), values.back(),
                       unit_behind(of, units), values.size());
  };
  text += fmt::format("  x  {}\n  y  {}\n", axis(r.x_axis, r.x()), axis(r.y_axis, r.y()));
  text += linkage ? fmt::format("  rods {}, {} each\n\n", fmt::join(r.rods, ", "), counted(document.num_modes, "mode"))
                  : fmt::format("  {} {}\n\n", document.num_modes, document.num_modes == 1 ? "unknown" : "unknowns");
  text += fmt::format("  stable {:.4g} %, bounded {:.4g} %, unstable {:.4g} %, undecided {:.4g} %",
                      100 * static_cast<double>(n.stable) / all, 100 * static_cast<double>(n.bounded) / all,
                      100 * static_cast<double>(n.unstable) / all, 100 * static_cast<double>(n.undecided) / all);
  if (n.missing > 0)
    text += fmt::format(", {} {:.4g} %", document.complete ? "no system" : "not computed",
                        100 * static_cast<double>(n.missing) / all);
  text += fmt::format(" of {} points", r.worst().size());
  if (n.interpolated > 0) text += fmt::format(" ({} of them interpolated)", n.interpolated);
  text += "\n";
  const MapPoint* fastest = nullptr;
  for (const MapPoint& p : r.worst()) {
    if (!missing(p) && std::isfinite(p.growth_rate) && (fastest == nullptr || p.growth_rate > fastest->growth_rate))
      fastest = &p;
  }
  if (fastest != nullptr) {
    const auto place = static_cast<std::size_t>(fastest - r.worst().data());
    text += fmt::format("  largest growth {:.6g} 1/{} ({:.4g} per {}) at {}\n", fastest->growth_rate,
                        document.scene.units.time, growth_per_turn(*fastest), linkage ? "turn" : "period",
                        place_words(document, r.x()[place % r.x().size()], r.y()[place / r.x().size()]));
  }
  for (const MissingPoints& m : r.missing) {
    if (!document.complete) break;
    text += fmt::format("  no system at {}, the first at {}: {}\n", counted(m.count, "point"),
                        place_words(document, m.x, m.y), m.message);
  }
  text += map_theory_rows(document) + loads_rows(document);
  for (const std::string& note : map_notes(document, n))
    text += fmt::format("  {}: {}\n", document.complete ? "NOTE" : "NOT REACHED", note);
  text += boundary_rows(document);
  for (const std::string& warning : map_warnings(document))
    if (!warning.ends_with(not_judged)) text += fmt::format("WARNING: {}\n", warning);
  return text;
}

}  // namespace hb::tools
