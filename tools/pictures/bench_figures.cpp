#include "tools/pictures/bench_figures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>

#include "tools/output/output_folder.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"

namespace hb::tools {
namespace {

// The rows of `bench` begin at `first_row` of bench.csv, those of each method stand together.
Figure bench_figure(const Bench& found, const RodBench& bench, std::size_t first_row) {
  const SceneModel& model = *found.model;
  Figure figure;
  figure.name = file_name("bench_" + bench.name);
  figure.width = 1050;
  figure.commands = fmt::format(
      "set title {}\nset logscale xy\nset format xy '10^{{%L}}'\nset xlabel 'time of one solution [s]'\n"
      "set ylabel 'max |error of q| / max |q|'\nset yrange [1e-16:10]\nset key outside right top Left reverse samplen "
      "2\nplot ",
      figure_title(model.scene,
                   {model.linkage() ? bench.name : "", speed_text(found.given.omega, model.scene),
                    title_verdict(found.verdicts)},
                   "error of the periodic state against run time"));
  std::size_t m = 0;
  for (std::size_t begin = 0, end = 0; begin < bench.rows.size(); begin = end, ++m) {
    const std::string& method = bench.rows[begin].method;
    while (end < bench.rows.size() && bench.rows[end].method == method) ++end;
    figure.commands += fmt::format(
        "'bench.csv' every ::{}::{} using 8:($7 > 1e-16 ? $7 : 1e-16) with linespoints {} ps 0.7 title {}, ",
        first_row + begin, first_row + end - 1, m < 7 ? fmt::format("lt {}", m + 1) : "lt 7 lc rgb '#888888' pt 8",
        quoted(method));
  }
  figure.commands += fmt::format("{} with lines lt 7 lc rgb '#888888' dt 2 title 'error of the reference'\n",
                                 std::max(bench.reference_error, 1e-16));
  figure.commands +=
      "unset logscale xy\nset format xy '%g'\nset yrange [*:*]\nunset title\nunset xlabel\nunset ylabel\nset key "
      "default\n";
  return figure;
}

}  // namespace

std::vector<Figure> bench_figures(const Bench& bench) {
  std::vector<Figure> figures;
  std::size_t row = 0;
  for (const RodBench& rod : bench.rods) {
    if (!rod.rows.empty()) figures.push_back(bench_figure(bench, rod, row));
    row += rod.rows.size();
  }
  return figures;
}

}  // namespace hb::tools
