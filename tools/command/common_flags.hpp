// Flags that the subcommands share, and what they mean beside a scene's [analysis]: flags win.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/scene/scene.hpp"

namespace CLI {
class App;
}

namespace hb::tools {

// As written on the command line; an empty text is a flag that was not given.
struct CommonFlags {
  std::string scene_file;
  std::string modes, tolerance, rods, only, rpm, omega, threads, steady_method, stability_method, bound;
  std::optional<std::string> out;
  std::vector<std::string> set;
  bool json = false, no_plots = false, stats = false;
  bool single_speed = false;  // the command looks at one speed: --only verdict is allowed
};

// What is asked for; only that is computed.
struct Only {
  bool steady = true;  // Fourier coefficients and peaks of q
  bool stability = true;  // exponents and verdict
  bool reactions = true;  // joint forces and driving torque
  bool shape = true;  // deflection and bending moment
  bool verdict = false;  // of stability the verdict alone, from bounds where they prove it
};

struct Settings {
  std::variant<int, AutoModes> modes = 5;
  double tolerance = 1e-10;
  std::vector<std::string> rods;  // names asked for; empty: all
  Only only;
  std::optional<std::filesystem::path> out;  // folder for CSV and pictures
  bool json = false, plots = true, stats = false;
  int threads = 1;
  SteadyMethod steady_method = SteadyMethod::automatic;
  SteadyBound bound = SteadyBound::estimated;
  StabilityMethod stability_method = StabilityMethod::automatic;
};

// SCENE, --set, --out, --json, --no-plots, --stats: for every subcommand.
void add_scene_flags(CLI::App& app, CommonFlags& flags);
// --modes, --tol, --rods, --only, --rpm, --omega, --threads, --steady-method, --stability-method.
void add_analysis_flags(CLI::App& app, CommonFlags& flags);
// --bound, and --only verdict: for single speeds.
void add_single_speed_flags(CLI::App& app, CommonFlags& flags);

// --set as overrides; throws UsageError unless each is PATH=VALUE.
[[nodiscard]] std::vector<Override> overrides(const CommonFlags& flags);

// Flags over [analysis]; throws UsageError naming the flag, the value found and what is allowed.
[[nodiscard]] Settings settings(const CommonFlags& flags, const Scene& scene);

// The one speed of --rpm, --omega or the scene, rad per unit time; throws UsageError when it is missing, given twice
// or a range.
[[nodiscard]] double single_speed(const CommonFlags& flags, const Scene& scene);

// --rpm A:B:STEP or N, --omega alike, or the scene's; in rpm when given so, the bool says which.
struct SpeedRange {
  Speeds speeds;
  bool in_rpm = true;  // else rad per unit time
};
[[nodiscard]] SpeedRange speed_range(const CommonFlags& flags, const Scene& scene);

// A finite number that satisfies lowest <= value <= highest; else UsageError with `allowed`.
[[nodiscard]] double number_flag(const std::string& flag, const std::string& text, double lowest, double highest,
                                 const std::string& allowed);
[[nodiscard]] int integer_flag(const std::string& flag, const std::string& text, int lowest, int highest,
                               const std::string& allowed);
// Parts of "a,b,c"; an empty part is a UsageError.
[[nodiscard]] std::vector<std::string> list_flag(const std::string& flag, const std::string& text);

}  // namespace hb::tools
