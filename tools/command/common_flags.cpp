#include "tools/command/common_flags.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <thread>

#include "lib/scene/scene_keys.hpp"
#include "tools/command/command.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/report/report_page.hpp"
#include "tools/work/interrupts.hpp"

namespace hb::tools {
namespace {

constexpr int max_threads = 1024;

[[noreturn]] void refuse(const std::string& flag, const std::string& found, const std::string& allowed) {
  throw UsageError(fmt::format("{}: found \"{}\", allowed: {}", flag, found, allowed));
}

// The whole text as a number, or nothing.
template <class Number>
std::optional<Number> parse(const std::string& text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

// " (verdict meant?)", or nothing.
std::string meant(const std::string& found, const std::vector<std::string>& names) {
  const std::string near = nearest_name(found, names);
  return near.empty() ? "" : fmt::format(" ({} meant?)", near);
}

// What is likely wrong with a text that is no number.
std::string number_hint(const std::string& text) {
  const auto digits = [](const std::string& part) {
    return !part.empty() && std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
  };
  if (const std::size_t comma = text.find(','); comma != std::string::npos && digits(text.substr(comma + 1)))
    return "; the decimal point is a point: " + text.substr(0, comma) + "." + text.substr(comma + 1);
  const std::size_t unit = text.find_first_not_of("0123456789.+eE");
  if (unit != std::string::npos && unit > 0 && parse<double>(text.substr(0, unit)) && std::isalpha(text[unit]))
    return fmt::format("; without a unit: {}", text.substr(0, unit));
  return "";
}

template <class Enum>
Enum choice_flag(const std::string& flag, const std::string& text,
                 const std::vector<std::pair<const char*, Enum>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (text == name) return value;
    names.push_back(name);
  }
  refuse(flag, text, fmt::format("{}{}", fmt::join(names, ", "), meant(text, names)));
}

std::variant<int, AutoModes> modes_flag(const std::string& text) {
  if (text == "auto") return AutoModes{};
  return integer_flag("--modes", text, 1, max_modes, fmt::format("an integer 1 to {}, or auto", max_modes));
}

Only only_flag(const std::string& text, bool growth_alone) {
  std::vector<std::string> allowed = {"steady", "stability", "reactions", "shape"};
  if (growth_alone) allowed.insert(allowed.begin() + 2, {"growth", "verdict"});
  const std::vector<std::string> names = list_flag("--only", text);
  for (const std::string& name : names)
    if (std::ranges::find(allowed, name) == allowed.end())
      refuse("--only", name,
             fmt::format("{}, several joined by commas{}", fmt::join(allowed, ", "), meant(name, allowed)));
  return only_of(names);
}

// "A:B:STEP", "A:B:xN" or "N", positive; `single`: only the last.
Speeds speeds_flag(const std::string& flag, const std::string& text, bool single) {
  std::string allowed = fmt::format("a positive number, {:g} to {:g}{}", slowest, fastest,
                                    single ? "" : ", FROM:TO:STEP or FROM:TO:xN with FROM <= TO, STEP > 0, N points");
  if (text.starts_with('-')) {
    allowed +=
        "; a crank turns counter-clockwise: for the other way mirror the scene about the x axis (the signs of "
        "gravity, of every y, angle and branch)";
  }
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() == 3 && single) refuse(flag, text, "one speed, " + allowed);
  if (!single && parts.size() == 2) allowed += "; a step is missing: " + text + ":10 or " + text + ":x50";
  if (const std::size_t dash = text.find('-', 1); !single && parts.size() == 1 && dash != std::string::npos &&
                                                  parse<double>(text.substr(0, dash)) &&
                                                  parse<double>(text.substr(dash + 1)))
    allowed += fmt::format("; a range is {}:{}:10", text.substr(0, dash), text.substr(dash + 1));
  if (parts.size() == 1) allowed += number_hint(text);
  if (parts.size() != 1 && parts.size() != 3) refuse(flag, text, allowed);
  const std::optional<std::size_t> count = parts.size() == 3 ? point_count(flag, text, parts[2]) : std::nullopt;
  if (count) parts.pop_back();
  std::vector<double> numbers;
  for (const std::string& part : parts) {
    const std::optional<double> value = parse<double>(part);
    if (!value || !(*value >= slowest && *value <= fastest)) refuse(flag, text, allowed);
    numbers.push_back(*value);
  }
  if (numbers.size() == 1) return {numbers[0], numbers[0], 0};
  if (!(numbers[0] <= numbers[1])) refuse(flag, text, allowed);
  if (!count) return {numbers[0], numbers[1], numbers[2]};
  const int N = static_cast<int>(*count);
  return {numbers[0], numbers[1], (numbers[1] - numbers[0]) / (N - 1), N};
}

SpeedRange speeds_of_flags(const CommonFlags& flags, const Scene& scene, bool single) {
  if (!flags.rpm.empty() && !flags.omega.empty()) {
    throw UsageError(
        fmt::format("--omega: found \"{}\" beside --rpm {}, allowed: one of the two", flags.omega, flags.rpm));
  }
  if (!flags.rpm.empty()) return {speeds_flag("--rpm", flags.rpm, single), true};
  if (!flags.omega.empty()) return {speeds_flag("--omega", flags.omega, single), false};
  if (scene.analysis.rpm) return {*scene.analysis.rpm, true};
  if (scene.analysis.omega) return {*scene.analysis.omega, false};
  throw UsageError(fmt::format(
      "--rpm: no speed given, and {} has none under [analysis]; allowed: --rpm N, or --omega W (rad per {})",
      scene.file.string(), scene.units.time));
}

// An empty text stands for a flag that was not given: one that is given has something to say.
void add_value(CLI::App& app, const char* name, std::string& text, const char* meaning, const char* type) {
  app.add_option(name, text, meaning)->type_name(type)->check([](const std::string& value) {
    return value.empty() ? std::string("found \"\", allowed: a value") : std::string();
  });
}

void start_time_limit(const CommonFlags& flags) {
  if (flags.time_limit.empty()) return;
  const double seconds = number_flag("--time-limit", flags.time_limit, 1e-3, 1e8, "seconds from 0.001 to 1e8");
  const std::string note = fmt::format("the time limit of {:g} s was reached before there was an answer", seconds);
  end_after(seconds, exit_not_reached, fmt::format("hb: {}\n", note),
            flags.json ? fmt::format("{{\"status\":\"tolerance not reached\",\"notes\":[\"{}\"]}}\n", note) : "");
}

}  // namespace

