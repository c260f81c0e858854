#include "tools/pictures/compare_figures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/sweep_range.hpp"

namespace hb::tools {
namespace {

std::string both_sides(const std::string& what, const ComparedSide& a, const std::string& verdict_a,
                       const ComparedSide& b, const std::string& verdict_b) {
  return two_lines(what, literal(fmt::format("A: {}, {}", a.source, verdict_a)) + "\n" +
                             literal(fmt::format("B: {}, {}", b.source, verdict_b)));
}

// Range of both sides' values without sharp peaks; logarithmic where it takes that to show all.
std::string panel_range(const AlongCurves& curves, int column) {
  std::vector<double> values = finite(curves.a, column), more = finite(curves.b, column);
  values.insert(values.end(), more.begin(), more.end());
  const bool positive = std::ranges::all_of(values, [](double value) { return value > 0; });
  const double low = values.empty() ? 0 : *std::ranges::min_element(values);
  if (positive && !values.empty() && largest(values) > 30 * low)
    return fmt::format("set logscale y\nset yrange [{}:{}]\n", low / 2, 3 * largest(without_spikes(values)));
  if (values.empty()) return "unset logscale y\nset yrange [*:*]\n";
  const double high = std::max(largest(without_spikes(values)), positive ? 0.0 : *std::ranges::max_element(values));
  const double margin = 0.08 * std::max(high - std::min(low, 0.0), 1e-300);
  return fmt::format("unset logscale y\nset yrange [{}:{}]\n", positive ? 0 : low - margin, high + margin);
}

}  // namespace

Figure compare_response_figure(const ComparedSide& a, const ComparedSide& b, const CsvFile& csv) {
  Figure figure;
  figure.name = csv.name.substr(0, csv.name.size() - std::string(".csv").size());
  figure.commands = fmt::format(
      "set title {}\nset xrange [0:360]\nset xtics 0,60,360\nset xlabel 'crank angle [deg]'\nset ylabel 'q_1{}'\n"
      "set key outside right top Left reverse samplen 2\nplot '{}' using 1:2 with lines lt 1 title 'A', '' using 1:3 "
      "with lines lt 2 dashtype 2 title 'B'\nunset title\nunset xlabel\nunset ylabel\nset xrange [*:*]\nset xtics "
      "autofreq\nset "
      "key "
      "default\n",
      two_lines(figure.name.substr(std::string("compare_").size()) + ", response over the turn",
                literal(fmt::format("A: {}, {}", a.source, side_verdict(a))) + "\n" +
                    literal(fmt::format("B: {}, {}", b.source, side_verdict(b)))),
      literal(csv.columns[1].substr(5)), csv.name);
  return figure;
}

Figure compare_along_figure(const ComparedSide& a, const ComparedSide& b, const AlongCurves& curves) {
  Figure figure;
  figure.name = curves.a.name.substr(0, curves.a.name.size() - std::string("_a.csv").size());
  const int panels = static_cast<int>(curves.labels.size());
  figure.height = 140 + 200 * panels;
  const double from = std::max(curves.a.rows(0, 0), curves.b.rows(0, 0)),
               to = std::min(curves.a.rows(curves.a.rows.rows() - 1, 0), curves.b.rows(curves.b.rows.rows() - 1, 0));
  figure.commands = fmt::format(
      "set multiplot layout {},1 title {} margins char 14, char 3, char 4, char 7 spacing char 0, char 1.5\n"
      "set xrange [{}:{}]\nset format x ''\nset key at graph 1, graph 1 right bottom horizontal Left reverse samplen "
      "3\n",
      panels, both_sides(curves.name + " along " + along_label(a), a, along_verdict(a), b, along_verdict(b)), from, to);
  for (int k = 0; k < panels; ++k) {
    const std::string& label = curves.labels[static_cast<std::size_t>(k)];
    if (k + 1 == panels) figure.commands += fmt::format("set format x '%g'\nset xlabel {}\n", quoted(along_label(a)));
    if (label.starts_with("growth"))
      figure.commands +=
          "set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead linecolor '#000000' linewidth 0.8\n";
    figure.commands += fmt::format(
        "{}set ylabel {}\nplot '{}' using 1:{} with lines lt 1 title 'A', '{}' using 1:{} with lines lt 2 dashtype "
        "(8,4) "
        "title 'B'\nunset key\nunset arrow\n",
        panel_range(curves, k + 2), quoted(label), curves.a.name, k + 2, curves.b.name, k + 2);
  }
  figure.commands +=
      "unset multiplot\nunset logscale\nset format '%g'\nset xrange [*:*]\nset yrange [*:*]\nunset xlabel\nunset "
      "ylabel\nunset title\nset key default\n";
  return figure;
}

}  // namespace hb::tools
