#include "tools/pictures/map_plot.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "tools/output/map_theory_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/path_unit.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"

namespace hb::tools {
namespace {

// Blue where disturbances die out, white at zero, red where they grow; readable without colour vision.
constexpr const char* palette =
    "set palette defined (-1 '#2166ac', -0.5 '#67a9cf', -0.12 '#d1e5f0', 0 '#f7f7f7', 0.12 '#fddbc7', 0.5 '#ef8a62', "
    "1 '#b2182b')\n";

// "mm^4" as it is printed: mm⁴.
std::string raised_powers(std::string text) {
  for (const auto& [written, raised] : {std::pair("^2", "²"), {"^3", "³"}, {"^4", "⁴"}})
    for (std::size_t at = 0; (at = text.find(written, at)) != std::string::npos;) text.replace(at, 2, raised);
  return text;
}

std::string map_axis_label(const MapDocument& document, const PlaneAxis& axis) {
  if (axis.role == PlaneAxis::Role::rpm) return quoted("speed [rpm]");
  if (axis.role == PlaneAxis::Role::omega) return quoted("speed [rad/" + document.scene.units.time + "]");
  return quoted(axis.path + raised_powers(bracketed(path_unit(axis.path, document.scene.units))));
}

struct ColourScale {
  std::string value;  // gnuplot expression of columns 3 (growth), 4 (per turn)
  std::string label;
  double scale = 1;  // values up to about here are shown linearly, larger ones by their logarithm
  double largest = 1;
  // Where all points are of one verdict, stable or unstable: the values that there are, signed.
  std::optional<std::array<double, 2>> one_sided;
};

// The range of the values where the verdict is the same everywhere.
std::optional<std::array<double, 2>> one_sided_range(const MapDocument& document, bool per_turn) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const MapPoint& p : document.result.worst()) {
    if (p.source == MapSource::missing) continue;
    if (p.verdict != Verdict::stable && p.verdict != Verdict::unstable) return std::nullopt;
    const double value = per_turn ? growth_per_turn(p) : p.growth_rate;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(low <= high) || !(low * high > 0)) return std::nullopt;
  const double room = std::max(0.0, 0.01 * std::abs(low) - (high - low)) / 2;
  return std::array{low - room, high + room};
}

ColourScale colour_scale(const MapDocument& document, MapColour colour) {
  const std::string time = document.scene.units.time;
  const bool per_turn = colour == MapColour::per_turn;
  std::vector<double> sizes;
  for (const MapPoint& p : document.result.worst()) {
    if (p.source != MapSource::missing && std::isfinite(p.growth_rate))
      sizes.push_back(std::abs(per_turn ? growth_per_turn(p) : p.growth_rate));
  }
  ColourScale result;
  result.value = per_turn ? "$4" : "$3";
  result.label = per_turn                            ? "growth exponent per turn"
                 : colour == MapColour::tenfold_time ? "time to grow (above 0) or to fall tenfold [" + time + "]"
                                                     : "growth rate [1/" + time + "]";
  if (sizes.empty()) return result;
  std::sort(sizes.begin(), sizes.end());
  result.largest = sizes.back() > 0 ? sizes.back() : 1;
  // The median of what is not zero in sight of the largest.
  const auto first = std::upper_bound(sizes.begin(), sizes.end(), 1e-6 * result.largest);
  result.scale = first == sizes.end() ? result.largest : *(first + (sizes.end() - first) / 2);
  result.one_sided = one_sided_range(document, per_turn);
  if (result.one_sided && colour == MapColour::tenfold_time)
    result.label = std::string("time to ") + ((*result.one_sided)[1] < 0 ? "fall" : "grow") + " tenfold [" + time + "]";
  return result;
}

// 1, 2, 5, 10, ... within the scale, both signs, at places asinh(v/scale).
std::string ticks(const ColourScale& c, MapColour colour) {
  std::vector<double> values;
  const double top = std::floor(std::log10(c.largest));
  const double bottom = std::floor(std::log10(c.scale));
  const double first = std::min(bottom, top - 1);
  const bool dense = top - first <= 2;
  for (double e = first; e <= top; ++e) {
    for (const double m : {1.0, 2.0, 5.0}) {
      const double v = m * std::pow(10.0, e);
      if (v <= c.largest * 1.0001 && v >= 0.4 * c.scale && (dense || m == 1)) values.push_back(v);
    }
  }
  std::string text = "set cbtics (\"0\" 0";
  for (const double v : values) {
    const double place = std::asinh(v / c.scale);
    const std::string up =
        colour == MapColour::tenfold_time ? fmt::format("{:.3g}", std::log(10.0) / v) : fmt::format("{:g}", v);
    const std::string down = colour == MapColour::tenfold_time ? up : "−" + up;
    text += fmt::format(", \"{}\" {}, \"{}\" {}", up, place, down, -place);
  }
  return text + ")\n";
}

// What gnuplot colours by, and the bar beside it.
struct ColourBar {
  std::string value, settings;
};