double number_flag(const std::string& flag, const std::string& text, double lowest, double highest,
                   const std::string& allowed) {
  const std::optional<double> value = parse<double>(text);
  if (!value || !(*value >= lowest && *value <= highest)) refuse(flag, text, allowed + number_hint(text));
  return *value;
}

int integer_flag(const std::string& flag, const std::string& text, int lowest, int highest,
                 const std::string& allowed) {
  const std::optional<int> value = parse<int>(text);
  if (!value || *value < lowest || *value > highest) refuse(flag, text, allowed);
  return *value;
}

std::vector<std::string> list_flag(const std::string& flag, const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  for (const std::string& part : parts) {
    if (part.empty()) refuse(flag, text, "names joined by single commas");
  }
  return parts;
}

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
  app.add_option("--out", flags.out, "write CSV and pictures (SVG, PNG) into this folder")->type_name("DIR");
  app.add_flag("--json", flags.json, "one JSON document on standard output, nothing else there");
  app.add_flag("--no-plots", flags.no_plots, "no pictures in the folder of --out");
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

std::string in_flags(const RequestError& error) {
  // Other fields (a metric such as stress:AB) are texts of the command line already.
  static const std::map<std::string, std::string> flag_of = {
      {"rods", "--rods"},         {"modes", "--modes"},       {"tolerance", "--tol"}, {"rpm", "--rpm"},
      {"omega", "--omega"},       {"only", "--only"},         {"vary", "--vary"},     {"keep", "--keep"},
      {"minimise", "--minimise"}, {"maximise", "--maximise"}, {"height", "--height"}, {"theory", "--theory"}};
  const auto flag = flag_of.find(error.field);
  std::string text = flag == flag_of.end() ? error.field : flag->second;
  if (!text.empty()) text += ": ";
  for (const char c : error.sentence) text += c == '@' ? std::string("--") : std::string(1, c);
  return text;
}

std::vector<Override> overrides(const CommonFlags& flags) {
  std::vector<Override> result;
  for (const std::string& text : flags.set) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      refuse("--set", text, "PATH=VALUE, as in AB.J=60");
    }
    result.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return result;
}

