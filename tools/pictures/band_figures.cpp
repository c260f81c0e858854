#include "tools/pictures/band_figures.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/sweep_range.hpp"

namespace hb::tools {

Figure band_figure(const Scene& scene, const BandCurves& curves, bool turn) {
  Figure figure;
  figure.name = curves.csv.name.substr(0, curves.csv.name.size() - std::string(".csv").size());
  const int panels = static_cast<int>(curves.labels.size());
  figure.height = panels == 1 ? 480 : 140 + 200 * panels;
  const Eigen::MatrixXd& rows = curves.csv.rows;
  figure.commands = fmt::format(
      "set multiplot layout {},1 title {} margins char 14, char 3, char 4, char 6 spacing char 0, char 1.5\n"
      "least(a, b, c) = a < b ? (a < c ? a : c) : (b < c ? b : c)\nmost(a, b, c) = -least(-a, -b, -c)\n"
      "{}set format x ''\nset key at graph 1, graph 1.01 right bottom horizontal Left reverse samplen 3\n",
      panels,
      figure_title(
          scene, {curves.rod},
          fmt::format("{} of the elastic links times {:g} to {:g}; shaded: what the three curves cover",
                      curves.parameter == "E" ? "Young''s modulus" : curves.parameter, curves.from, curves.to)),
      turn ? std::string(turn_axis) : fmt::format("set xrange [{}:{}]\n", rows(0, 0), rows(rows.rows() - 1, 0)));
  for (int k = 0; k < panels; ++k) {
    const std::string& label = curves.labels[static_cast<std::size_t>(k)];
    const int given = 2 + 3 * k, low = given + 1, high = given + 2;
    std::string range = "unset logscale y\nset yrange [*:*]\n";
    if (!turn && !label.starts_with("growth")) {
      std::vector<double> values;
      for (const int column : {given, low, high})
        for (const double value : finite(curves.csv, column))
          if (value > 0) values.push_back(value);
      if (!values.empty()) range = "set logscale y\nset yrange [*:*]\n";
    }
    if (k + 1 == panels)
      figure.commands += fmt::format("set format x '%g'\nset xlabel {}\n", quoted(curves.csv.columns.front()));
    if (label.starts_with("growth"))
      range += "set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead linecolor '#000000' linewidth 0.8\n";
    figure.commands += fmt::format(
        "{0}set ylabel {1}\nplot '{2}' using 1:(least(${3}, ${4}, ${7})):(most(${3}, ${4}, ${7})) with filledcurves "
        "fillcolor '#b8d4ea' fillstyle solid 0.8 "
        "notitle, "
        "'' using 1:{3} with lines linewidth 1 dashtype (8,4) linecolor '#56b4e9' title '{5:g}', '' using 1:{4} with "
        "lines "
        "linewidth 1 dashtype (2,3) linecolor '#e69f00' title '{6:g}', '' using 1:{7} with lines lt 1 title 'as "
        "given'\nunset key\nunset arrow\n",
        range, label.starts_with("q_") ? fmt::format("'q_{}'", literal(label.substr(2))) : quoted(label),
        curves.csv.name, low, high, curves.from, curves.to, given);
  }
  figure.commands +=
      "unset multiplot\nunset logscale\nset format '%g'\nset xrange [*:*]\nset yrange [*:*]\nset xtics "
      "autofreq\nunset xlabel\nunset ylabel\nunset title\nset key default\n";
  return figure;
}

}  // namespace hb::tools
