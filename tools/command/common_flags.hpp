// Flags that the subcommands share, and what they mean beside a scene's [analysis]: flags win.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hb::tools {

// As written on the command line; an empty text is a flag that was not given.
struct CommonFlags {
  std::string scene_file;
  std::string line;  // the whole command, see command_line
  std::string time_limit;
  std::string format, size;  // of pictures
  std::string modes, tolerance, rods, only, rpm, omega, threads, steady_method, stability_method, bound;
  std::optional<std::string> out;
  std::vector<std::string> set;
  std::vector<std::string> label;
  std::string label_axes;  // that --label may name by these letters: "", "x", "xy"
  bool json = false, no_plots = false, no_titles = false, stats = false, html = false;
  bool growth_alone = false;  // the command takes --only growth and --only verdict
};

// SCENE, --set, --out, --json, --no-plots, --format, --size, --no-titles, --label, --stats, --time-limit: for every
// subcommand.
void add_scene_flags(CLI::App& app, CommonFlags& flags);
// --modes, --tol, --rods, --only, --rpm, --omega, --threads, --steady-method, --stability-method.
enum class SpeedsTaken { one, range };
void add_analysis_flags(CLI::App& app, CommonFlags& flags, SpeedsTaken speeds = SpeedsTaken::range);
// --html: a page of the results beside the other files of --out.
void add_html_flag(CLI::App& app, CommonFlags& flags);
// --band: how the answer moves with damping, E or mass.
void add_band_flag(CLI::App& app, std::vector<std::string>& bands);
// --measured: values that pictures show beside the computed ones.
void add_measured_flag(CLI::App& app, std::string& file, const char* where);
// --bound: for single speeds.
void add_single_speed_flags(CLI::App& app, CommonFlags& flags);
// --only growth and --only verdict are for this command.
void allow_growth_alone(CLI::App& app, CommonFlags& flags);

}  // namespace hb::tools
