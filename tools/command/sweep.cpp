// hb sweep: everything along the speed or any other scene number, with resonance peaks and unstable bands located.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "hb/analysis/nonlinear/nonlinear_sweep.hpp"
#include "lib/scene/scene_reader.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/measured_deviation.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/result_files.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/sweep_axis.hpp"
#include "tools/command/sweep_flags.hpp"
#include "tools/command/sweep_forecast.hpp"
#include "tools/output/branches_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/motion_input.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/table_output.hpp"
#include "tools/pictures/band_figures.hpp"
#include "tools/pictures/sweep_figures.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/keep.hpp"
#include "tools/work/ranks.hpp"
#include "tools/work/shared_work.hpp"
#include "tools/work/sweep_key.hpp"

namespace hb::tools {
namespace {

void add_bands(const nlohmann::ordered_json& document, const SweepScene& swept, OutputFolder& place,
               std::vector<Figure>& figures) {
  for (const BandCurves& curves : band_curves(document, document["bands"], axis_label(swept))) {
    place.write(curves.csv.name, csv_text(curves.csv));
    figures.push_back(band_figure(swept.scene(), curves, false));
    figures.back().x_label = quoted(axis_label(swept));
  }
}

void say_stages(const SweepScene& swept, const SweepResult& result, const std::optional<NonlinearSweep>& branches) {
  fmt::print(stderr, "\n{}{}{}", stages_table(result.stages), branches ? stages_table(branches->stages) : "",
             accuracy_table(swept.settings()));
}

NonlinearSweep followed(const SweepScene& swept, NonlinearSweepOptions options, const SweepFlags& flags, bool files) {
  const InterruptGuard guard(!files);
  NonlinearSweep branches = announced_branches(swept, std::move(options));
  if (branches.stopped) say_time_limit(flags.time_limit, stop_of(), branches.shortfalls);
  return branches;
}

int run_sweep_command(const SweepFlags& flags) {
  const SceneInput input = scene_input(flags.scene_file);
  const std::vector<Override> set = overrides(flags);
  const Scene scene = input.source.with(set);
  SweepRequest request = asked_sweep(flags, flags.x, input.source, scene);
  request.search = !flags.no_search;
  const Output out = output(flags);
  std::optional<NonlinearSweepOptions> branches_asked = branches_of(flags);
  const EarlierParts earlier = earlier_parts_flag(flags.resume, flags.restart, out.folder.has_value());
  const Provenance origin = provenance(flags.line, input);
  std::optional<OutputFolder> folder;
  if (out.folder && ranks().first()) folder.emplace(*out.folder, "sweep", origin);

  const std::shared_ptr<const SweepScene> along = sweep_scene(SceneFamily(input.source, set), request);
  const SweepScene& swept = *along;
  for (const std::string& file : flags.start)
    branches_asked->starts.push_back(motion_from_json(read_text_file(file), file, swept));
  if (branches_asked) require_nonlinear(swept, *branches_asked);
  SweepResult result;
  const std::vector<BandRequest> bands_asked = bands_of(flags.bands, flags.theory);
  if (!flags.measured.empty()) (void)read_measured(flags.measured, measured_axis(swept), measured_quantities(swept));
  say_forecast_of(swept, out);
  KeptRun run("sweep", out.folder, earlier, sweep_key(swept), out.threads);
  if (!run.run([&](SharedWork& work) { result = run_sweep(swept, work); })) return stopped_status(out.json);
  std::vector<SweepBand> bands;
  if (!bands_asked.empty()) {
    SharedWork work(out.threads);
    bands = sweep_bands(SceneFamily(input.source, set), request, bands_asked, work);
  }
  std::optional<MeasuredComparison> measured;
  if (!flags.measured.empty()) {
    SharedWork work(out.threads);
    measured = compare_measured(flags.measured, {input.source, set}, request, swept, branches_asked, work);
  }
  const std::optional<NonlinearSweep> branches =
      branches_asked ? std::optional(followed(swept, *branches_asked, flags, out.folder.has_value())) : std::nullopt;
  nlohmann::ordered_json document =
      out.json || folder || !bands_asked.empty() ? sweep_json(swept, result, out.stats) : nlohmann::ordered_json();
  if (!bands_asked.empty()) document["bands"] = sweep_bands_json(document, bands);
  if (measured && !document.is_null()) document["measured"] = measured_json(*measured);
  if (branches && !document.is_null()) add_branches(document, swept, *branches);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : sweep_table(swept, result);
  if (branches && !out.json)
    delivery.printed = branches_verdict(swept, *branches) +
                       "\nBy the linear theory; the motion without linearisation stands below.\n" + delivery.printed +
                       branches_table(swept, *branches);
  if (!bands_asked.empty() && !out.json) delivery.printed += sweep_bands_table(document, document["bands"]);
  if (measured && !out.json) delivery.printed += measured_table(*measured);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("sweep.json", json_file_text(document));
    std::vector<Figure> figures = sweep_files(swept, result, place, measured ? measured->overlay : MeasuredOverlay());
    if (!bands_asked.empty()) add_bands(document, swept, place, figures);
    if (branches)
      for (Figure& figure :
           branch_files(swept, result, *branches, place, measured ? measured->overlay : MeasuredOverlay()))
        figures.push_back(std::move(figure));
    return figures;
  };
  delivery.committed = [&] { run.delivered(); };
  if (out.html)
    delivery.page = [&](std::vector<PageText::Picture> pictures) {
      ReportData data(scene);
      const NonlinearSweep* along = branches ? &*branches : nullptr;
      data.add_sweep(swept, result, places_along(swept, SharedWork(out.threads), along), along);
      if (!bands.empty()) data.add_sweep_bands(document);
      return data.page(page_text(origin, std::move(pictures)));
    };
  const bool reached = result.shortfalls.empty() && (!branches || branches->shortfalls.empty());
  const int status =
      deliver(folder ? &*folder : nullptr, out.pictures, ended_status(reached ? exit_ok : exit_not_reached), delivery);
  if (out.stats && !out.json) say_stages(swept, result, branches);
  keep_until_exit(std::move(document));
  keep_until_exit(std::move(result));
  return status;
}

}  // namespace

void add_sweep_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "sweep", "along speeds or any other number: peaks, exponents, Campbell diagram, critical speeds, unstable bands");
  const auto flags = std::make_shared<SweepFlags>();
  add_sweep_flags(*command, *flags);
  command->callback([flags, &status] { status = run_sweep_command(*flags); });
}

}  // namespace hb::tools