// Of one sign: its half of the colours over the values that there are, those next to 0 light.
ColourBar one_sided_bar(const ColourScale& c, MapColour colour) {
  const auto [low, high] = *c.one_sided;
  ColourBar bar{c.value, fmt::format("set cbrange [{}:{}]\nset cbtics autofreq\n", low, high)};
  if (colour == MapColour::tenfold_time) {
    constexpr int most = 5;
    std::string places;
    for (int k = 0; k < most; ++k) {
      const double v = low + (high - low) * k / (most - 1);
      places += fmt::format("{}\"{:.3g}\" {}", k == 0 ? "" : ", ", std::log(10.0) / std::abs(v), v);
    }
    bar.settings += "set cbtics (" + places + ")\n";
  }
  bar.settings += high < 0 ? "set palette defined (0 '#2166ac', 0.5 '#67a9cf', 1 '#d1e5f0')\n"
                           : "set palette defined (0 '#fddbc7', 0.5 '#ef8a62', 1 '#b2182b')\n";
  return bar;
}

ColourBar colour_bar(const ColourScale& c, MapColour colour) {
  // Beyond this ratio of the values a linear scale shows the largest alone.
  constexpr double most_ratio = 20;
  if (c.one_sided) {
    const double a = std::abs((*c.one_sided)[0]), b = std::abs((*c.one_sided)[1]);
    if (std::max(a, b) < most_ratio * std::min(a, b)) return one_sided_bar(c, colour);
  }
  const double limit = std::asinh(c.largest / c.scale);
  return {fmt::format("asinh({}/{})", c.value, c.scale),
          fmt::format("set cbrange [{}:{}]\n", -limit, limit) + ticks(c, colour) + palette};
}

// Names of the lines where they leave the picture, or at their middle when that place is taken.
std::string line_labels(const MapResult& r) {
  const double x0 = r.x().front(), x1 = r.x().back(), y0 = r.y().front(), y1 = r.y().back();
  struct Placed {
    double u, v;
  };
  std::vector<Placed> taken;
  std::string text;
  for (const ResonanceLine& line : r.lines) {
    const auto longest = std::max_element(line.pieces.begin(), line.pieces.end(),
                                          [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (longest->size() < 4) continue;
    for (const double along : {0.96, 0.85, 0.7, 0.5, 0.3}) {
      // From the low end upward, whichever way the piece runs.
      const bool upward = longest->back()[1] >= longest->front()[1];
      const auto n = static_cast<std::size_t>((upward ? along : 1 - along) * static_cast<double>(longest->size() - 1));
      const double u = ((*longest)[n][0] - x0) / (x1 - x0), v = ((*longest)[n][1] - y0) / (y1 - y0);
      const bool free = u > 0.05 && u < 0.93 && v > 0.03 && v < 0.97 &&
                        std::none_of(taken.begin(), taken.end(), [&](const Placed& p) {
                          return std::abs(p.u - u) < 0.09 && std::abs(p.v - v) < 0.05;
                        });
      if (!free) continue;
      taken.push_back({u, v});
      text += fmt::format("set label '{}' at graph {:.4f},{:.4f} center front textcolor '#222222' font ',11' boxed\n",
                          line.name(true), u, v);
      break;
    }
  }
  return text;
}

}  // namespace

void name_axes(const MapDocument& document, Figure& figure) {
  figure.x_label = map_axis_label(document, document.result.x_axis);
  figure.y_label = map_axis_label(document, document.result.y_axis);
}

std::string map_axes(const MapDocument& document) {
  const MapResult& r = document.result;
  return fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\nset xlabel {}\nset ylabel {}\n", r.x().front(),
                     r.x().back(), r.y().front(), r.y().back(), map_axis_label(document, r.x_axis),
                     map_axis_label(document, r.y_axis));
}

std::vector<std::string> boundary_layers(const MapResult& r, const MapFiles& files) {
  std::vector<std::string> layers;
  struct Kind {
    BoundaryKind kind;
    int number;
    const char *colour, *title;
  };
  for (const Kind& kind : {Kind{BoundaryKind::minus_one, -1, "#000000", "boundary −1: period doubling"},
                           Kind{BoundaryKind::plus_one, 1, "#00735a", "boundary +1: once per turn"},
                           Kind{BoundaryKind::complex, 0, "#7b3294", "boundary, complex pair"}}) {
    const auto has = [&](const std::vector<RodCurve>& curves) {
      return std::any_of(curves.begin(), curves.end(), [&](const RodCurve& rc) { return rc.curve.kind == kind.kind; });
    };
    if (has(r.boundaries)) {
      layers.push_back(
          fmt::format("'{}' using ($3 == {} ? $4 : NaN):5 with lines linewidth 2.2 linecolor '{}' title '{}'",
                      files.boundaries, kind.number, kind.colour, kind.title));
    }
    for (std::size_t d = 0; d < r.band.size(); ++d) {
      if (!has(r.band[d].boundaries)) continue;
      layers.push_back(
          fmt::format("'{}' using ($3 == {} ? $4 : NaN):5 with lines linewidth 1.2 dashtype {} linecolor '{}' "
                      "title '{} at {} x {:g}'",
                      files.band[d], kind.number, d == 0 ? "(3,3)" : "(10,4)", kind.colour,
                      kind.number == 0   ? "complex"
                      : kind.number == 1 ? "+1"
                                         : "−1",
                      to_string(r.band_of), r.band[d].factor));
    }
  }
  return layers;
}

