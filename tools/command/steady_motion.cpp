#include "tools/command/steady_motion.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/measured_deviation.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/speed_flags.hpp"
#include "tools/command/steady_files.hpp"
#include "tools/output/band_output.hpp"
#include "tools/output/csv_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/nonlinear_output.hpp"
#include "tools/output/table_output.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {

int run_steady_motion(const SteadyFlags& flags) {
  const SceneInput input = scene_input(flags.scene_file);
  const Scene scene = input.source.with(overrides(flags));
  Request request = asked_request(flags, scene);
  const Output out = output(flags);
  set_speed(request, first_speed(flags, scene));
  const InterruptGuard guard(false);
  NonlinearOptions asked;
  asked.turns = turns_of(flags.theory);
  asked.stop = stop_of();
  std::optional<OutputFolder> folder;
  const Provenance origin = provenance(flags.line, input);
  if (out.folder) folder.emplace(*out.folder, "steady", origin);
  const std::vector<BandRequest> bands_asked = bands_of(flags.bands);
  NonlinearSteady result = nonlinear_steady(scene, request, asked);
  const SceneModel& model = *result.model;
  say_time_limit(flags.time_limit, asked.stop, result.shortfalls);
  nlohmann::ordered_json document = out.json || folder || !bands_asked.empty()
                                        ? nonlinear_json(model, result, result.settings, out.stats)
                                        : nlohmann::ordered_json();
  if (!bands_asked.empty())
    document["bands"] = bands_json(document, nonlinear_bands(scene, request, asked, bands_asked));
  const SpeedResult motion = as_speed_result(result);
  std::optional<MeasuredComparison> measured;
  if (!flags.measured.empty() && result.search == MotionSearch::found)
    measured = compare_measured(flags.measured, model, motion, "nonlinear", result.turns);
  if (measured && !document.is_null()) document["measured"] = measured_json(*measured);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : nonlinear_table(model, result);
  if (!out.json && !bands_asked.empty()) delivery.printed += bands_table(document["bands"]);
  if (!out.json && measured) delivery.printed += measured_table(*measured);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("steady.json", json_file_text(document));
    const MeasuredOverlay overlay = measured ? measured->overlay : MeasuredOverlay();
    if (result.turns == 1) return steady_files(model, motion, machine_files(result), place, overlay);
    if (measured) place.write(overlay.csv().name, csv_text(overlay.csv()));
    return std::vector<Figure>();
  };
  if (out.html)
    delivery.page = [&](std::vector<PageText::Picture> pictures) {
      ReportData data(model.scene);
      data.add_speed(nonlinear_place(result.model, result, result.settings), result.settings);
      if (document.contains("bands")) data.add_bands(document["bands"]);
      return data.page(page_text(origin, std::move(pictures)));
    };
  const int status = deliver(folder ? &*folder : nullptr, out.pictures,
                             ended_status(result.shortfalls.empty() ? exit_ok : exit_not_reached), delivery);
  if (out.stats && !out.json)
    fmt::print(stderr, "\n{}{}{}", stages_table(model.stages), stages_table(result.stages),
               accuracy_table(result.settings));
  return status;
}

}  // namespace hb::tools
