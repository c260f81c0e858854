#include "tools/command/common_flags.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "tools/command/command.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/output/speaker.hpp"
#include "tools/work/interrupts.hpp"

namespace hb::tools {
namespace {

// An empty text stands for a flag that was not given: one that is given has something to say.
void add_value(CLI::App& app, const char* name, std::string& text, const char* meaning, const char* type) {
  app.add_option(name, text, meaning)->type_name(type)->check([](const std::string& value) {
    return value.empty() ? std::string("found \"\", allowed: a value") : std::string();
  });
}

void start_time_limit(const CommonFlags& flags) {
  if (flags.time_limit.empty()) return;
  const double seconds = seconds_flag("--time-limit", flags.time_limit, 1e8);
  const std::string note = fmt::format("the time limit of {:g} s was reached before there was an answer", seconds);
  end_after(seconds, exit_not_reached, fmt::format("{}: {}\n", speaker(), note),
            flags.json ? fmt::format("{{\"status\":\"tolerance not reached\",\"notes\":[\"{}\"]}}\n", note) : "");
}

}  // namespace

void add_scene_flags(CLI::App& app, CommonFlags& flags) {
  app.add_option("SCENE", flags.scene_file, "scene file (TOML), - for standard input")->required();
  app.parse_complete_callback([&app, &flags] {
    flags.line = command_line(app);
    start_time_limit(flags);
  });
  app.add_option("--set", flags.set, "replace a scene number for this run, as in AB.J=60 or *.J=60; repeatable")
      ->type_name("PATH=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--out", flags.out, "write CSV and pictures into this folder")->type_name("DIR");
  app.add_flag("--json", flags.json, "one JSON document on standard output, nothing else there");
  app.add_flag("--no-plots", flags.no_plots, "no pictures in the folder of --out");
  add_value(app, "--format", flags.format,
            "kinds of pictures: svg, png, pdf, several joined by commas; default svg,png", "LIST");
  add_value(app, "--size", flags.size, "width and height of every picture in points, as in 640x400", "WxH");
  app.add_flag("--no-titles", flags.no_titles, "pictures without titles, for texts that have their own captions");
  app.add_option("--label", flags.label,
                 "another name of an axis in pictures: 'torque [N m]=Moment [N m]'; of sweep x=, of map x=, y= too; "
                 "repeatable")
      ->type_name("AXIS=TEXT")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_flag("--stats", flags.stats, "what was computed, what was skipped, times");
  add_value(app, "--time-limit", flags.time_limit,
            "end after S seconds with what is there, and with exit status 3 where that is not all", "S");
}

void add_html_flag(CLI::App& app, CommonFlags& flags) {
  app.add_flag("--html", flags.html, "write DIR/report.html, one page that moves, beside --out DIR");
}

void add_single_speed_flags(CLI::App& app, CommonFlags& flags) {
  add_value(app, "--bound", flags.bound, "error bound: estimated, or proved where a proof is found", "KIND");
}

void allow_growth_alone(CLI::App& app, CommonFlags& flags) {
  flags.growth_alone = true;
  app.get_option("--only")->description(
      "compute only these: steady,stability,reactions,shape, growth (of stability the growth rate alone), verdict");
}

void add_band_flag(CLI::App& app, std::vector<std::string>& bands) {
  app.add_option("--band", bands,
                 "how the answer moves with damping=0.5:2, E=0.9:1.1 or mass=0.9:1.1 of the elastic links (factors); "
                 "repeatable")
      ->type_name("NAME=A:B")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_measured_flag(CLI::App& app, std::string& file, const char* where) {
  app.add_option(
         "--measured", file,
         fmt::format("CSV of measured values {} for the pictures, columns by name: deflection AB, torque, ...", where))
      ->type_name("FILE");
}

void add_analysis_flags(CLI::App& app, CommonFlags& flags, SpeedsTaken taken) {
  const auto add = [&](const char* name, std::string& text, const char* meaning, const char* type) {
    add_value(app, name, text, meaning, type);
  };
  add("--modes", flags.modes, "Ritz terms per elastic link, 1 to 60, or auto", "I");
  add("--tol", flags.tolerance, "relative error wanted, 1e-14 to 0.1", "T");
  add("--rods", flags.rods, "elastic links to look at, as in AB,CD; default all", "NAMES");
  add("--only", flags.only, "compute only these: steady,stability,reactions,shape", "LIST");
  const bool one = taken == SpeedsTaken::one;
  const char* speeds = one ? "N" : "A:B:STEP|A:B:xN";
  add("--rpm", flags.rpm,
      one ? "speed of the crank in revolutions per minute; default the scene's (its first)"
          : "speeds of the crank in revolutions per minute, by step or by number of points; default the "
            "scene's",
      speeds);
  add("--omega", flags.omega, "the same in rad per the scene's unit of time", speeds);
  add("--threads", flags.threads, "number of threads, 1 or more, or all", "N");
  add("--steady-method", flags.steady_method, "automatic, direct or iterative", "METHOD");
  add("--stability-method", flags.stability_method, "automatic, hill, slaving, propagation, determinant or bound",
      "METHOD");
}

}  // namespace hb::tools
