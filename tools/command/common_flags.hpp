// Flags that the subcommands share, and what they mean beside a scene's [analysis]: flags win.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hb/analysis/request.hpp"
#include "lib/scene/scene.hpp"

namespace CLI {
class App;
}

namespace hb::tools {

// As written on the command line; an empty text is a flag that was not given.
struct CommonFlags {
  std::string scene_file;
  std::string line;  // the whole command, see command_line
  std::string time_limit;
  std::string modes, tolerance, rods, only, rpm, omega, threads, steady_method, stability_method, bound;
  std::optional<std::string> out;
  std::vector<std::string> set;
  bool json = false, no_plots = false, stats = false, html = false;
  bool growth_alone = false;  // the command takes --only growth and --only verdict
};

// Where the answer goes, and with how many threads it is computed.
struct Output {
  std::optional<std::filesystem::path> folder;  // for CSV and pictures
  bool json = false, plots = true, stats = false, html = false;
  int threads = 1;
};

// SCENE, --set, --out, --json, --no-plots, --stats: for every subcommand.
void add_scene_flags(CLI::App& app, CommonFlags& flags);
// --modes, --tol, --rods, --only, --rpm, --omega, --threads, --steady-method, --stability-method.
enum class SpeedsTaken { one, range };
void add_analysis_flags(CLI::App& app, CommonFlags& flags, SpeedsTaken speeds = SpeedsTaken::range);
// --html: a page of the results beside the other files of --out.
void add_html_flag(CLI::App& app, CommonFlags& flags);
// --bound: for single speeds.
void add_single_speed_flags(CLI::App& app, CommonFlags& flags);
// --only growth and --only verdict are for this command.
void allow_growth_alone(CLI::App& app, CommonFlags& flags);

// A refused request in the words of the command line: fields as flags.
[[nodiscard]] std::string in_flags(const RequestError& error);

// --set as overrides; throws UsageError unless each is PATH=VALUE.
[[nodiscard]] std::vector<Override> overrides(const CommonFlags& flags);

// Flags over [analysis]; throws UsageError naming the flag, the value found and what is allowed.
[[nodiscard]] Settings settings(const CommonFlags& flags, const Scene& scene);
[[nodiscard]] Output output(const CommonFlags& flags);

// Speeds of --rpm, --omega or the scene's [analysis], in rpm when given so. One scene serves all commands: a range in
// the scene gives its first speed where one is wanted.
struct SpeedRange {
  Speeds speeds;
  bool in_rpm = true;  // else rad per unit time
};
[[nodiscard]] SpeedRange speed_range(const CommonFlags& flags, const Scene& scene);
// A range; throws UsageError at a single speed, telling what to add.
[[nodiscard]] SpeedRange several_speeds(const CommonFlags& flags, const Scene& scene);
// Every speed of a range, in its own unit.
[[nodiscard]] std::vector<double> speed_values(const SpeedRange& range);
// One speed: of a range in the scene the first; throws UsageError where a flag gives a range.
[[nodiscard]] SpeedRange first_speed(const CommonFlags& flags, const Scene& scene);
// The same in rad per unit time.
[[nodiscard]] double single_speed(const CommonFlags& flags, const Scene& scene);

// A finite number that satisfies lowest <= value <= highest; else UsageError with `allowed`.
[[nodiscard]] double number_flag(const std::string& flag, const std::string& text, double lowest, double highest,
                                 const std::string& allowed);
[[nodiscard]] int integer_flag(const std::string& flag, const std::string& text, int lowest, int highest,
                               const std::string& allowed);
// Parts of "a,b,c"; an empty part is a UsageError.
[[nodiscard]] std::vector<std::string> list_flag(const std::string& flag, const std::string& text);

}  // namespace hb::tools
