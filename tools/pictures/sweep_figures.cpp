#include "tools/pictures/sweep_figures.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "tools/output/output_folder.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/path_unit.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/sweep_frame.hpp"
#include "tools/pictures/sweep_range.hpp"

namespace hb::tools {
namespace {

// Of the order lines drawn: those at which a peak was found, and a few in any case.
int highest_order(const SweepResult& result, std::size_t r) {
  constexpr int fewest = 6, most = 24;
  int highest = fewest;
  for (const CriticalPoint& point : result.critical)
    if (point.rod == r && point.mode >= 0) highest = std::max(highest, static_cast<int>(point.order));
  return std::min(highest, most);
}

// What the parts of a Campbell diagram share.
struct CampbellFrame {
  double from, to;  // speeds
  double factor = 0, constant = 0;  // the crank's frequency: factor * x + constant, one of them 0
  double top = 0;  // highest frequency shown
  FrequencyUnit unit;

  [[nodiscard]] double crank(double x) const { return factor * x + constant; }
};

CampbellFrame campbell_frame(const SweepScene& scene, const SweepResult& result) {
  CampbellFrame frame{scene.axis().values.front(), scene.axis().values.back(), 0, 0, 0, frequency_unit(scene.scene())};
  switch (scene.axis().kind) {
    case Axis::Kind::rpm:
      frame.factor = frame.unit.factor * speed_from_rpm(1, scene.scene().units);
      break;
    case Axis::Kind::omega:
      frame.factor = frame.unit.factor;
      break;
    case Axis::Kind::parameter:
      frame.constant = frame.unit.factor * result.points.front().speed;
      break;
  }
  return frame;
}

// Title, axes, shaded bands and palette.
std::string campbell_settings(const SweepScene& scene, const SweepResult& result, std::size_t r, const CsvFile& csv,
                              const CampbellFrame& frame, double scale, const std::string& measured) {
  std::string notes = (result.computed.steady && !result.critical.empty() ? "; dots: resonance peaks" : "") +
                      frame_shaded_note(result, r) + measured;
  if (!notes.empty()) notes.erase(0, 2);
  const bool several = result.rods[r].num_modes > 1;
  return frame_title(scene, result, r,
                     "Campbell diagram; grey: nΩ, dashed: kΩ/2" +
                         std::string(several ? ", dotted: (ω_i ± ω_j)/2" : "") +
                         (notes.empty() ? "" : "'.\"\\n\".'" + notes) +
                         frame_beyond_note(csv, sweep_columns(scene, result, r))) +
         frame_axis(scene) + frame_shaded(result, r) +
         fmt::format("set yrange [0:{}]\nset ylabel 'frequency [{}]'\nunset key\nset rmargin 20\n", frame.top,
                     literal(frame.unit.name)) +
         fmt::format(
             "set palette defined (-1 '#08306b', -0.5 '#08519c', -0.2 '#2b8cbe', -0.02 '#7bccc4', 0 '#999999', 0.02 "
             "'#fc8d59', "
             "1 '#99000d')\nset cbrange [{}:{}]\nset cblabel 'growth rate of the mode [{}]' font ',11' offset -0.5, 0\n"
             "set cbtics font ',10'\nset colorbox user origin 0.88, 0.2 size 0.018, 0.6\n",
             -scale, scale, literal(output_units(scene.scene()).rate));
}

// Multiples and odd halves of the crank's frequency. Orders that leave the picture before its right end are labelled at
// the top, the others at the right.
void add_orders(const CampbellFrame& frame, int most, std::vector<std::string>& curves, std::string& labels) {
  const auto [from, to, factor, constant, top, unit] = frame;
  double last_label = HUGE_VAL;
  for (int half = 1; half <= 2 * most; ++half) {
    const bool whole = half % 2 == 0;
    const double order = half / 2.0;
    if (!whole && half > 12) continue;
    if (order * frame.crank(from) > top) break;
    curves.push_back(fmt::format("{} * ({} * x + {}) with lines linecolor rgb '{}' linewidth {} dashtype {} notitle",
                                 order, factor, constant, whole ? "#b0b0b0" : "#c8c8c8", whole ? 0.9 : 0.6,
                                 whole ? 1 : 2));
    if (!whole) continue;
    const double at_end = order * frame.crank(to);
    const std::string name = order == 1 ? "Ω" : fmt::format("{}Ω", half / 2);
    if (at_end <= top) {
      labels += fmt::format("set label '{}' at {}, {} left offset 0.4, 0 textcolor rgb '#777777' font ',10'\n", name,
                            to, at_end);
    } else if (const double x = factor > 0 ? (top / order - constant) / factor : HUGE_VAL;
               x < last_label - 0.045 * (to - from) && x > from) {
      last_label = x;
      labels += fmt::format("set label '{}' at {}, {} center offset 0, 0.5 textcolor rgb '#777777' font ',10'\n", name,
                            x, top);
    }
  }
}

// Half sums and differences of the lowest modes' frequencies.
void add_combinations(const CsvFile& csv, const SweepColumns& columns, int shown, std::vector<std::string>& curves) {
  for (int i = 0; i < std::min(shown, 3); ++i)
    for (int j = i + 1; j < std::min(shown, 3); ++j)
      for (const char* sign : {"+", "-"})
        curves.push_back(fmt::format(
            "'{}' using 1:(abs(column({}) {} column({}))/2) with lines linecolor rgb '#56b4e9' linewidth 0.8 "
            "dashtype 3 notitle",
            csv.name, columns.first_frequency + 2 * j, sign, columns.first_frequency + 2 * i));
}

// One mode's frequency, coloured by its growth. Locked to the crank it follows an order line k Omega/2; between two
// bands it passes to the next one, Omega/2 away, perhaps within a gap narrower than the points. A line breaks only
// where the multiple of the speed that its frequency is known up to changes.
void add_mode(const CampbellFrame& frame, const CsvFile& csv, const SweepColumns& columns, int mode, double scale,
              const std::string& name, std::vector<std::string>& curves, std::string& commands) {
  constexpr double jump = 0.6;  // of the speed
  const int frequency = columns.first_frequency + 2 * mode, growth = frequency + 1;
  commands += fmt::format("before{} = NaN\n", mode);
  // Grey first, the palette over what is within the theory.
  const std::string beyond = columns.beyond > 0 ? fmt::format("column({}) > 0", columns.beyond) : "0";
  if (columns.beyond > 0) {
    commands += fmt::format("grey{} = NaN\n", mode);
    curves.push_back(
        fmt::format("'{}' using 1:(now = column({}), jumps = abs(now - grey{}) > {} * ({} * $1 + {}), grey{} = now, "
                    "jumps ? NaN : now) with lines linecolor rgb '#999999' dashtype 2 linewidth 2 notitle",
                    csv.name, frequency, mode, jump, frame.factor, frame.constant, mode));
  }
  curves.push_back(
      fmt::format("'{}' using 1:(now = column({}), jumps = abs(now - before{}) > {} * ({} * $1 + {}), before{} = now, "
                  "jumps || {} ? NaN : now):(column({}) > {} ? {} : column({}) < {} ? {} : column({})) with lines "
                  "linewidth 3 linecolor palette notitle",
                  csv.name, frequency, mode, jump, frame.factor, frame.constant, mode, beyond, growth, scale, scale,
                  growth, -scale, -scale, growth));
  // Named where it is first seen inside the picture.
  for (Eigen::Index k = 0; k < csv.rows.rows(); ++k) {
    const double y = csv.rows(k, frequency - 1), x = csv.rows(k, 0);
    if (!(y <= 0.97 * frame.top) || !(x >= frame.from + 0.01 * (frame.to - frame.from))) continue;
    commands +=
        fmt::format("set label '{}mode {}' at {}, {} left offset 0.3, 0.7 font ',11' front\n", name, mode + 1, x, y);
    break;
  }
}

}  // namespace

Figure campbell_figure(const SweepScene& scene, const SweepResult& result, std::size_t r, const CsvFile& csv,
                       const std::string& critical, const MeasuredOverlay& measured) {
  const SweepRod& rod = result.rods[r];
  const SweepColumns columns = sweep_columns(scene, result, r);
  CampbellFrame frame = campbell_frame(scene, result);
  // High enough for the two lowest modes, and for the half order at the last speed.
  frame.top = 0.6 * frame.crank(frame.to);
  for (int mode = 0; mode < std::min(rod.num_modes, 2); ++mode)
    frame.top =
        std::max(frame.top, (mode == 0 ? 1.4 : 1.15) * largest(finite(csv, columns.first_frequency + 2 * mode)));
  const double scale = std::max(4 * std::abs(median(where_stable(scene, result, csv, columns.growth))), 1e-300);

  Figure figure;
  figure.name = figure_name("campbell", rod.name);
  figure.width = 1060;
  figure.height = 640;
  frame.top = std::max(frame.top, 1.05 * largest(measured.values("frequency " + rod.name)));
  figure.commands = campbell_settings(scene, result, r, csv, frame, scale, measured.note({"frequency " + rod.name}));
  std::vector<std::string> curves;
  add_orders(frame, highest_order(result, r), curves, figure.commands);
  const int shown = std::min(rod.num_modes, max_curves);
  add_combinations(csv, columns, shown, curves);
  const std::string name = scene.first().linkage() ? literal(rod.name) + " " : "";
  for (int mode = 0; mode < shown; ++mode) add_mode(frame, csv, columns, mode, scale, name, curves, figure.commands);
  if (result.computed.steady && !result.critical.empty())
    curves.push_back(fmt::format(
        "'{}' using (column(1) == {} && column(6) > 0 ? column(2) : NaN):8 with points pointtype 7 pointsize "
        "0.7 linecolor rgb '#000000' notitle",
        critical, r + 1));
  figure.commands += fmt::format("plot {}{}\nunset colorbox\nunset cblabel\n", fmt::join(curves, ", \\\n  "),
                                 measured.layer("frequency " + rod.name)) +
                     frame_clean_up;
  return figure;
}

Figure peaks_figure(const SweepScene& scene, const SweepResult& result, std::size_t r, const CsvFile& csv,
                    const MeasuredOverlay& measured) {
  const SweepRod& rod = result.rods[r];
  const SweepColumns columns = sweep_columns(scene, result, r);
  const int shown = std::min(rod.num_modes, max_curves);
  Figure figure;
  figure.name = figure_name("peaks", rod.name);
  std::vector<std::string> names;
  for (int i = 1; i <= shown; ++i) names.push_back(fmt::format("q_{} {}", i, rod.name));
  const std::string meaning = scene.first().linkage() ? "q_i: amplitude of sin(iπx/l)" : "q_i: unknowns of the system";
  std::string& text = figure.commands;
  text += frame_title(scene, result, r,
                      meaning + ", largest over the turn" + frame_shaded_note(result, r) + measured.note(names) +
                          frame_beyond_note(csv, columns)) +
          frame_axis(scene) + frame_shaded(result, r);
  double top = 0, bottom = HUGE_VAL;
  for (int i = 0; i < shown; ++i) {
    std::vector<double> values = where_stable(scene, result, csv, columns.first_peak + i);
    const std::vector<double> more = measured.values(names[static_cast<std::size_t>(i)]);
    values.insert(values.end(), more.begin(), more.end());
    for (const double value : values) {
      if (!(value > 0)) continue;
      top = std::max(top, value);
      bottom = std::min(bottom, value);
    }
  }
  if (top > 0) {
    bottom = std::max(bottom, 1e-12 * top);
    text += fmt::format("set logscale y\nset yrange [{}:{}]\nset format y '{}'\n", bottom / 2, 10 * top,
                        top / bottom > 300 ? "10^{%T}" : "%g");
  }
  text += fmt::format("set ylabel 'largest |q_i|{}'\nset key outside right top Left reverse samplen 2\nplot ",
                      bracketed(output_units(scene.scene()).response));
  for (int i = 0; i < shown; ++i) {
    text +=
        fmt::format("{}{} title 'q_{{{}}}'", i == 0 ? "" : ", ",
                    frame_curve(csv.name, columns.first_peak + i, columns, fmt::format("lt {}", i + 1), 1.8), i + 1);
  }
  for (const std::string& name : names) text += measured.layer(name);
  text += std::string("\n") + frame_clean_up;
  return figure;
}

Figure strain_figure(const SweepScene& scene, const SweepResult& result, std::size_t r, const CsvFile& csv,
                     const MeasuredOverlay& measured) {
  const SweepRod& rod = result.rods[r];
  const SweepColumns columns = sweep_columns(scene, result, r);
  struct Panel {
    std::string quantity, label;
    int column;
  };
  std::vector<Panel> panels = {
      {"deflection " + rod.name, "deflection [" + output_units(scene.scene()).length + "]", columns.deflection},
      {"bending moment " + rod.name, "bending moment [N m]", columns.bending_moment}};
  std::vector<std::string> names = {panels[0].quantity, panels[1].quantity};
  const auto stress = std::ranges::find(csv.columns, "stress [MPa]");
  if (stress != csv.columns.end()) {
    panels.push_back({"stress " + rod.name, "stress [MPa]", static_cast<int>(stress - csv.columns.begin()) + 1});
    names.push_back(panels.back().quantity);
  }
  Figure figure;
  figure.name = figure_name("sweep_deflection", rod.name);
  figure.height = 140 + 250 * static_cast<int>(panels.size());
  std::string& text = figure.commands;
  std::string heading = frame_title(
      scene, result, r,
      std::string("largest deflection") + (panels.size() > 2 ? ", bending moment and stress" : " and bending moment") +
          " over rod and turn" + frame_shaded_note(result, r) + measured.note(names) + frame_beyond_note(csv, columns));
  heading.replace(0, 10, "");  // without "set title "
  heading.pop_back();
  text += fmt::format(
      "set multiplot layout {},1 title {} margins char 14, char 3, char 4, char {} spacing char 0, char 1.5\n",
      panels.size(), heading, 1.5 + 1.5 * frame_lines(heading));
  text += frame_axis(scene) + frame_shaded(result, r) + "unset key\nset logscale y\nset format x ''\nunset xlabel\n";
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const Panel& panel = panels[k];
    std::vector<double> values = where_stable(scene, result, csv, panel.column);
    const std::vector<double> more = measured.values(panel.quantity);
    values.insert(values.end(), more.begin(), more.end());
    double low = HUGE_VAL;
    for (const double value : values)
      if (value > 0) low = std::min(low, value);
    if (std::isfinite(low)) text += fmt::format("set yrange [{}:{}]\n", low / 2, 10 * largest(values));
    if (k + 1 == panels.size()) text += fmt::format("set format x '%g'\nset xlabel {}\n", quoted(axis_label(scene)));
    text += fmt::format("set ylabel '{}'\nplot {}{}\n", literal(panel.label),
                        frame_curve(csv.name, panel.column, columns, fmt::format("lt {}", k + 1), 1.8),
                        measured.layer(panel.quantity));
  }
  text += std::string("unset multiplot\n") + frame_clean_up;
  return figure;
}

