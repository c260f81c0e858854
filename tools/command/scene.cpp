// hb scene: reads and checks a scene, says what it understood, draws the mechanism over one turn.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/scene_family.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/printable.hpp"
#include "tools/output/scene_report.hpp"
#include "tools/pictures/figures.hpp"
#include "tools/pictures/gnuplot.hpp"

namespace hb::tools {
namespace {

// What --set, --x, --y and --vary may name, with its value in the scene's units: one number a line. A scene need not be
// whole for that; what is wrong with a value that has none is what is wrong with the scene.
std::string numbers_text(const SceneSource& source, const std::vector<Override>& set) {
  const SceneFamily family(source, set);
  std::string text;
  try {
    for (const std::string& path : family.paths()) text += fmt::format("{} {}\n", path, family.value(path));
  } catch (const SceneError&) {
    (void)source.with(set);
    throw;
  }
  return text;
}

int run_scene(const CommonFlags& flags, bool paths) {
  const SceneInput input = scene_input(flags.scene_file);
  if (paths) {
    Delivery numbers;
    numbers.printed = printable(numbers_text(input.source, overrides(flags)));
    return deliver(nullptr, {}, exit_ok, numbers);
  }
  const Scene scene = input.source.with(overrides(flags));
  (void)settings(flags, scene);
  const Output out = output(flags);
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "scene", provenance(flags.line, input));
  Delivery delivery;
  delivery.printed = out.json ? json_text(scene_json(scene)) : scene_table(scene);
  delivery.write_data = [&](OutputFolder& place) -> std::vector<Figure> {
    place.write("scene.txt", printable(scene_table(scene)));
    if (!std::holds_alternative<Linkage>(scene.model)) return {};
    // `hb steady` writes the same under its own names.
    CsvFile mechanism = mechanism_csv(scene);
    mechanism.name = "scene_mechanism.csv";
    place.write(mechanism.name, csv_text(mechanism));
    Figure figure = mechanism_figure(scene, mechanism);
    figure.name = "scene_mechanism";
    return {figure};
  };
  return deliver(folder ? &*folder : nullptr, out.pictures, exit_ok, delivery);
}

}  // namespace

void add_scene_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("scene", "reads and checks a scene, says what it understood, draws it");
  const auto flags = std::make_shared<CommonFlags>();
  const auto paths = std::make_shared<bool>(false);
  add_scene_flags(*command, *flags);
  command->add_flag("--paths", *paths, "only the scene's numbers, PATH VALUE a line: what --set, --x and --vary take");
  command->callback([flags, paths, &status] { status = run_scene(*flags, *paths); });
}

}  // namespace hb::tools