Settings settings(const CommonFlags& flags, const Scene& scene) {
  Settings result;
  result.modes = flags.modes.empty() ? scene.analysis.modes : modes_flag(flags.modes);
  const auto* hill = std::get_if<HillSystem>(&scene.model);
  if (hill) {
    const int size = static_cast<int>(hill->num_modes());
    const int* asked = std::get_if<int>(&result.modes);
    if (asked && *asked != size) refuse("--modes", flags.modes, fmt::format("{}, the size of [hill] mass", size));
    result.modes = size;
  }
  result.tolerance = flags.tolerance.empty()
                         ? scene.analysis.tolerance
                         : number_flag("--tol", flags.tolerance, 1e-14, 0.1, "a number from 1e-14 to 0.1");
  if (!flags.rods.empty()) result.rods = list_flag("--rods", flags.rods);
  if (!flags.only.empty()) result.only = only_flag(flags.only, flags.growth_alone);
  if (hill && !result.only.steady && !result.only.stability) {
    refuse("--only", flags.only, "steady, stability: a [hill] scene has no joints and no shape");
  }
  if (!flags.steady_method.empty()) {
    result.steady_method = choice_flag<SteadyMethod>("--steady-method", flags.steady_method,
                                                     {{"automatic", SteadyMethod::automatic},
                                                      {"direct", SteadyMethod::direct},
                                                      {"iterative", SteadyMethod::iterative}});
  }
  if (!flags.bound.empty()) {
    result.bound = choice_flag<SteadyBound>("--bound", flags.bound,
                                            {{"estimated", SteadyBound::estimated}, {"proved", SteadyBound::proved}});
  }
  if (!flags.stability_method.empty()) {
    result.stability_method = choice_flag<StabilityMethod>("--stability-method", flags.stability_method,
                                                           {{"automatic", StabilityMethod::automatic},
                                                            {"hill", StabilityMethod::hill},
                                                            {"slaving", StabilityMethod::slaving},
                                                            {"propagation", StabilityMethod::propagation},
                                                            {"determinant", StabilityMethod::determinant},
                                                            {"bound", StabilityMethod::bound}});
  }
  return result;
}

Output output(const CommonFlags& flags) {
  Output result;
  if (!flags.threads.empty()) {
    const int all = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, max_threads);
    result.threads = flags.threads == "all" ? all
                                            : integer_flag("--threads", flags.threads, 1, max_threads,
                                                           fmt::format("an integer 1 to {}, or all", max_threads));
  }
  if (flags.out) {
    // "--out --json" names no folder.
    if (flags.out->empty() || flags.out->front() == '-') refuse("--out", *flags.out, "a folder (-x as ./-x)");
    result.folder = *flags.out;
  }
  if (flags.html) {
    if (!flags.out) refuse("--html", "no --out", "beside --out DIR, which the page is written into");
    if (const std::string obstacle = report_obstacle(); !obstacle.empty()) throw UsageError("--html: " + obstacle);
  }
  result.html = flags.html;
  result.json = flags.json;
  result.plots = !flags.no_plots;
  result.stats = flags.stats;
  return result;
}

SpeedRange speed_range(const CommonFlags& flags, const Scene& scene) { return speeds_of_flags(flags, scene, false); }

SpeedRange several_speeds(const CommonFlags& flags, const Scene& scene) {
  const SpeedRange range = speed_range(flags, scene);
  if (range.speeds.from < range.speeds.to) return range;
  const std::string name = range.in_rpm ? "rpm" : "omega";
  if (!flags.rpm.empty() || !flags.omega.empty()) {
    throw UsageError(
        fmt::format("--{}: found the single speed {}, allowed: a range FROM:TO:STEP or FROM:TO:xN (hb steady "
                    "does one speed)",
                    name, range.speeds.from));
  }
  throw UsageError(
      fmt::format("--{0}: not given, and the scene's [analysis] has the single speed {0} = {1}; allowed: "
                  "--{0} FROM:TO:STEP (or FROM:TO:xN), or {0} = [from, to, step] in the scene",
                  name, range.speeds.from));
}

std::vector<double> speed_values(const SpeedRange& range) {
  const Speeds& speeds = range.speeds;
  const std::string flag = range.in_rpm ? "--rpm" : "--omega";
  if (speeds.count > 0) return range_by_count(flag, speeds.from, speeds.to, static_cast<std::size_t>(speeds.count));
  return range_by_step(flag, speeds.from, speeds.to, speeds.step);
}

SpeedRange first_speed(const CommonFlags& flags, const Scene& scene) {
  SpeedRange range = speeds_of_flags(flags, scene, true);
  range.speeds = {range.speeds.from, range.speeds.from, 0};
  return range;
}

double single_speed(const CommonFlags& flags, const Scene& scene) {
  const auto [speeds, in_rpm] = first_speed(flags, scene);
  return in_rpm ? speed_from_rpm(speeds.from, scene.units) : speeds.from;
}

}  // namespace hb::tools