Figure growth_figure(const SweepScene& scene, const SweepResult& result, std::size_t r, const CsvFile& csv,
                     const MeasuredOverlay& measured) {
  const SweepRod& rod = result.rods[r];
  const SweepColumns columns = sweep_columns(scene, result, r);
  const OutputUnits units = output_units(scene.scene());
  std::vector<double> growth = finite(csv, columns.growth);
  const std::vector<double> more = measured.values("growth rate " + rod.name);
  growth.insert(growth.end(), more.begin(), more.end());
  Figure figure;
  figure.name = figure_name("growth", rod.name);
  std::string& text = figure.commands;
  text += frame_title(scene, result, r,
                      std::string(result.computed.verdict ? "growth rate of disturbances, or a bound above it"
                                                          : "growth rate of disturbances") +
                          ": below zero they die out" + frame_shaded_note(result, r) +
                          measured.note({"growth rate " + rod.name}) + frame_beyond_note(csv, columns)) +
          frame_axis(scene) + frame_shaded(result, r);
  // Around the leading rate: modes that decay far faster would hide it.
  const double low = growth.empty() ? -1 : *std::min_element(growth.begin(), growth.end());
  const double high = std::max(largest(growth), 0.0);
  const double span = std::max(high - low, 1e-300);
  text += fmt::format(
      "set yrange [{}:{}]\nset ylabel 'growth rate{}'\nset key outside right top Left reverse samplen 2\n"
      "set arrow from graph 0, first 0 to graph 1, first 0 nohead linecolor rgb '#000000' linewidth 0.8\nplot ",
      low - 0.35 * span, high + 0.1 * span, bracketed(units.rate));
  text += fmt::format("'{}' using 1:{} with lines linecolor rgb '#bbbbbb' linewidth 5 title 'leading'", csv.name,
                      columns.growth);
  const int shown = std::min(rod.num_modes, max_curves);
  for (int mode = 0; mode < shown; ++mode) {
    const std::vector<double> own = finite(csv, columns.first_frequency + 2 * mode + 1);
    if (own.empty() || *std::max_element(own.begin(), own.end()) < low - 0.35 * span) continue;  // below the picture
    text += fmt::format(
        ", {} title 'mode {}'",
        frame_curve(csv.name, columns.first_frequency + 2 * mode + 1, columns, fmt::format("lt {}", mode + 1), 1.4),
        mode + 1);
  }
  text += measured.layer("growth rate " + rod.name) + "\n";
  text += frame_clean_up;
  return figure;
}

}  // namespace hb::tools
