#include "tools/pictures/sweep_figures.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "tools/output/output_folder.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/sweep_range.hpp"

namespace hb::tools {
namespace {

constexpr int max_curves = 6;

constexpr const char* clean_up =
    "unset object\nunset arrow\nunset label\nunset logscale\nset xrange [*:*]\nset yrange [*:*]\nset format '%g'\n"
    "unset title\nunset xlabel\nunset ylabel\nset key default\nset rmargin -1\nset lmargin -1\n";

constexpr const char* new_line = "'.\"\\n\".'";  // gnuplot reads \n only in double quotes

// Breaks lines between sentences, at "; ", where they would be longer than the picture is wide.
std::string wrapped(const std::string& shown) {
  constexpr std::size_t longest = 78;
  std::string text;
  std::size_t length = 0;
  for (std::size_t at = 0; at < shown.size();) {
    const std::size_t line_end = shown.find(new_line, at), sentence_end = shown.find("; ", at);
    const std::size_t end = std::min({line_end, sentence_end, shown.size()});
    const std::string sentence = shown.substr(at, end - at);
    if (length > 0) {
      const bool fits = length + 2 + sentence.size() <= longest;
      text += fits ? "; " : new_line;
      length = fits ? length + 2 : 0;
    }
    text += sentence;
    length += sentence.size();
    if (end == shown.size()) break;
    at = end + 2;
    if (end != line_end) continue;
    text += new_line;
    length = 0;
    at = end + std::string_view(new_line).size();
  }
  return text;
}

int count_lines(const std::string& text) {
  int lines = 1;
  for (std::size_t at = text.find(new_line); at != std::string::npos; at = text.find(new_line, at + 1)) ++lines;
  return lines;
}

std::string title(const SweepScene& scene, const SweepResult& result, std::size_t rod, const std::string& shown) {
  const std::string subject = scene.first().linkage() ? ", " + result.rods[rod].name : "";
  std::string at;
  if (scene.axis().kind == Axis::Kind::parameter) at = " at " + speed_text(result.points.front().speed, scene.scene());
  const std::string verdict = sweep_title_verdict(result);
  return "set title heading('{/:Bold " +
         literal(short_name(scene.scene()) + subject + at + (verdict.empty() ? "" : ", " + verdict)) + "}" + new_line +
         wrapped(shown) + "')\n";
}

std::string axis(const SweepScene& scene) {
  const std::vector<double>& values = scene.axis().values;
  return fmt::format("set xrange [{}:{}]\nset xlabel {}\n", values.front(), values.back(), quoted(axis_label(scene)));
}

std::string shaded(const SweepRod& rod, const char* colour = "#d55e00") {
  std::string text;
  for (const UnstableBand& band : rod.bands) {
    text += fmt::format(
        "set object rectangle from first {}, graph 0 to first {}, graph 1 fillcolor rgb '{}' fillstyle solid 0.18 "
        "noborder behind\n",
        band.from, band.to, colour);
  }
  return text;
}

// Bands of this rod, over those of the others: there the mechanism is unstable too.
std::string shaded(const SweepResult& result, std::size_t r) {
  std::string text;
  for (std::size_t other = 0; other < result.rods.size(); ++other)
    if (other != r) text += shaded(result.rods[other], "#777777");
  return text + shaded(result.rods[r]);
}

std::string shaded_note(const SweepResult& result, std::size_t r) {
  std::string others;
  for (std::size_t other = 0; other < result.rods.size(); ++other)
    if (other != r && !result.rods[other].bands.empty())
      others += (others.empty() ? "" : ", ") + result.rods[other].name;
  return (result.rods[r].bands.empty() ? std::string() : std::string("; shaded: unstable")) +
         (others.empty() ? "" : "; shaded grey: unstable because of " + literal(others));
}

// A curve, grey and dashed where the answer is beyond the linear theory. `style`: what stands behind "with lines".
std::string curve(const std::string& csv, int column, const SweepColumns& columns, const std::string& style,
                  double width) {
  if (columns.beyond == 0) return fmt::format("'{}' using 1:{} with lines {} linewidth {}", csv, column, style, width);
  return fmt::format(
      "'{0}' using 1:{1} with lines linecolor rgb '#999999' dashtype 2 linewidth {2} notitle, '{0}' using "
      "1:(column({3}) > 0 ? NaN : column({1})) with lines {4} linewidth {5}",
      csv, column, 0.7 * width, columns.beyond, style, width);
}

// Some of the picture is beyond.
std::string beyond_note(const CsvFile& csv, const SweepColumns& columns) {
  if (columns.beyond == 0) return "";
  const bool some = (csv.rows.col(columns.beyond - 1).array() > 0).any();
  return some ? "'.\"\\n\".'grey, dashed: beyond the linear theory or small deflections" : "";
}

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
                              const CampbellFrame& frame, double scale) {
  std::string notes =
      (result.computed.steady && !result.critical.empty() ? "; dots: resonance peaks" : "") + shaded_note(result, r);
  if (!notes.empty()) notes.erase(0, 2);
  const bool several = result.rods[r].num_modes > 1;
  return title(scene, result, r,
               "Campbell diagram; grey: nΩ, dashed: kΩ/2" + std::string(several ? ", dotted: (ω_i ± ω_j)/2" : "") +
                   (notes.empty() ? "" : "'.\"\\n\".'" + notes) + beyond_note(csv, sweep_columns(scene, result, r))) +
         axis(scene) + shaded(result, r) +
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

// One mode's frequency, coloured by its growth. Locked to the crank a mode's frequency is known up to a multiple of
// half the speed: the line breaks where that changes.
void add_mode(const CampbellFrame& frame, const CsvFile& csv, const SweepColumns& columns, int mode, double scale,
              const std::string& name, std::vector<std::string>& curves, std::string& commands) {
  constexpr double jump = 0.25;  // of the speed
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
                       const std::string& critical) {
  const SweepRod& rod = result.rods[r];
  const SweepColumns columns = sweep_columns(scene, result, r);
  CampbellFrame frame = campbell_frame(scene, result);
  // High enough for the two lowest modes and for two turns of the crank.
  frame.top = 2 * frame.crank(frame.to);
  for (int mode = 0; mode < std::min(rod.num_modes, 2); ++mode)
    frame.top = std::max(frame.top, 1.15 * largest(finite(csv, columns.first_frequency + 2 * mode)));
  const double scale = std::max(4 * std::abs(median(where_stable(scene, result, csv, columns.growth))), 1e-300);

  Figure figure;
  figure.name = figure_name("campbell", rod.name);
  figure.width = 1060;
  figure.height = 640;
  figure.commands = campbell_settings(scene, result, r, csv, frame, scale);
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
  figure.commands += fmt::format("plot {}\nunset colorbox\nunset cblabel\n", fmt::join(curves, ", \\\n  ")) + clean_up;
  return figure;
}

Figure peaks_figure(const SweepScene& scene, const SweepResult& result, std::size_t r, const CsvFile& csv) {
  const SweepRod& rod = result.rods[r];
  const SweepColumns columns = sweep_columns(scene, result, r);
  const int shown = std::min(rod.num_modes, max_curves);
  Figure figure;
  figure.name = figure_name("peaks", rod.name);
  const std::string meaning = scene.first().linkage() ? "q_i: amplitude of sin(iπx/l)" : "q_i: unknowns of the system";
  std::string& text = figure.commands;
  text += title(scene, result, r,
                meaning + ", largest over the turn" + shaded_note(result, r) + beyond_note(csv, columns)) +
          axis(scene) + shaded(result, r);
  double top = 0, bottom = HUGE_VAL;
  for (int i = 0; i < shown; ++i) {
    for (const double value : where_stable(scene, result, csv, columns.first_peak + i)) {
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
    text += fmt::format("{}{} title 'q_{{{}}}'", i == 0 ? "" : ", ",
                        curve(csv.name, columns.first_peak + i, columns, fmt::format("lt {}", i + 1), 1.8), i + 1);
  }
  text += std::string("\n") + clean_up;
  return figure;
}

Figure strain_figure(const SweepScene& scene, const SweepResult& result, std::size_t r, const CsvFile& csv) {
  const SweepRod& rod = result.rods[r];
  const SweepColumns columns = sweep_columns(scene, result, r);
  Figure figure;
  figure.name = figure_name("sweep_deflection", rod.name);
  figure.height = 640;
  std::string& text = figure.commands;
  std::string heading = title(
      scene, result, r,
      "largest deflection and bending moment over rod and turn" + shaded_note(result, r) + beyond_note(csv, columns));
  heading.replace(0, 10, "");  // without "set title "
  heading.pop_back();
  text += fmt::format(
      "set multiplot layout 2,1 title {} margins char 14, char 3, char 4, char {} spacing char 0, char 1.5\n", heading,
      1.5 + 1.5 * count_lines(heading));
  text += axis(scene) + shaded(result, r);
  const auto range = [&](int column) {
    const std::vector<double> values = where_stable(scene, result, csv, column);
    double low = HUGE_VAL;
    for (const double value : values)
      if (value > 0) low = std::min(low, value);
    return std::isfinite(low) ? fmt::format("set yrange [{}:{}]\n", low / 2, 10 * largest(values)) : std::string();
  };
  text += fmt::format(
      "unset key\nset logscale y\nset format x ''\nunset xlabel\nset ylabel 'deflection [{}]'\n{}"
      "plot {}\n"
      "set format x '%g'\nset xlabel {}\nset ylabel 'bending moment [N m]'\n{}"
      "plot {}\nunset multiplot\n",
      literal(output_units(scene.scene()).length), range(columns.deflection),
      curve(csv.name, columns.deflection, columns, "lt 1", 1.8), quoted(axis_label(scene)),
      range(columns.bending_moment), curve(csv.name, columns.bending_moment, columns, "lt 2", 1.8));
  text += clean_up;
  return figure;
}

Figure growth_figure(const SweepScene& scene, const SweepResult& result, std::size_t r, const CsvFile& csv) {
  const SweepRod& rod = result.rods[r];
  const SweepColumns columns = sweep_columns(scene, result, r);
  const OutputUnits units = output_units(scene.scene());
  const std::vector<double> growth = finite(csv, columns.growth);
  Figure figure;
  figure.name = figure_name("growth", rod.name);
  std::string& text = figure.commands;
  text += title(scene, result, r,
                "growth rate of disturbances: below zero they die out" + shaded_note(result, r) +
                    beyond_note(csv, columns)) +
          axis(scene) + shaded(result, r);
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
        curve(csv.name, columns.first_frequency + 2 * mode + 1, columns, fmt::format("lt {}", mode + 1), 1.4),
        mode + 1);
  }
  text += "\n";
  text += clean_up;
  return figure;
}

std::vector<Figure> sweep_force_figures(const SweepScene& scene, const SweepResult& result, const CsvFile& csv) {
  const Linkage& linkage = *scene.first().linkage();
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const std::string& coupler = linkage.dyads[d].coupler.name;
    groups.push_back({coupler, {coupler, body_name(linkage, closing_index(static_cast<int>(d)))}});
  }
  const std::string& crank = linkage.crank.body.name;
  groups.push_back({crank, {crank, "torque"}});
  std::string bands;
  for (const SweepRod& rod : result.rods) bands += shaded(rod);
  const std::string verdict = sweep_title_verdict(result);

