#include "tools/command/output_flags.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <thread>

#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/report/report_page.hpp"

namespace hb::tools {

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
  result.plots = !flags.no_plots;
  result.stats = flags.stats;
  return result;
}

}  // namespace hb::tools
