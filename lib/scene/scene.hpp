// TOML in, checked mechanism or Hill system out. The scene*.cpp files are the only part of the program that sees the
// TOML library.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "lib/hill_system.hpp"
#include "lib/linkage/linkage.hpp"

namespace hb {

// A wrong scene: what() is one or more lines "file:line: key: found ..., allowed ...". Where an override is to blame,
// "PATH=VALUE" stands in the place of file:line.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A scene whose every number is fine, but whose linkage cannot turn through.
class ObstructedLinkage : public SceneError {
 public:
  ObstructedLinkage(const std::string& message, int dyad_number, double angle)
      : SceneError(message), dyad(dyad_number), crank_angle(angle) {}
  int dyad;  // from 0
  double crank_angle;  // rad
};

// What the numbers of the file are written in. Nothing is converted but degrees; these only name and scale output.
struct Units {
  std::string length = "m", mass = "kg", time = "s", angle = "rad";
  double length_in_m = 1, mass_in_kg = 1, time_in_s = 1;
  double force_in_newton() const { return mass_in_kg * length_in_m / (time_in_s * time_in_s); }
  double torque_in_newton_metre() const { return force_in_newton() * length_in_m; }
};

struct AutoModes {};  // modes = "auto"
inline constexpr int max_modes = 60;  // Ritz terms: what the Ritz matrices are made for

struct Speeds {  // rpm = number, or [from, to, step]
  double from = 0, to = 0, step = 0;  // step == 0: the single speed `from`
  int count = 0;  // > 0: so many speeds, both ends included; `step` is then what comes of it
};

struct AnalysisDefaults {
  std::variant<int, AutoModes> modes = 5;
  std::optional<Speeds> rpm;
  std::optional<Speeds> omega;  // rad per unit time, instead of rpm
  double tolerance = 1e-10;
};

// What is odd but usable, in growing order of how likely it spoils the answer. A note does not.
enum class Concern { note, slenderness, seam, speed, gravity, section, size, material };
struct Remark {
  Concern concern;
  std::string subject;  // "file:line: key"
  std::string words;  // "found ..."
  std::string line() const { return subject + ": " + words; }
};

// Most likely to spoil the answer first; of several of one kind the first, with their number. Notes are left out of the
// warnings and are the only ones in the notes.
[[nodiscard]] std::vector<std::string> warning_lines(std::vector<Remark> remarks);
[[nodiscard]] std::vector<std::string> note_lines(const std::vector<Remark>& remarks);

struct Scene {
  std::string title;
  std::filesystem::path file;
  Units units;
  std::variant<Linkage, HillSystem> model;
  AnalysisDefaults analysis;
  std::vector<Remark> remarks;
  // Their lines, "file:line: key: found ..., allowed ...", the gravest first; notes do not touch the answer.
  std::vector<std::string> warnings, notes;
};

// A scene number replaced from outside. Paths: "AB.J" (a key of the link named AB or of its `elastic`), "*.J" (all
// elastic links), "crank.length", "gravity", "analysis.modes"; elements of lists by their index from 0:
// "O2BC.pivot.0", "hill.damping.0.0", "dyad.1.branch". A key that the scene leaves out may be set where it is allowed.
struct Override {
  std::string path;
  std::string value;  // a TOML value as written on the command line; a bare word is taken as text
};

[[nodiscard]] Override number_override(std::string path, double value);  // all digits
// The same where it is read again at once: a whole number as an integer, which every key takes.
[[nodiscard]] Override value_override(std::string path, double value);

// The text of a scene, read once and turned into scenes as often as wanted; constant and free to share by threads.
// Every member throws SceneError.
class SceneSource {
 public:
  explicit SceneSource(const std::filesystem::path& file);
  // `name` stands in messages; relative paths of further files are taken from `folder`.
  SceneSource(std::string text, std::string name, std::filesystem::path folder);

  // The scene with some numbers replaced: overrides are applied to the text's tree in their order, then everything is
  // checked.
  [[nodiscard]] Scene with(const std::vector<Override>& overrides = {}) const;
  // Paths of all numbers that the scene gives, in a form that `with` and `value` take.
  [[nodiscard]] std::vector<std::string> numeric_paths() const;
  // Those of them that internal damping is proportional to: "AB.damping_internal", "CD.damping_ratio".
  [[nodiscard]] std::vector<std::string> damping_paths() const;
  // The number at a path, in the scene's units (angles too). A path with * needs equal numbers.
  [[nodiscard]] double value(const std::string& path) const;
  // The scene's text with numbers replaced, comments and order kept where the text allows it.
  [[nodiscard]] std::string text_with(const std::vector<Override>& overrides) const;

 private:
  std::string text_, name_;
  std::filesystem::path folder_;
};

// Reads and checks; throws SceneError. Relative paths of further files are taken from the scene's folder.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file, const std::vector<Override>& overrides = {});
// The same from text; `name` stands in messages.
[[nodiscard]] Scene parse_scene(const std::string& text, const std::string& name,
                                const std::vector<Override>& overrides = {}, const std::filesystem::path& folder = ".");

// What may be asked for, in rpm or rad per unit of time: powers of a speed far beyond these under- or overflow.
inline constexpr double slowest = 1e-12, fastest = 1e12;

// Speed in rad per the scene's unit of time.
[[nodiscard]] double speed_from_rpm(double rpm, const Units& units);
[[nodiscard]] double rpm_from_speed(double speed, const Units& units);

}  // namespace hb
