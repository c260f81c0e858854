#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hb/analysis/theory_error.hpp"
#include "tools/output/map_loads_output.hpp"
#include "tools/output/output_units.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/map_plot.hpp"

namespace hb::tools {
namespace {

// Light to dark in equal steps of lightness, readable without colour vision and in grey.
constexpr const char* load_palette =
    "set palette defined (0 '#fcfdbf', 1 '#fec287', 2 '#fb8861', 3 '#e75263', 4 '#b5367a', 5 '#711f81', 6 '#2c115f')\n";
// Below 1 red, above blue, white at 1; of the safety's logarithm.
constexpr const char* safety_palette =
    "set palette defined (-1 '#b2182b', -0.4 '#ef8a62', -0.001 '#fddbc7', 0.001 '#d1e5f0', 0.5 '#67a9cf', 1 "
    "'#2166ac')\n";
constexpr double largest_safety = 10;  // colours end there

struct LoadRange {
  double low = HUGE_VAL, high = -HUGE_VAL;
};

// Of the places that the linear theory holds for: beside a resonance responses have no bound.
LoadRange stress_range(const MapResult& r, std::size_t rod, double megapascal) {
  LoadRange range;
  for (std::size_t p = 0; p < r.loads.size(); ++p) {
    if (!trusted_loads(r, p, rod) || !r.loads[p][rod].stress) continue;
    const double value = megapascal * r.loads[p][rod].stress->max_abs;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  return range;
}

Figure load_figure(const MapDocument& document, const MapFiles& files, const std::string& name, const std::string& rod,
                   const std::string& shown, const std::string& colours, const std::string& value,
                   const LoadColumns& columns) {
  const MapResult& r = document.result;
  Figure figure;
  figure.name = figure_name(name, rod);
  name_axes(document, figure);
  figure.width = 1000;
  figure.height = 720;
  figure.commands = fmt::format(
      "set title {}\n{}{}unset grid\nset border 15\nset tics out nomirror\n{}"
      "set key at screen 0.5, screen 0.015 center bottom vertical maxrows 3 Left reverse samplen 3 width "
      "-4 font ',12'\n"
      "set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor '#8a8a8a' fillstyle solid "
      "noborder\n",
      figure_title(document.scene, {rod, map_verdict(document)}, shown), map_axes(document), colours, map_frame);
  std::vector<std::string> layers = {
      fmt::format("'{}' using 1:2:(kind eq 'svg' ? NaN : {}) with image notitle", files.loads, value),
      fmt::format("'{}' using 1:2:({}) with image pixels notitle", files.loads, value)};
  const bool unstable = std::ranges::any_of(
      r.worst(), [](const MapPoint& p) { return p.source != MapSource::missing && p.verdict == Verdict::unstable; });
  if (unstable) {
    layers.push_back(
        fmt::format("'{}' using 1:2:(120):(120):(120):($6 == 1 ? 200 : 0) with rgbalpha pixels notitle", files.grid));
    layers.push_back(
        "keyentry with points pointtype 5 pointsize 1.6 linecolor '#8a8a8a' title 'unstable: this motion is not seen'");
  }
  if (columns.theory_error > 0) {
    layers.push_back(fmt::format(
        "'{0}' using (valid({1}) && !(valid({2}) && column({2}) <= {3}) ? $1 : NaN):2 with points pointtype "
        "7 pointsize 0.3 linecolor '#56b4e9' notitle",
        files.loads, columns.deflection, columns.theory_error, theory_error_limit));
    layers.push_back(
        "keyentry with points pointtype 7 pointsize 0.3 linecolor '#56b4e9' title 'dots: beyond the linear theory'");
  }
  for (std::string& layer : boundary_layers(r, files)) layers.push_back(std::move(layer));
  figure.commands += fmt::format("plot {}\n{}unset cblabel\n", fmt::join(layers, ", \\\n  "), map_clean_up);
  return figure;
}

}  // namespace

std::vector<Figure> load_figures(const MapDocument& document, const MapFiles& files) {
  const MapResult& r = document.result;
  const double megapascal = output_units(document.scene).megapascal;
  std::vector<Figure> figures;
  for (std::size_t rod = 0; rod < r.rods.size() && !files.loads.empty(); ++rod) {
    const LoadColumns columns = load_columns(r, rod);
    const LoadRange range = stress_range(r, rod, megapascal);
    if (columns.stress == 0 || !(range.low < range.high) || !(range.low > 0)) continue;
    // Logarithmic where it takes several powers of ten to show all.
    const bool wide = range.high > 30 * range.low;
    figures.push_back(
        load_figure(document, files, "map_stress", r.rods[rod], "largest stress, axial and bending together",
                    fmt::format("{}set cblabel 'largest stress [MPa]'\nset cbrange [{}:{}]\n{}set format cb '%g'\n"
                                "set cbtics auto\n",
                                load_palette, range.low, range.high, wide ? "set logscale cb\n" : ""),
                    fmt::format("${}", columns.stress), columns));
    const auto add_safety = [&](int column, const char* name, const char* against) {
      if (column == 0) return;
      figures.push_back(load_figure(
          document, files, name, r.rods[rod], fmt::format("safety against {}", against),
          fmt::format("{}set cblabel 'safety against {}'\nset cbrange [-1:1]\n"
                      "set cbtics (\"≤ 0.1\" -1, \"0.2\" log10(0.2), \"0.5\" log10(0.5), \"1\" 0, \"2\" log10(2), "
                      "\"5\" log10(5), \"≥ 10\" 1)\n",
                      safety_palette, against),
          fmt::format("${0} > {1} ? 1 : ${0} < {2} ? -1 : log10(${0})", column, largest_safety, 1 / largest_safety),
          columns));
    };
    add_safety(columns.yield_safety, "map_yield_safety", "yielding");
    add_safety(columns.fatigue_safety, "map_fatigue_safety", "fatigue");
  }
  return figures;
}

}  // namespace hb::tools
