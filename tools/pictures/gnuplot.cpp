#include "tools/pictures/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>

#include "tools/output/printable.hpp"
#include "tools/work/errors.hpp"
#include "tools/work/interrupts.hpp"

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
pdf(w, h) = sprintf("set terminal pdfcairo size %g,%g font 'DejaVu Sans,13' linewidth 1.2", w/72.0, h/72.0)
small(w, h) = sprintf("set terminal pngcairo size %d,%d font 'DejaVu Sans,11' linewidth 1.2", w, h)
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
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  const std::string text = contents(path);
  const std::size_t window = 64;
  return text.size() > window && text.find(end, text.size() - window) != std::string::npos;
}

// The moment of drawing is no part of the result; as long a date keeps the places of what follows.
std::string without_date(std::string pdf) {
  const std::string key = "/CreationDate (D:", fixed = "19700101000000";
  if (const std::size_t at = pdf.find(key); at != std::string::npos && at + key.size() + fixed.size() <= pdf.size())
    pdf.replace(at + key.size(), fixed.size(), fixed);
  return pdf;
}

// gnuplot writes > as it is, but ]]> may not stand in the text of XML.
std::string well_formed(std::string svg) {
  const std::string wrong = "]]>", right = "]]&gt;";
  for (std::size_t at = 0; (at = svg.find(wrong, at)) != std::string::npos; at += right.size())
    svg.replace(at, wrong.size(), right);
  return svg;
}

std::uintmax_t bytes_drawn(const fs::path& folder, const std::vector<Figure>& figures, const PictureKinds& kinds) {
  std::uintmax_t sum = 0;
  std::error_code error;
  for (const Figure& figure : figures) {
    for (const std::string& kind : kinds) {
      const std::uintmax_t size = fs::file_size(folder / (figure.name + "." + kind), error);
      if (!error) sum += size + 1;
    }
  }
  return sum;
}