  std::vector<Figure> figures;
  for (const auto& [name, bodies] : groups) {
    std::string panels;
    int num_panels = 0;
    bool cut = false;
    std::vector<std::string> components = result.joint_components;
    components.push_back("torque");
    for (std::size_t c = 0; c < components.size(); ++c) {
      const std::string body = components[c].substr(0, components[c].find('.'));
      if (std::find(bodies.begin(), bodies.end(), body) == bodies.end()) continue;
      const int column = 2 + 4 * static_cast<int>(c);
      double low = 0, high = 0;
      for (int k = 0; k < 4; ++k) {
        const std::vector<double> all = where_stable(scene, result, csv, column + k), values = without_spikes(all);
        cut = cut || values.size() < all.size();
        if (values.empty()) continue;
        low = std::min(low, *std::min_element(values.begin(), values.end()));
        high = std::max(high, largest(values));
        if (k < 2) continue;
        const std::vector<double> rigid = finite(csv, column + k);  // over the whole sweep
        low = std::min(low, *std::min_element(rigid.begin(), rigid.end()));
        high = std::max(high, largest(rigid));
      }
      const double margin = 0.15 * (high - low);
      const std::string range = high > low ? fmt::format("set yrange [{}:{}]\n", low - margin, high + margin) : "";
      panels += fmt::format(
          "{}set ylabel '{} [{}]'\nplot '{}' using 1:{}:{} with filledcurves fillcolor rgb '#b8b8b8' fillstyle solid "
          "0.6 "
          "notitle, '' using 1:{} with lines lt 1 title 'elastic', '' using 1:{} with lines lt 1 notitle, "
          "'' using 1:{} with lines lt 2 dashtype 2 title 'rigid', '' using 1:{} with lines lt 2 dashtype 2 notitle\n"
          "unset key\n",
          range, literal(components[c]), components[c] == "torque" ? "N m" : "N", csv.name, column, column + 1, column,
          column + 1, column + 2, column + 3);
      ++num_panels;
    }
    if (num_panels == 0) continue;
    const int rows = (num_panels + 1) / 2;
    Figure figure;
    figure.name = figure_name("sweep_forces", name);
    figure.width = 1000;
    figure.height = 130 + 230 * rows;
    figure.commands = fmt::format(
        "set multiplot layout {},2 title '{{/:Bold {}}}'.\"\\n\".'{}'\nset tmargin 2.2\nset key at graph 1, graph 1.02 "
        "right bottom horizontal Left reverse samplen "
        "3\nset format '%g'\n"
        "set xtics autofreq\nset ytics autofreq\n{}{}{}unset multiplot\nset tmargin -1\nset xtics autofreq\nset ytics "
        "autofreq\n",
        rows, literal(short_name(scene.scene()) + ", joints of " + name + (verdict.empty() ? "" : ", " + verdict)),
        wrapped(fmt::format("between smallest and largest force over the turn, elastic beside rigid{}{}",
                            cut ? "; sharp peaks cut off" : "", bands.empty() ? "" : "; shaded orange: unstable")),
        axis(scene), bands, panels);
    figure.commands += clean_up;
    figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace hb::tools