Figure map_figure(const MapDocument& document, const MapFiles& files, MapColour colour) {
  const MapResult& r = document.result;
  const ColourScale c = colour_scale(document, colour);
  const ColourBar bar = colour_bar(c, colour);
  Figure figure;
  figure.name = "map";
  name_axes(document, figure);
  figure.width = 1000;
  figure.height = 720;
  const std::string rods = std::holds_alternative<Linkage>(document.scene.model)
                               ? fmt::format(", {}{}", fmt::join(r.rods, ", "), r.rods.size() > 1 ? " (the worst)" : "")
                               : "";
  const bool some_missing = !r.missing.empty();
  const auto some = [&](Verdict verdict) {
    return std::any_of(r.worst().begin(), r.worst().end(),
                       [&](const MapPoint& p) { return p.source != MapSource::missing && p.verdict == verdict; });
  };
  figure.commands = fmt::format(
      "set title heading('{{/:Bold {}}}'.\"\\n\".{})\n{}set cblabel {} offset 0.8,0\n"
      "{}unset grid\nset border 15\nset tics out nomirror\n"
      "{}set key at screen 0.5, screen 0.015 center bottom vertical maxrows 3 Left reverse "
      "samplen 3 width -4 font ',12'\n"
      "set style textbox opaque noborder fillcolor '#f7f7f7' margins 0.4,0.3\n{}",
      literal(short_name(document.scene) + ", " + map_verdict(document)),
      quoted(map_theory_caption(document, rods) + (document.bounds ? "; growth, or a bound above it" : "")),
      map_axes(document), quoted(c.label), bar.settings, map_frame, line_labels(r));
  if (some_missing) {
    figure.commands +=
        "set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor '#8a8a8a' fillstyle solid noborder\n";
  }
  // Cell by cell, cut off at the frame; of large grids one image, whose half cells stand beyond it.
  constexpr std::size_t most_cells = 8000;
  const char* pixels = r.x().size() * r.y().size() <= most_cells ? " pixels" : "";
  std::vector<std::string> layers;
  // A layer of cells. In PNG the seams between them would show: there one image lies below, which SVG hides.
  const auto add_cells = [&](const std::string& columns, const std::string& value, const char* none,
                             const char* style) {
    if (*pixels != '\0')
      layers.push_back(fmt::format("'{}' using {}:(kind eq 'svg' ? {} : {}) with {} notitle", files.grid, columns, none,
                                   value, style));
    layers.push_back(fmt::format("'{}' using {}:({}) with {}{} notitle", files.grid, columns, value, style, pixels));
  };
  add_cells("1:2", bar.value, "NaN", "image");
  if (some(Verdict::bounded)) {
    add_cells("1:2:(190):(174):(212)", fmt::format("($6 == {} ? 255 : 0)", verdict_number(Verdict::bounded)), "0",
              "rgbalpha");
    layers.push_back("keyentry with points pointtype 5 pointsize 1.6 linecolor '#beaed4' title 'bounded: no damping'");
  }
  if (some(Verdict::undecided)) {
    layers.push_back(fmt::format("'{}' using 1:2:(150):(150):(150):($6 == 0 ? 110 : 0) with rgbalpha{} notitle",
                                 files.grid, pixels));
    layers.push_back("keyentry with points pointtype 5 pointsize 1.6 linecolor '#c6c6c6' title 'undecided'");
  }
  if (some_missing) {
    layers.push_back(
        "keyentry with points pointtype 5 pointsize 1.6 linecolor '#8a8a8a' title 'no system (does not close)'");
  }
  if (!r.lines.empty()) {
    layers.push_back(
        fmt::format("'{}' using 2:3 with lines linewidth 0.8 dashtype (6,6) linecolor '#444444' title "
                    "'resonance, speed = label'",
                    files.resonance));
  }
  if (!files.theory.empty()) {
    const std::size_t column = 4 + r.rods.size();
    const auto marks = [&](int beyond, const char* style, const char* title) {
      layers.push_back(fmt::format("'{}' using (${} == {} ? $1 : NaN):2 with points {} linecolor '#000000' title '{}'",
                                   files.theory, column, beyond, style, title));
    };
    if (std::ranges::any_of(r.theory, &TheoryPlace::beyond))
      marks(1, "pointtype 2 pointsize 0.9 linewidth 1.4", "beyond the linear theory");
    if (!std::ranges::all_of(r.theory, &TheoryPlace::beyond))
      marks(0, "pointtype 6 pointsize 0.7 linewidth 1", "within the linear theory");
  }
  for (std::string& layer : boundary_layers(r, files)) layers.push_back(std::move(layer));
  figure.commands += fmt::format("plot {}\n", fmt::join(layers, ", \\\n  "));
  figure.commands += map_clean_up;
  return figure;
}

}  // namespace hb::tools
