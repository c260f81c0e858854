// Pictures through gnuplot: a script that draws named figures from CSV files beside it, as SVG, PNG or PDF.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/output/output_folder.hpp"

namespace hb::tools {

struct Figure {
  std::string name;  // of the files, without extension
  int width = 900, height = 560;  // of the SVG in pixels; the PNG has twice as many
  std::string commands;  // gnuplot, after terminal and output are set
  std::string x_label = {}, y_label = {};  // names of axes that may be given others, quoted
};

// Text as a quoted gnuplot string that shows literally (no subscripts, no escapes).
[[nodiscard]] std::string quoted(const std::string& text);
// Text for the inside of a quoted string with gnuplot's enhanced markup (q_1 has a subscript), `literal` parts escaped.
[[nodiscard]] std::string literal(const std::string& text);

// Kinds of pictures, by the extension of their files.
using PictureKinds = std::vector<std::string>;
// PNG with one pixel for one of the figure, for pages.
inline const PictureKinds page_kinds = {"small"};

// How the pictures of a folder are wanted.
struct PictureStyle {
  bool drawn = true;
  PictureKinds kinds = {"svg", "png"};
  struct Size {
    int width, height;
  };
  std::optional<Size> size = std::nullopt;  // of every figure, instead of its own
  bool titles = true;
  std::string x_label = {}, y_label = {};  // instead of those of the figures; empty: their own
  // Other names of axes of any picture, colour bars included, by the name that stands there.
  struct Label {
    std::string name, shown;
  };
  std::vector<Label> labels = {};
};

// The names of all axes, as they are shown.
[[nodiscard]] std::vector<std::string> axis_names(const std::vector<Figure>& figures);

// The script that draws all figures when run in the folder of their CSV files.
[[nodiscard]] std::string plot_script(const std::vector<Figure>& figures, const PictureStyle& style = {});

struct PlotOutcome {
  bool no_gnuplot = false;
  std::vector<std::string> missing;  // figures without all pictures whole
  std::string words;  // gnuplot's, clean and short, or why it was ended
  [[nodiscard]] bool complete() const { return missing.empty(); }
};

// Runs `script` (a file name) in `folder`; it is ended when no picture has grown for `patience`.
[[nodiscard]] PlotOutcome run_gnuplot(const std::filesystem::path& folder, const std::string& script,
                                      const std::vector<Figure>& figures,
                                      std::chrono::milliseconds patience = std::chrono::seconds(30),
                                      const PictureKinds& kinds = PictureStyle().kinds);

// Name of the script among the files of a command.
[[nodiscard]] std::string script_name(const std::string& command);

// Draws the figures of a folder whose script and CSV files are committed, and commits those pictures that are whole.
// False, with the reason on standard error, if some are missing.
[[nodiscard]] bool draw_figures(const std::vector<Figure>& figures, OutputFolder& folder,
                                const PictureStyle& style = {});

}  // namespace hb::tools
