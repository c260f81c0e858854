// hb steady: the periodic steady state at one speed, its stability, joint forces and driving torque.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/pictures/figures.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/output/json_output.hpp"
#include "hb/analysis/linkage_analysis.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/table_output.hpp"

namespace hb::tools {
namespace {

std::vector<Figure> write_tables(const SceneModel& model, const SpeedResult& result, OutputFolder& folder) {
  std::vector<Figure> figures;
  const auto write = [&](const CsvFile& file) { folder.write(file.name, csv_text(file)); };
  for (const RodResult& rod : result.rods) {
    if (!rod.reported) continue;
    const bool solved = rod.steady && rod.steady->status != SteadyStatus::singular;
    if (solved && result.computed.steady) {
      const CsvFile response = response_csv(model, result, rod), spectrum = fourier_csv(model, result, rod);
      write(response);
      write(spectrum);
      figures.push_back(response_figure(model, result, rod, response.name));
      figures.push_back(phase_figure(model, result, rod, response.name));
      figures.push_back(spectrum_figure(model, result, rod, spectrum.name));
    }
    if (rod.shape) {
      const CsvFile deflection = deflection_csv(model, result, rod), moment = bending_moment_csv(model, result, rod);
      write(deflection);
      write(moment);
      figures.push_back(shape_figure(model, result, rod, deflection, false));
      figures.push_back(shape_figure(model, result, rod, moment, true));
    }
    if (rod.stability) write(exponents_csv(model, result, rod));
  }
  if (result.forces) {
    const CsvFile forces = forces_csv(model, result), torque = torque_csv(model, result);
    write(forces);
    write(torque);
    for (Figure& figure : force_figures(model, result, forces.name)) figures.push_back(std::move(figure));
    figures.push_back(torque_figure(model, result, torque.name));
  }
  if (model.linkage()) {
    const CsvFile mechanism = mechanism_csv(model.scene);
    write(mechanism);
    figures.push_back(mechanism_figure(model.scene, mechanism));
  }
  return figures;
}

int run_steady(const CommonFlags& flags) {
  Scene scene = read_scene(flags.scene_file, overrides(flags));
  const Settings options = settings(flags, scene);
  const double speed = single_speed(flags, scene);
  std::optional<OutputFolder> folder;
  if (options.out) folder.emplace(*options.out, "steady");

  const SceneModel model = make_model(std::move(scene), options);
  const SpeedResult result = analyse(model, speed, options);
  const nlohmann::ordered_json document =
      options.json || folder ? steady_json(model, result, options) : nlohmann::ordered_json();
  if (folder) {
    folder->write("steady.json", document.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    draw_figures(write_tables(model, result, *folder), *folder, options.plots);
    folder->commit();
  }
  if (options.json) {
    print_json(document);
  } else {
    fmt::print("{}", steady_table(model, result, options));
  }
  if (options.stats && !options.json) {
    fmt::print(stderr, "\n{}{}", stages_table(model.stages), stages_table(result.stages));
  }
  return result.shortfalls.empty() ? exit_ok : exit_not_reached;
}

}  // namespace

void add_steady_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "steady", "periodic steady state at one speed: response, stability, joint forces, driving torque");
  const auto flags = std::make_shared<CommonFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags);
  add_single_speed_flags(*command, *flags);
  command->callback([flags, &status] { status = run_steady(*flags); });
}

}  // namespace hb::tools
