// Pictures through gnuplot: a script that draws named figures from CSV files beside it, as SVG and as PNG.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/output/output_folder.hpp"

namespace hb::tools {

struct Figure {
  std::string name;  // of the files, without extension
  int width = 900, height = 560;  // of the SVG in pixels; the PNG has twice as many
  std::string commands;  // gnuplot, after terminal and output are set
};

// Text as a quoted gnuplot string that shows literally (no subscripts, no escapes).
[[nodiscard]] std::string quoted(const std::string& text);
// Text for the inside of a quoted string with gnuplot's enhanced markup (q_1 has a subscript), `literal` parts escaped.
[[nodiscard]] std::string literal(const std::string& text);

// The script that draws all figures when run in the folder of their CSV files.
[[nodiscard]] std::string plot_script(const std::vector<Figure>& figures);

enum class PlotStatus { drawn, no_gnuplot };

// Runs `script` (a file name) in `folder`. Throws OutputError with gnuplot's words when it fails or when a picture is
// missing or cut short.
[[nodiscard]] PlotStatus run_gnuplot(const std::filesystem::path& folder, const std::string& script,
                                     const std::vector<Figure>& figures);

// Writes plots.gp and, if `draw`, the pictures into the folder; without gnuplot says so on standard error.
void draw_figures(const std::vector<Figure>& figures, OutputFolder& folder, bool draw);

}  // namespace hb::tools
