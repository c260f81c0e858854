// hb steady: the periodic steady state at one speed, its stability, joint forces and driving torque.
#include "hb/analysis/steady.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/sensitivity_band.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/measured_deviation.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/speed_flags.hpp"
#include "tools/command/steady_files.hpp"
#include "tools/command/steady_motion.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/band_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/table_output.hpp"
#include "tools/pictures/band_figures.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/forecast.hpp"

namespace hb::tools {
namespace {

int run_steady(const SteadyFlags& flags) {
  if (is_nonlinear(flags.theory)) return run_steady_motion(flags);
  const SceneInput input = scene_input(flags.scene_file);
  const Scene scene = input.source.with(overrides(flags));
  Request request = asked_request(flags, scene);
  const Output out = output(flags);
  set_speed(request, first_speed(flags, scene));
  const Provenance origin = provenance(flags.line, input);
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "steady", origin);

  const SteadyResult result = steady(scene, request, [&](double seconds, double bytes) {
    say_memory("this speed", bytes);
    say_expected("this speed", seconds, "--modes, --only and --time-limit",
                 request.stability_method == StabilityMethod::determinant);
  });
  const SceneModel& model = *result.model;
  std::optional<MeasuredComparison> measured;
  if (!flags.measured.empty()) measured = compare_measured(flags.measured, model, result);
  const std::vector<BandRequest> asked = bands_of(flags.bands);
  nlohmann::ordered_json document = out.json || folder || !asked.empty()
                                        ? steady_json(model, result, result.settings, out.stats)
                                        : nlohmann::ordered_json();
  const std::vector<SensitivityBand> bands = sensitivity_bands(scene, request, asked);
  if (!asked.empty()) document["bands"] = bands_json(document, bands);
  if (measured && !document.is_null()) document["measured"] = measured_json(*measured);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : steady_table(model, result, result.settings, flags.multipliers);
  if (!out.json && !asked.empty()) delivery.printed += bands_table(document["bands"]);
  if (measured && !out.json) delivery.printed += measured_table(*measured);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("steady.json", json_file_text(document));
    std::vector<Figure> figures = steady_files(model, result, machine_files(model, result), place,
                                               measured ? measured->overlay : MeasuredOverlay());
    for (const BandCurves& curves : band_responses(result, bands)) {
      place.write(curves.csv.name, csv_text(curves.csv));
      figures.push_back(band_figure(model.scene, curves, true));
    }
    return figures;
  };
  if (out.html)
    delivery.page = [&](std::vector<PageText::Picture> pictures) {
      ReportData data(model.scene);
      data.add_speed({result.model, result, "", {}}, result.settings);
      if (document.contains("bands")) data.add_bands(document["bands"]);
      return data.page(page_text(origin, std::move(pictures)));
    };
  const int status = deliver(folder ? &*folder : nullptr, out.pictures,
                             result.shortfalls.empty() ? exit_ok : exit_not_reached, delivery);
  if (out.stats && !out.json)
    fmt::print(stderr, "\n{}{}{}", stages_table(model.stages), stages_table(result.stages),
               accuracy_table(result.settings));
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
  add_band_flag(*command, flags->bands);
  add_measured_flag(*command, flags->measured, "over the crank angle");
  add_html_flag(*command, *flags);
  command->callback([flags, &status] { status = run_steady(*flags); });
}

}  // namespace hb::tools
