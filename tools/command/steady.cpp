// hb steady: the periodic steady state at one speed, its stability, joint forces and driving torque.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/linkage_analysis.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/machine_output.hpp"
#include "tools/output/nonlinear_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/table_output.hpp"
#include "tools/pictures/figures.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

// `machine`: also what the frame feels and the sliders do, of the linear theory.
std::vector<Figure> write_tables(const SceneModel& model, const SpeedResult& result, bool machine,
                                 OutputFolder& folder) {
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
    const auto place = static_cast<std::size_t>(&rod - result.rods.data());
    if (const std::optional<CsvFile> stress = machine ? stress_csv(model, result, place) : std::nullopt) {
      write(*stress);
      figures.push_back(stress_figure(model, result, rod, stress->name));
    }
    if (rod.stability) write(exponents_csv(model, result, rod));
  }
  if (result.forces) {
    const CsvFile forces = forces_csv(model, result), torque = torque_csv(model, result);
    write(forces);
    write(torque);
    for (Figure& figure : force_figures(model, result, forces.name)) figures.push_back(std::move(figure));
    for (Figure& figure : polar_figures(model, result, forces.name)) figures.push_back(std::move(figure));
    figures.push_back(torque_figure(model, result, torque.name));
    if (machine) {
      write(frame_csv(model, result));
      for (const CsvFile& slider : slider_csvs(model, result)) write(slider);
    }
  }
  if (model.linkage()) {
    const CsvFile mechanism = mechanism_csv(model.scene);
    write(mechanism);
    figures.push_back(mechanism_figure(model.scene, mechanism));
  }
  return figures;
}

struct SteadyFlags : CommonFlags {
  TheoryFlags theory;
  bool multipliers = false;
};

// Motions of one turn have tables and pictures, longer ones the document alone.
int run_nonlinear(const SteadyFlags& flags) {
  const SceneInput input = scene_input(flags.scene_file);
  Scene scene = input.source.with(overrides(flags));
  const Settings options = settings(flags, scene);
  const Output out = output(flags);
  const double speed = single_speed(flags, scene);
  const InterruptGuard guard(false);
  NonlinearOptions asked;
  asked.turns = turns_of(flags.theory);
  asked.stop = stop_of();
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "steady", provenance(flags.line, input));

  // The motion is that of all rods, whatever is shown of it.
  Settings all = options;
  all.only.steady = true;
  const SceneModel model = make_model(std::move(scene), all, false);
  NonlinearResult result = nonlinear_steady(model, speed, options, asked);
  say_time_limit(flags.time_limit, asked.stop, result.shortfalls);
  const nlohmann::ordered_json document =
      out.json || folder ? nonlinear_json(model, result, options, out.stats) : nlohmann::ordered_json();
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : nonlinear_table(model, result);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("steady.json", json_file_text(document));
    return result.turns == 1 ? write_tables(model, as_speed_result(result), false, place) : std::vector<Figure>();
  };
  const int status = deliver(folder ? &*folder : nullptr, out.plots,
                             ended_status(result.shortfalls.empty() ? exit_ok : exit_not_reached), delivery);
  if (out.stats && !out.json) fmt::print(stderr, "\n{}{}", stages_table(model.stages), stages_table(result.stages));
  return status;
}

int run_steady(const SteadyFlags& flags) {
  if (is_nonlinear(flags.theory)) return run_nonlinear(flags);
  const SceneInput input = scene_input(flags.scene_file);
  Scene scene = input.source.with(overrides(flags));
  const Settings options = settings(flags, scene);
  const Output out = output(flags);
  const double speed = single_speed(flags, scene);
  const Provenance origin = provenance(flags.line, input);
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "steady", origin);

  const auto shared_model = std::make_shared<const SceneModel>(make_model(std::move(scene), options));
  const SceneModel& model = *shared_model;
  const SpeedResult result = analyse(model, speed, options);
  const nlohmann::ordered_json document =
      out.json || folder ? steady_json(model, result, options, out.stats) : nlohmann::ordered_json();
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : steady_table(model, result, options, flags.multipliers);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("steady.json", json_file_text(document));
    return write_tables(model, result, true, place);
  };
  if (out.html)
    delivery.page = [&](std::vector<PageText::Picture> pictures) {
      ReportData data(model.scene);
      data.add_speed({shared_model, result, ""}, options);
      return data.page(page_text(origin, std::move(pictures)));
    };
  const int status =
      deliver(folder ? &*folder : nullptr, out.plots, result.shortfalls.empty() ? exit_ok : exit_not_reached, delivery);
  if (out.stats && !out.json) {
    fmt::print(stderr, "\n{}{}", stages_table(model.stages), stages_table(result.stages));
  }
  return status;
}

}  // namespace

void add_steady_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "steady", "periodic steady state at one speed: response, stability, joint forces, driving torque");
  const auto flags = std::make_shared<SteadyFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags, SpeedsTaken::one);
  add_single_speed_flags(*command, *flags);
  allow_growth_alone(*command, *flags);
  add_theory_flags(*command, flags->theory);
  command->add_flag("--multipliers", flags->multipliers, "print Floquet multipliers too (JSON always has them)");
  add_html_flag(*command, *flags);
  command->callback([flags, &status] { status = run_steady(*flags); });
}

}  // namespace hb::tools
