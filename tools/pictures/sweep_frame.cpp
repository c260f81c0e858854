#include "tools/pictures/sweep_frame.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "tools/output/output_units.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {
namespace {

constexpr const char* frame_new_line = "'.\"\\n\".'";  // gnuplot reads \n only in double quotes

}  // namespace

std::string frame_wrapped(const std::string& shown) {
  constexpr std::size_t longest = 78;
  std::string text;
  std::size_t length = 0;
  for (std::size_t at = 0; at < shown.size();) {
    const std::size_t line_end = shown.find(frame_new_line, at), sentence_end = shown.find("; ", at);
    const std::size_t end = std::min({line_end, sentence_end, shown.size()});
    const std::string sentence = shown.substr(at, end - at);
    if (length > 0) {
      const bool fits = length + 2 + sentence.size() <= longest;
      text += fits ? "; " : frame_new_line;
      length = fits ? length + 2 : 0;
    }
    text += sentence;
    length += sentence.size();
    if (end == shown.size()) break;
    at = end + 2;
    if (end != line_end) continue;
    text += frame_new_line;
    length = 0;
    at = end + std::string_view(frame_new_line).size();
  }
  return text;
}

int frame_lines(const std::string& text) {
  int lines = 1;
  for (std::size_t at = text.find(frame_new_line); at != std::string::npos; at = text.find(frame_new_line, at + 1))
    ++lines;
  return lines;
}

std::string frame_title(const SweepScene& scene, const SweepResult& result, std::size_t rod, const std::string& shown) {
  const std::string subject = scene.first().linkage() ? ", " + result.rods[rod].name : "";
  std::string at;
  if (scene.axis().kind == Axis::Kind::parameter) at = " at " + speed_text(result.points.front().speed, scene.scene());
  const std::string verdict = sweep_title_verdict(result);
  return "set title heading('{/:Bold " +
         literal(short_name(scene.scene()) + subject + at + (verdict.empty() ? "" : ", " + verdict)) + "}" +
         frame_new_line + frame_wrapped(shown) + "')\n";
}

std::string frame_axis(const SweepScene& scene) {
  const std::vector<double>& values = scene.axis().values;
  return fmt::format("set xrange [{}:{}]\nset xlabel {}\n", values.front(), values.back(), quoted(axis_label(scene)));
}

std::string frame_shaded(const SweepRod& rod, const char* colour) {
  std::string text;
  for (const UnstableBand& band : rod.bands) {
    text += fmt::format(
        "set object rectangle from first {}, graph 0 to first {}, graph 1 fillcolor rgb '{}' fillstyle solid 0.18 "
        "noborder behind\n",
        band.from, band.to, colour);
  }
  return text;
}

std::string frame_shaded(const SweepResult& result, std::size_t r) {
  std::string text;
  for (std::size_t other = 0; other < result.rods.size(); ++other)
    if (other != r) text += frame_shaded(result.rods[other], "#777777");
  return text + frame_shaded(result.rods[r]);
}

std::string frame_shaded_note(const SweepResult& result, std::size_t r) {
  std::string others;
  for (std::size_t other = 0; other < result.rods.size(); ++other)
    if (other != r && !result.rods[other].bands.empty())
      others += (others.empty() ? "" : ", ") + result.rods[other].name;
  return (result.rods[r].bands.empty() ? std::string() : std::string("; shaded: unstable")) +
         (others.empty() ? "" : "; shaded grey: unstable because of " + literal(others));
}

std::string frame_curve(const std::string& csv, int column, const SweepColumns& columns, const std::string& style,
                        double width) {
  if (columns.beyond == 0) return fmt::format("'{}' using 1:{} with lines {} linewidth {}", csv, column, style, width);
  return fmt::format(
      "'{0}' using 1:{1} with lines linecolor rgb '#999999' dashtype 2 linewidth {2} notitle, '{0}' using "
      "1:(column({3}) > 0 ? NaN : column({1})) with lines {4} linewidth {5}",
      csv, column, 0.7 * width, columns.beyond, style, width);
}

std::string frame_beyond_note(const CsvFile& csv, const SweepColumns& columns) {
  if (columns.beyond == 0) return "";
  const bool some = (csv.rows.col(columns.beyond - 1).array() > 0).any();
  return some ? "'.\"\\n\".'grey, dashed: beyond the linear theory or small deflections" : "";
}

}  // namespace hb::tools
