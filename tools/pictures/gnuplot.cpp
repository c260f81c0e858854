#include "tools/pictures/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "tools/command/command.hpp"

namespace hb::tools {
namespace fs = std::filesystem;
namespace {

// Colours that colour-blind readers tell apart (Okabe and Ito), dark ones first; grey for what stands behind.
constexpr const char* preamble = R"(# Draws the pictures of this folder from its CSV files: gnuplot FILE
set encoding utf8
set datafile separator ','
set datafile columnheaders
svg(w, h) = sprintf("set terminal svg size %d,%d font 'DejaVu Sans,13' background 'white' linewidth 1.2", w, h)
png(w, h) = sprintf("set terminal pngcairo size %d,%d font 'DejaVu Sans,13' fontscale 2 linewidth 2.4 pointscale 2", 2*w, 2*h)
set border 3 linecolor '#444444'
set tics nomirror textcolor '#222222'
set grid linecolor '#c8c8c8' linewidth 0.6
# The next of 1, 2, 5, 10, 20, ... that is not below r: a distance of tics.
nice(r) = (nice_e = 10.0**floor(log10(r)), nice_m = r/nice_e, nice_e*(nice_m <= 1 ? 1 : nice_m <= 2 ? 2 : nice_m <= 5 ? 5 : 10))
set linetype 1 linecolor '#0072b2' linewidth 1.6 pointtype 7
set linetype 2 linecolor '#d55e00' linewidth 1.6 pointtype 5
set linetype 3 linecolor '#009e73' linewidth 1.6 pointtype 9
set linetype 4 linecolor '#cc79a7' linewidth 1.6 pointtype 11
set linetype 5 linecolor '#e69f00' linewidth 1.6 pointtype 13
set linetype 6 linecolor '#56b4e9' linewidth 1.6 pointtype 3
set linetype 7 linecolor '#000000' linewidth 1.6 pointtype 1
set linetype cycle 7
)";

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// A picture that a full disk cut short lacks its end.
bool complete(const fs::path& path, const std::string& end) {
  const std::string text = contents(path);
  const std::size_t window = 64;
  return text.size() > window && text.find(end, text.size() - window) != std::string::npos;
}

}  // namespace

std::string literal(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < ' ') {
      result += ' ';
    } else if (c == '\'') {
      result += "''";
    } else {
      if (std::strchr("_^{}@&~\\", c) != nullptr) result += '\\';
      result += c;
    }
  }
  return result;
}

std::string quoted(const std::string& text) { return fmt::format("'{}'", literal(text)); }

std::string plot_script(const std::vector<Figure>& figures) {
  std::string script = preamble;
  for (const Figure& figure : figures) {
    script += fmt::format(
        "\ndo for [kind in 'svg png'] {{\n"
        "eval (kind eq 'svg') ? svg({0}, {1}) : png({0}, {1})\n"
        "set output '{2}.'.kind\n"
        "{3}"
        "set output\n"
        "}}\n",
        figure.width, figure.height, figure.name, figure.commands);
  }
  return script;
}

PlotStatus run_gnuplot(const fs::path& folder, const std::string& script, const std::vector<Figure>& figures) {
  constexpr int no_program = 127;
  const fs::path log = folder / ".gnuplot.log";
  const pid_t child = fork();
  if (child < 0) throw OutputError(fmt::format("gnuplot cannot be started: {}", std::strerror(errno)));
  if (child == 0) {
    const int sink = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int source = open("/dev/null", O_RDONLY);
    if (sink < 0 || source < 0 || chdir(folder.c_str()) != 0) _exit(1);
    dup2(source, STDIN_FILENO);
    dup2(sink, STDOUT_FILENO);
    dup2(sink, STDERR_FILENO);
    execlp("gnuplot", "gnuplot", "--default-settings", script.c_str(), static_cast<char*>(nullptr));
    _exit(errno == ENOENT ? no_program : 1);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::string words = contents(log);
  std::error_code ignored;
  fs::remove(log, ignored);
  if (WIFEXITED(status) && WEXITSTATUS(status) == no_program) return PlotStatus::no_gnuplot;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw OutputError("--out: gnuplot failed: " + words);
  for (const Figure& figure : figures) {
    if (!complete(folder / (figure.name + ".svg"), "</svg>") || !complete(folder / (figure.name + ".png"), "IEND")) {
      throw OutputError(fmt::format("--out: picture {} was not written whole{}{}", figure.name,
                                    words.empty() ? "" : "; gnuplot says: ", words));
    }
  }
  return PlotStatus::drawn;
}

void draw_figures(const std::vector<Figure>& figures, OutputFolder& folder, bool draw) {
  if (figures.empty() || !draw) return;
  folder.write("plots.gp", plot_script(figures));
  if (run_gnuplot(folder.scratch(), "plots.gp", figures) == PlotStatus::no_gnuplot) {
    fmt::print(stderr, "hb: no pictures: gnuplot is not installed; plots.gp beside the CSV files draws them\n");
  }
}

}  // namespace hb::tools
