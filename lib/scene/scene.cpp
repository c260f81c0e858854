#include "lib/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "lib/constants.hpp"
#include "lib/linkage/kinematics.hpp"
#include "lib/scene/plausibility.hpp"
#include "lib/scene/quantity.hpp"
#include "lib/scene/scene_parts.hpp"
#include "lib/scene/scene_paths.hpp"

namespace hb {

namespace {

// What [units] may name: symbols of which the scene's other units are made.
constexpr std::string_view length_units[] = {"m", "mm", "cm", "dm", "um", "km", "in", "ft"};
constexpr std::string_view mass_units[] = {"kg", "g", "mg", "t", "lb"};
constexpr std::string_view time_units[] = {"s", "ms", "us", "min"};
constexpr std::string_view angle_units[] = {"rad", "deg"};

// Name and size of the unit that a key names; unchanged if the key is absent.
void read_unit(const TableView& units, std::string_view key, std::span<const std::string_view> known, std::string& name,
               double& size) {
  const auto text = units.text(key);
  if (!text) return;
  if (std::ranges::find(known, *text) == known.end()) {
    const std::vector<std::string> names(known.begin(), known.end());
    const std::string meant = unit_meant(*text, names);
    units.problem(key, fmt::format("found {}, an unknown unit{}, allowed {}", describe(*units.node(key)),
                                   meant.empty() ? "" : fmt::format(" ({} meant?)", meant), joined(names)));
    return;
  }
  name = *text;
  size = size_of(*unit_of_symbol(name));
}

}  // namespace

double SceneContext::angle_unit() const { return units.angle == "deg" ? pi / 180 : 1; }

Units read_units(const TableView& scene) {
  Units units;
  const auto table = scene.table("units");
  if (!table) return units;
  double angle = 1;
  read_unit(*table, "length", length_units, units.length, units.length_in_m);
  read_unit(*table, "mass", mass_units, units.mass, units.mass_in_kg);
  read_unit(*table, "time", time_units, units.time, units.time_in_s);
  read_unit(*table, "angle", angle_units, units.angle, angle);
  return units;
}

namespace {

constexpr double max_speeds = 1e7;
constexpr Limits speed_limits{slowest, fastest, true, "a number > 0 (1e-12 to 1e12)"};

std::optional<Speeds> read_speeds(const TableView& analysis, const char* key) {
  const toml::node* node = analysis.node(key);
  if (!node) return std::nullopt;
  if (!node->is_array()) {
    static constexpr Limits limits{slowest, fastest, true, "a number > 0 (1e-12 to 1e12), or [from, to, step]"};
    const auto speed = analysis.number(key, limits);
    return speed ? std::optional<Speeds>({*speed, *speed, 0}) : std::nullopt;
  }
  const auto values = analysis.numbers(key, speed_limits);
  if (!values) return std::nullopt;
  constexpr const char* words = "[from, to, step] with 0 < from <= to and step > 0";
  if (values->size() != 3 || !((*values)[0] <= (*values)[1])) {
    analysis.problem(key, fmt::format("found [{}], allowed {}", fmt::join(*values, ", "), words));
    return std::nullopt;
  }
  const Speeds speeds{(*values)[0], (*values)[1], (*values)[2]};
  if (!((speeds.to - speeds.from) / speeds.step <= max_speeds)) {
    analysis.problem(key, fmt::format("found more than {} speeds, allowed fewer", max_speeds));
    return std::nullopt;
  }
  return speeds;
}

std::variant<int, AutoModes> read_modes(const TableView& analysis, int num_modes) {
  const toml::node* node = analysis.node("modes");
  const auto* number = node ? node->as_integer() : nullptr;
  const auto* word = node ? node->as_string() : nullptr;
  if (num_modes > 0) {
    if (node && !(word && word->get() == "auto") && !(number && number->get() == num_modes)) {
      analysis.problem("modes",
                       fmt::format("found {}, allowed {}, the size of [hill] mass", describe(*node), num_modes));
    }
    return num_modes;
  }
  if (word && word->get() == "auto") return AutoModes{};
  if (number && number->get() >= 1 && number->get() <= max_modes) return static_cast<int>(number->get());
  if (node)
    analysis.problem("modes",
                     fmt::format("found {}, allowed an integer from 1 to {} or \"auto\"", describe(*node), max_modes));
  return AnalysisDefaults().modes;
}

}  // namespace

AnalysisDefaults read_analysis(const TableView& analysis, int num_modes) {
  static constexpr Limits tolerances{1e-14, 1e-1, true, "a number from 1e-14 to 0.1"};
  AnalysisDefaults defaults;
  defaults.modes = read_modes(analysis, num_modes);
  defaults.rpm = read_speeds(analysis, "rpm");
  defaults.omega = read_speeds(analysis, "omega");
  defaults.tolerance = analysis.number("tolerance", tolerances).value_or(defaults.tolerance);
  if (analysis.has("rpm") && analysis.has("omega")) {
    analysis.problem("omega", "found both rpm and omega, allowed one of the two");
  }
  return defaults;
}

namespace {

void refuse_obstruction(const Linkage& linkage, const toml::table& scene, const Problems& problems,
                        const std::vector<Override>& overrides) {
  const std::optional<Obstruction> obstruction = find_obstruction(linkage);
  if (!obstruction) return;
  const toml::node& dyad = *scene.get("dyad")->as_array()->get(static_cast<std::size_t>(obstruction->dyad));
  std::string changes;
  for (const Override& change : overrides)
    changes += (changes.empty() ? " with " : ", ") + change.path + "=" + change.value;
  throw ObstructedLinkage(fmt::format("{}: dyad.{}{}: found {}, allowed a linkage that turns through",
                                      problems.place(dyad), obstruction->dyad, changes, obstruction->message),
                          obstruction->dyad, obstruction->crank_angle);
}

void check_title(const TableView& scene, Scene& result) {
  result.title = scene.text("title").value_or("");
  if (result.title.size() > 500 ||
      std::ranges::any_of(result.title, [](unsigned char c) { return c < 0x20 || c == 0x7f; })) {
    scene.problem("title", "found a text with control characters or too long, allowed one line of at most 500 bytes");
  }
}

Scene scene_from(const toml::table& tree, const std::string& name, const std::filesystem::path& folder,
                 const std::vector<Override>& overrides) {
  Problems problems(name);
  const Units units = read_units(TableView(tree, "", problems));
  const TableView scene(tree, "", problems, &scene_keys(), units);
  if (tree.empty())
    throw SceneError(name + ": found an empty file, allowed a scene with [crank] and [[dyad]], or [hill]");
  check_keys(tree, problems);

  Scene result;
  result.file = name;
  check_title(scene, result);
  std::vector<Remark> remarks;
  const SceneContext context{units, folder, remarks};
  result.units = units;
  int num_modes = 0;
  if (scene.has("hill")) {
    for (const char* key : {"crank", "dyad", "gravity"}) {
      if (scene.has(key)) scene.problem(key, "found beside [hill], allowed in a scene without [hill]");
    }
    if (const auto hill = scene.table("hill")) {
      HillSystem system = read_hill(*hill, context);
      num_modes = static_cast<int>(system.num_modes());
      result.model = std::move(system);
    }
  } else if (!scene.has("crank") && !scene.has("dyad")) {
    problems.add(tree, "", "found neither [crank] nor [hill], allowed [crank] and [[dyad]], or [hill]");
  } else {
    result.model = read_linkage(scene, context);
  }
  const auto analysis = scene.table("analysis");
  if (analysis) result.analysis = read_analysis(*analysis, num_modes);
  if (num_modes > 0) result.analysis.modes = num_modes;
  problems.throw_if_any();
  if (const Linkage* linkage = std::get_if<Linkage>(&result.model)) {
    remark_on_linkage(scene, *linkage, context);
    if (analysis) remark_on_speed(*analysis, result.analysis, *linkage, context);
    refuse_obstruction(*linkage, tree, problems, overrides);
  }
  result.warnings = warning_lines(remarks);
  result.notes = note_lines(remarks);
  result.remarks = std::move(remarks);
  return result;
}

}  // namespace

Override number_override(std::string path, double value) {
  std::string text = fmt::format("{:.17g}", value);
  if (std::isfinite(value) && text.find_first_of(".e") == std::string::npos) text += ".0";
  return {std::move(path), std::move(text)};
}

Override value_override(std::string path, double value) { return {std::move(path), fmt::format("{:.17g}", value)}; }

SceneSource::SceneSource(const std::filesystem::path& file)
    : text_(read_text_file(file)), name_(file.string()), folder_(file.parent_path()) {}

SceneSource::SceneSource(std::string text, std::string name, std::filesystem::path folder)
    : text_(std::move(text)), name_(std::move(name)), folder_(std::move(folder)) {}

Scene SceneSource::with(const std::vector<Override>& overrides) const {
  toml::table tree = parse_toml(text_, name_);
  apply(tree, overrides);
  return scene_from(tree, name_, folder_, overrides);
}

std::vector<std::string> SceneSource::numeric_paths() const { return hb::numeric_paths(parse_toml(text_, name_)); }

std::vector<std::string> SceneSource::damping_paths() const {
  std::vector<std::string> paths = numeric_paths();
  std::erase_if(paths, [](const std::string& path) {
    return !path.ends_with(".damping_internal") && !path.ends_with(".damping_ratio") &&
           !path.ends_with(".damping_ratio.ratio");
  });
  return paths;
}

double SceneSource::value(const std::string& path) const {
  toml::table tree = parse_toml(text_, name_);
  Problems problems(name_);
  const Units units = read_units(TableView(tree, "", problems));
  problems.throw_if_any();
  std::optional<double> common;
  for (const Slot& slot : resolve(tree, path)) {
    const toml::node* node = slot.value();
    const std::optional<double> number = number_at(slot, units);
    if (!number) {
      throw SceneError(fmt::format("{}: {}: found {}, allowed the path of a number", name_, path,
                                   node ? describe(*node) : "nothing given"));
    }
    if (common && *common != *number) {
      throw SceneError(fmt::format("{}: {}: found {} and {}, allowed equal numbers", name_, path, *common, *number));
    }
    common = number;
  }
  if (!common) {
    const std::vector<std::string> known = hb::numeric_paths(tree);
    const std::string near = nearest_name(path, known);
    throw SceneError(fmt::format("{}: {}: found no such number{}, allowed {}", name_, path,
                                 near.empty() ? "" : " (" + near + " meant?)", joined(known)));
  }
  return *common;
}

std::string SceneSource::text_with(const std::vector<Override>& overrides) const {
  return replaced_text(text_, name_, overrides);
}

Scene read_scene(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  return SceneSource(file).with(overrides);
}

Scene parse_scene(const std::string& text, const std::string& name, const std::vector<Override>& overrides,
                  const std::filesystem::path& folder) {
  return SceneSource(text, name, folder).with(overrides);
}

// rpm turns per minute; a unit of time is time_in_s seconds.
double speed_from_rpm(double rpm, const Units& units) { return rpm * (2 * pi / 60) * units.time_in_s; }

double rpm_from_speed(double speed, const Units& units) {
  const double rpm = speed / ((2 * pi / 60) * units.time_in_s);
  // Of all that stand for this speed the rounder number: 1500 comes back as 1500.
  const double rounder = std::round(rpm * 1e6) / 1e6;
  return speed_from_rpm(rounder, units) == speed ? rounder : rpm;
}

}  // namespace hb
