#include "tools/command/output_flags.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <thread>

#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/report/report_page.hpp"

namespace hb::tools {
namespace {

// Points of a picture's side: room for its labels, and what gnuplot draws in reasonable time.
constexpr int smallest_side = 200, largest_side = 4000;

PictureStyle picture_style(const CommonFlags& flags) {
  PictureStyle style;
  style.drawn = !flags.no_plots;
  style.titles = !flags.no_titles;
  if (!flags.format.empty()) {
    style.kinds.clear();
    for (const std::string& kind : list_flag("--format", flags.format)) {
      const std::vector<std::string> allowed = {"svg", "png", "pdf"};
      if (std::ranges::find(allowed, kind) == allowed.end())
        refuse_flag("--format", kind, "svg, png, pdf, several joined by commas" + meant(kind, allowed));
      if (std::ranges::find(style.kinds, kind) == style.kinds.end()) style.kinds.push_back(kind);
    }
  }
  for (const std::string& label : flags.label) {
    const std::size_t equals = label.find('=');
    const std::string axis = label.substr(0, equals);
    if (equals == std::string::npos || axis.empty() || equals + 1 == label.size())
      refuse_flag("--label", label, "AXIS=TEXT, AXIS the name that stands there, as in 'torque [N m]=Moment [N m]'");
    const std::string shown = label.substr(equals + 1);
    if (axis == "x" && !flags.label_axes.empty())
      style.x_label = shown;
    else if (axis == "y" && flags.label_axes == "xy")
      style.y_label = shown;
    else if (axis == "x" || axis == "y")
      refuse_flag("--label", label,
                  flags.label_axes.empty()
                      ? "an axis by the name that stands there, as in 'crank angle [deg]=Kurbelwinkel [Grad]'"
                      : "x=TEXT, what is swept; other axes by the name that stands there");
    else
      style.labels.push_back({axis, shown});
  }
  if (!flags.size.empty()) {
    const std::string allowed =
        fmt::format("WIDTHxHEIGHT in points, each {} to {}, as in 640x400", smallest_side, largest_side);
    const std::size_t x = flags.size.find('x');
    if (x == std::string::npos) refuse_flag("--size", flags.size, allowed);
    style.size = {integer_flag("--size", flags.size.substr(0, x), smallest_side, largest_side, allowed),
                  integer_flag("--size", flags.size.substr(x + 1), smallest_side, largest_side, allowed)};
  }
  return style;
}

}  // namespace

Output output(const CommonFlags& flags) {
  constexpr int max_threads = 1024;
  Output result;
  if (!flags.threads.empty()) {
    const int all = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, max_threads);
    result.threads = flags.threads == "all" ? all
                                            : integer_flag("--threads", flags.threads, 1, max_threads,
                                                           fmt::format("an integer 1 to {}, or all", max_threads));
  }
  if (flags.out) {
    // "--out --json" names no folder.
    if (flags.out->empty() || flags.out->front() == '-') refuse_flag("--out", *flags.out, "a folder (-x as ./-x)");
    result.folder = *flags.out;
  }
  if (flags.html) {
    if (!flags.out) refuse_flag("--html", "no --out", "beside --out DIR, which the page is written into");
    if (const std::string obstacle = report_obstacle(); !obstacle.empty()) throw UsageError("--html: " + obstacle);
  }
  result.html = flags.html;
  result.json = flags.json;
  result.pictures = picture_style(flags);
  result.stats = flags.stats;
  return result;
}

}  // namespace hb::tools
