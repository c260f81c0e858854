// TOML in, checked mechanism or Hill system out. The only part of the program that sees the TOML library.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "lib/hill_system.hpp"
#include "lib/linkage.hpp"

namespace hb {

// A wrong scene: what() is one or more lines "file:line: key: what was found, what is allowed".
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What the numbers of the file are written in. Nothing is converted but degrees; these only name and scale output.
struct Units {
  std::string length = "m", mass = "kg", time = "s", angle = "rad";
  double length_in_m = 1, mass_in_kg = 1, time_in_s = 1;
  double force_in_newton() const { return mass_in_kg * length_in_m / (time_in_s * time_in_s); }
  double torque_in_newton_metre() const { return force_in_newton() * length_in_m; }
};

struct AutoModes {};  // modes = "auto"

struct Speeds {  // rpm = number, or [from, to, step]
  double from = 0, to = 0, step = 0;  // step == 0: the single speed `from`
};

struct AnalysisDefaults {
  std::variant<int, AutoModes> modes = 5;
  std::optional<Speeds> rpm;
  std::optional<double> omega;  // [hill] scenes: rad per unit time
  double tolerance = 1e-10;
};

struct Scene {
  std::string title;
  std::filesystem::path file;
  Units units;
  std::variant<Linkage, HillSystem> model;
  AnalysisDefaults analysis;
};

// A scene number replaced from outside: path as in "AB.J", "crank.length", "*.J", "gravity", "hill.damping.0.0".
struct Override {
  std::string path;
  std::string value;  // as written on the command line
};

// Reads and checks; throws SceneError. Relative paths of further files are taken from the scene's folder.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file, const std::vector<Override>& overrides = {});
// The same from text; `name` stands in messages.
[[nodiscard]] Scene parse_scene(const std::string& text, const std::string& name,
                                const std::vector<Override>& overrides = {},
                                const std::filesystem::path& folder = ".");

// Speed in rad per the scene's unit of time.
[[nodiscard]] double speed_from_rpm(double rpm, const Units& units);
[[nodiscard]] double rpm_from_speed(double speed, const Units& units);

}  // namespace hb
