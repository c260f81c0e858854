// Joint forces and torque along a sweep.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/output/output_units.hpp"
#include "tools/output/path_unit.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/sweep_figures.hpp"
#include "tools/pictures/sweep_frame.hpp"
#include "tools/pictures/sweep_range.hpp"

namespace hb::tools {

std::vector<Figure> sweep_force_figures(const SweepScene& scene, const SweepResult& result, const CsvFile& csv,
                                        const MeasuredOverlay& measured) {
  const Linkage& linkage = *scene.first().linkage();
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const std::string& coupler = linkage.dyads[d].coupler.name;
    groups.push_back({coupler, {coupler, body_name(linkage, closing_index(static_cast<int>(d)))}});
  }
  const std::string& crank = linkage.crank.body.name;
  groups.push_back({crank, {crank, "torque"}});
  std::string bands;
  for (const SweepRod& rod : result.rods) bands += frame_shaded(rod);
  const std::string verdict = sweep_title_verdict(result);

  std::vector<Figure> figures;
  for (const auto& [name, bodies] : groups) {
    std::string panels;
    int num_panels = 0;
    bool cut = false;
    std::vector<std::string> shown, components = result.joint_components;
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
      for (const double value : measured.values(components[c])) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
      shown.push_back(components[c]);
      const double margin = 0.15 * (high - low);
      const std::string range = high > low ? fmt::format("set yrange [{}:{}]\n", low - margin, high + margin) : "";
      panels += fmt::format(
          "{}set ylabel '{} [{}]'\nplot '{}' using 1:{}:{} with filledcurves fillcolor rgb '#b8b8b8' fillstyle solid "
          "0.6 "
          "notitle, '' using 1:{} with lines lt 1 title 'elastic', '' using 1:{} with lines lt 1 notitle, "
          "'' using 1:{} with lines lt 2 dashtype 2 title 'rigid', '' using 1:{} with lines lt 2 dashtype 2 notitle{}\n"
          "unset key\n",
          range, literal(components[c]), components[c] == "torque" ? "N m" : "N", csv.name, column, column + 1, column,
          column + 1, column + 2, column + 3, measured.layer(components[c]));
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
        "set ytics autofreq\n{}set xtics nice({})\n{}{}unset multiplot\nset tmargin -1\nset xtics autofreq\nset ytics "
        "autofreq\n",
        rows, literal(short_name(scene.scene()) + ", joints of " + name + (verdict.empty() ? "" : ", " + verdict)),
        frame_wrapped(fmt::format("between smallest and largest force over the turn, elastic beside rigid{}{}",
                                  cut ? "; sharp peaks cut off" : "",
                                  (bands.empty() ? "" : "; shaded orange: unstable") + measured.note(shown))),
        frame_axis(scene), (scene.axis().values.back() - scene.axis().values.front()) / 5, bands, panels);
    figure.commands += frame_clean_up;
    figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace hb::tools
