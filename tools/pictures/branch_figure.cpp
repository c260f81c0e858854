#include "tools/pictures/branch_figure.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "tools/output/branches_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"

namespace hb::tools {
namespace {

// A title has room for the verdict alone: of the rods, which move together, the name says nothing.
std::string verdict_of_title(const NonlinearSweep& sweep) {
  std::string words = branches_words(sweep);
  words = words.substr(0, words.find("; "));
  for (const std::string name : {" because of all rods together", " (all rods together)"})
    if (const std::size_t at = words.find(name); at != std::string::npos) words.erase(at, name.size());
  return words;
}

}  // namespace

Figure branch_figure(const SweepScene& scene, const SweepResult& linear, const NonlinearSweep& sweep, std::size_t r,
                     const CsvFile& linear_csv, const CsvFile& branches, const MeasuredOverlay& measured) {
  Figure figure;
  figure.name = file_name("branches_" + sweep.rods[r]);
  std::string& text = figure.commands;
  const std::vector<double>& values = scene.axis().values;
  double top = 0;
  for (const NonlinearBranch& branch : sweep.branches)
    for (const NonlinearPoint& point : branch.points) top = std::max(top, point.max_abs[r].front());
  const std::string q_1 = "q_1 " + sweep.rods[r];
  for (const double value : measured.values(q_1)) top = std::max(top, value);
  text += "set title " +
          figure_title(scene.scene(), {sweep.rods[r], verdict_of_title(sweep)},
                       "without linearisation: solid stable, dashed unstable" +
                           std::string(sweep.folds.empty() ? "" : ", dots folds") +
                           std::string(sweep.bifurcations.empty() ? "" : ", circles bifurcations")) +
          "\n";
  text += fmt::format(
      "set xrange [{}:{}]\nset xlabel {}\nset ylabel 'largest |q_1| [{}]'\nset yrange [0:{}]\n"
      "set key outside right top Left reverse samplen 2\nplot ",
      values.front(), values.back(), quoted(axis_label(scene)), literal(output_units(scene.scene()).length),
      top > 0 ? 1.15 * top : 1);
  const int peak = branch_first_peak_column, verdict = branch_verdict_column(sweep, r);
  if (const int column = sweep_columns(scene, linear, r).first_peak; column > 0)
    text += fmt::format("'{}' using 1:{} with lines linecolor rgb '#aaaaaa' linewidth 2 title 'linear', ",
                        linear_csv.name, column);
  for (std::size_t b = 0; b < sweep.branches.size(); ++b) {
    const int turns = sweep.branches[b].turns;
    const std::string of_branch = fmt::format("column({}) == {}", branch_column, b + 1);
    text += fmt::format(
        "'{0}' using ({1} ? column({2}) : NaN):({1} && column({3}) >= 0 ? column({4}) : NaN) with lines linetype {5} "
        "dashtype 2 linewidth 1.6 notitle, '{0}' using ({1} ? column({2}) : NaN):({1} && column({3}) < 0 ? column({4}) "
        ": NaN) with lines linetype {5} linewidth 2 title '{6}'{7}",
        branches.name, of_branch, branch_x_column, verdict, peak, b + 1,
        turns == 1 ? fmt::format("branch {}", b + 1) : fmt::format("branch {}, {} turns", b + 1, turns),
        b + 1 < sweep.branches.size() ? ", " : "");
  }
  text += measured.layer(q_1, true);
  const auto marks = [&](const std::vector<NonlinearEvent>& events, int pointtype) {
    std::string labels;
    for (const NonlinearEvent& event : events)
      labels += fmt::format("set label '' at {}, {} point pointtype {} pointsize 0.8 linecolor rgb '#000000' front\n",
                            event.x, event.max_abs[r].front(), pointtype);
    return labels;
  };
  text.insert(text.rfind("plot "), marks(sweep.folds, 7) + marks(sweep.bifurcations, 6));
  text +=
      "\nunset label\nset xrange [*:*]\nset yrange [*:*]\nunset title\nunset xlabel\nunset ylabel\nset key default\n";
  return figure;
}

}  // namespace hb::tools