// One line of what a program printed, whatever it was.
std::string printable_words(const std::string& words) {
  constexpr std::size_t most = 300;
  std::string line;
  for (const char c : words) {
    const bool blank = static_cast<unsigned char>(c) <= ' ' || c == 0x7f;
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  if (line.size() > most) line = line.substr(0, most) + " ...";
  return printable(line);
}

// gnuplot in a process group of its own: Ctrl-C reaches this program alone, which then ends the group.
class Child {
 public:
  Child(const fs::path& folder, const std::string& script) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
      throw OutputError(fmt::format("gnuplot cannot be started: {}", std::strerror(errno)));
    const SignalsHeld held;
    pid_ = fork();
    if (pid_ == 0) become_gnuplot(folder, script, ends[1]);
    close(ends[1]);
    output_ = ends[0];
    if (pid_ < 0) {
      close(output_);
      throw OutputError(fmt::format("gnuplot cannot be started: {}", std::strerror(errno)));
    }
    setpgid(pid_, pid_);
    killed_on_signal_.emplace(pid_);
    fcntl(output_, F_SETFL, O_NONBLOCK);
  }
  ~Child() {
    kill(-pid_, SIGKILL);  // and what it may have started
    if (!ended_) waitpid(pid_, &status_, 0);
    close(output_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // False if it was still running when `progress` had not changed for `patience`.
  bool wait(const std::function<std::uintmax_t()>& progress, std::chrono::milliseconds patience) {
    using Clock = std::chrono::steady_clock;
    constexpr int poll_interval = 20;  // ms
    std::uintmax_t last = progress();
    for (Clock::time_point changed = Clock::now();;) {
      read_output();
      const pid_t done = waitpid(pid_, &status_, WNOHANG);
      ended_ = done == pid_ || (done < 0 && errno != EINTR);
      if (ended_) break;
      if (const std::uintmax_t now = progress(); now != last) {
        last = now;
        changed = Clock::now();
      }
      if (Clock::now() - changed > patience) return false;
      poll(nullptr, 0, poll_interval);
    }
    read_output();
    return true;
  }

  const std::string& words() const { return words_; }
  bool not_found() const { return ended_ && WIFEXITED(status_) && WEXITSTATUS(status_) == no_program; }
  // Empty if it ended with status 0.
  std::string unusual_end() const {
    if (WIFSIGNALED(status_)) return fmt::format("ended by signal {}", WTERMSIG(status_));
    return WEXITSTATUS(status_) == 0 ? "" : fmt::format("exit status {}", WEXITSTATUS(status_));
  }

 private:
  static constexpr int no_program = 127;

  [[noreturn]] static void become_gnuplot(const fs::path& folder, const std::string& script, int sink) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::signal(SIGPIPE, SIG_DFL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    const int source = open("/dev/null", O_RDONLY);
    if (source < 0 || chdir(folder.c_str()) != 0) _exit(1);
    dup2(source, STDIN_FILENO);
    dup2(sink, STDOUT_FILENO);
    dup2(sink, STDERR_FILENO);
    execlp("gnuplot", "gnuplot", "--default-settings", script.c_str(), static_cast<char*>(nullptr));
    _exit(errno == ENOENT ? no_program : 1);
  }

  // The beginning is kept; the rest, however much it is, is read and forgotten.
  void read_output() {
    constexpr std::size_t most = 4096;
    constexpr int at_once = 256;  // blocks, lest a flood keeps this from looking at anything else
    char block[4096];
    for (int k = 0; k < at_once; ++k) {
      const ssize_t size = read(output_, block, sizeof block);
      if (size <= 0) return;
      words_.append(block, std::min(static_cast<std::size_t>(size), most - std::min(most, words_.size())));
    }
  }

  pid_t pid_ = -1;
  int output_ = -1, status_ = 0;
  bool ended_ = false;
  std::string words_;
  std::optional<RunningChild> killed_on_signal_;
};

void rename_axis(std::string& commands, const char* set, const std::string& own, const std::string& given) {
  if (own.empty() || given.empty()) return;
  const std::string before = set + own, after = set + quoted(given);
  for (std::size_t at = 0; (at = commands.find(before, at)) != std::string::npos; at += after.size())
    commands.replace(at, before.size(), after);
}

// A quoted text as it is shown, without its marks for subscripts and escapes.
std::string as_shown(const std::string& text) {
  std::string shown;
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] == '\\' && k + 1 < text.size())
      shown += text[++k];
    else if (text[k] == '\'' && k + 1 < text.size() && text[k + 1] == '\'')
      shown += text[k++];
    else if (text[k] != '{' && text[k] != '}')
      shown += text[k];
  }
  return shown;
}

// Calls `change(name)` for the quoted text of every axis in the commands and puts what it gives in its place.
void for_each_axis(std::string& commands, const std::function<std::string(const std::string& quoted_text)>& change) {
  for (const std::string& set :
       {std::string("set xlabel '"), std::string("set ylabel '"), std::string("set cblabel '")})
    for (std::size_t at = 0; (at = commands.find(set, at)) != std::string::npos;) {
      const std::size_t begin = at + set.size();
      std::size_t end = begin;
      while (end < commands.size() &&
             (commands[end] != '\'' || (end + 1 < commands.size() && commands[end + 1] == '\'')))
        end += commands[end] == '\'' ? 2 : 1;
      const std::string text = change(commands.substr(begin, end - begin));
      commands.replace(begin, end - begin, text);
      at = begin + text.size();
    }
}

void rename_axes(std::string& commands, const std::vector<PictureStyle::Label>& labels) {
  if (labels.empty()) return;
  for_each_axis(commands, [&](const std::string& text) {
    for (const PictureStyle::Label& label : labels)
      if (as_shown(text) == label.name) return literal(label.shown);
    return text;
  });
}

}  // namespace

std::vector<std::string> axis_names(const std::vector<Figure>& figures) {
  std::vector<std::string> names;
  for (const Figure& figure : figures) {
    std::string commands = figure.commands;
    for_each_axis(commands, [&](const std::string& text) {
      if (const std::string name = as_shown(text); std::ranges::find(names, name) == names.end()) names.push_back(name);
      return text;
    });
  }
  return names;
}

