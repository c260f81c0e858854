// hb scene: reads and checks a scene, says what it understood, draws the mechanism over one turn.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/pictures/figures.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/scene_report.hpp"

namespace hb::tools {
namespace {

int run_scene(const CommonFlags& flags) {
  const Scene scene = read_scene(flags.scene_file, overrides(flags));
  const Settings options = settings(flags, scene);
  if (options.out) {
    OutputFolder folder(*options.out, "scene");
    folder.write("scene.txt", scene_table(scene));
    if (std::holds_alternative<Linkage>(scene.model)) {
      const CsvFile mechanism = mechanism_csv(scene);
      folder.write(mechanism.name, csv_text(mechanism));
      draw_figures({mechanism_figure(scene, mechanism)}, folder, options.plots);
    }
    folder.commit();
  }
  if (options.json) {
    print_json(scene_json(scene));
  } else {
    fmt::print("{}", scene_table(scene));
  }
  return exit_ok;
}

}  // namespace

void add_scene_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("scene", "reads and checks a scene, says what it understood, draws it");
  const auto flags = std::make_shared<CommonFlags>();
  add_scene_flags(*command, *flags);
  command->callback([flags, &status] { status = run_scene(*flags); });
}

}  // namespace hb::tools