std::string literal(const std::string& text) {
  std::string result;
  for (const char c : printable(text)) {
    if (c == '\n') {
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

std::string plot_script(const std::vector<Figure>& figures, const PictureStyle& style) {
  std::string script = preamble;
  script += style.titles ? "heading(text) = text\n" : "heading(text) = ''\n";
  for (const Figure& figure : figures) {
    std::string commands = figure.commands;
    rename_axis(commands, "set xlabel ", figure.x_label, style.x_label);
    rename_axis(commands, "set ylabel ", figure.y_label, style.y_label);
    rename_axes(commands, style.labels);
    script += fmt::format(
        "\ndo for [kind in '{4}'] {{\n"
        "eval (kind eq 'svg') ? svg({0}, {1}) : (kind eq 'png') ? png({0}, {1}) : (kind eq 'pdf') ? pdf({0}, {1}) : "
        "small({0}, {1})\n"
        "set output '{2}.'.kind\n"
        "{3}"
        "set output\n"
        "}}\n",
        style.size ? style.size->width : figure.width, style.size ? style.size->height : figure.height, figure.name,
        commands, fmt::join(style.kinds, " "));
  }
  return script;
}

std::string script_name(const std::string& command) { return command + ".gp"; }

PlotOutcome run_gnuplot(const fs::path& folder, const std::string& script, const std::vector<Figure>& figures,
                        std::chrono::milliseconds patience, const PictureKinds& kinds) {
  PlotOutcome outcome;
  Child gnuplot(folder, script);
  const bool ended = gnuplot.wait([&] { return bytes_drawn(folder, figures, kinds); }, patience);
  outcome.no_gnuplot = gnuplot.not_found();
  outcome.words = printable_words(gnuplot.words());
  if (!ended) {
    outcome.words = fmt::format("it was ended after {} s without a new picture{}{}",
                                std::chrono::duration<double>(patience).count(),
                                outcome.words.empty() ? "" : "; it said: ", outcome.words);
  } else if (const std::string end = gnuplot.unusual_end(); !end.empty()) {
    outcome.words = outcome.words.empty() ? end : fmt::format("{}: {}", end, outcome.words);
  }
  for (const Figure& figure : figures) {
    const bool whole = std::all_of(kinds.begin(), kinds.end(), [&](const std::string& kind) {
      return complete(folder / (figure.name + "." + kind), kind == "svg" ? "</svg>" : kind == "pdf" ? "%%EOF" : "IEND");
    });
    if (!whole) outcome.missing.push_back(figure.name);
  }
  return outcome;
}

bool draw_figures(const std::vector<Figure>& figures, OutputFolder& folder, const PictureStyle& style) {
  const std::string script = script_name(folder.command());
  const fs::path place = folder.scratch_with_links();
  const PlotOutcome outcome = run_gnuplot(place, script, figures, std::chrono::seconds(30), style.kinds);
  for (const Figure& figure : figures) {
    const bool missing =
        std::find(outcome.missing.begin(), outcome.missing.end(), figure.name) != outcome.missing.end();
    for (const std::string& kind : style.kinds) {
      const std::string file = figure.name + "." + kind;
      if (missing) {
        folder.drop(file);
      } else {
        const std::string picture = contents(place / file);
        folder.write(file, kind == "svg" ? well_formed(picture) : kind == "pdf" ? without_date(picture) : picture);
      }
    }
  }
  folder.commit();
  if (outcome.complete()) return true;
  const std::string again = fmt::format("`gnuplot {}` in {} draws them", script, folder.path().string());
  if (outcome.no_gnuplot) {
    fmt::print(stderr, "hb {}: no pictures: gnuplot is not installed; {}\n", folder.command(), again);
  } else {
    fmt::print(stderr, "hb {}: {} of {} pictures missing: {}; {}\n", folder.command(), outcome.missing.size(),
               figures.size(), outcome.words.empty() ? "gnuplot did not write them" : "gnuplot: " + outcome.words,
               again);
  }
  return false;
}

}  // namespace hb::tools
