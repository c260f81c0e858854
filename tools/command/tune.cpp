// hb tune: scene numbers that minimise a goal under conditions, worst over a range of speeds.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/command/asked.hpp"
#include "tools/command/asked_tune.hpp"
#include "tools/command/command.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/table_output.hpp"
#include "tools/output/tune_output.hpp"
#include "tools/pictures/tune_pictures.hpp"
#include "tools/report/design_page.hpp"
#include "tools/work/forecast.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

// How long the search may take, and on a terminal the designs tried so far; on standard error.
std::function<void(int, bool, double)> progress_of(const TuneFlags& flags, int most, int threads) {
  const double sign = flags.maximise.empty() ? 1 : -1;
  const bool shown = isatty(STDERR_FILENO) != 0;
  const auto forecast = std::make_shared<Forecast>("the search", threads, true);
  forecast->begin(static_cast<std::size_t>(most));
  return [sign, shown, forecast, done = 0](int evaluations, bool feasible, double goal) mutable {
    forecast->advance(static_cast<std::size_t>(std::max(0, evaluations - done)));
    done = evaluations;
    if (!shown) return;
    fmt::print(stderr, "\r\033[Ktune: {} designs, best {}{:.6g}", evaluations, feasible ? "" : "(conditions not met) ",
               sign * goal);
  };
}

int run_tune(const TuneFlags& flags) {
  const SceneInput input = scene_input(flags.scene_file);
  AskedTune asked = asked_tune(flags, input);
  for (const std::string& remark : asked.remarks) fmt::print(stderr, "hb tune: {}\n", remark);
  TuneTask& task = asked.task;
  const Scene& scene = asked.scene;
  const std::filesystem::path file = flags.scene_file;
  const Output out = output(flags);
  task.options.progress = progress_of(flags, task.options.max_evaluations, out.threads);

  const Provenance origin = provenance(flags.line, input);
  std::optional<OutputFolder> folder;
  if (out.folder) {
    for (const char* name : {tuned_file, nearest_file}) {
      std::error_code none;
      if (std::filesystem::equivalent(*out.folder / name, file, none))
        throw UsageError(
            fmt::format("--out: found {}, where {} would replace the scene itself; allowed: another folder",
                        out.folder->string(), name));
    }
    folder.emplace(*out.folder, "tune", origin);
  }
  task.options.stop = early_end(out.folder.has_value());
  std::optional<TuneResult> found;
  try {
    const InterruptGuard guard(!out.folder);
    found = tune(task, SharedWork(out.threads));
  } catch (const RequestError&) {  // no design yet
    if (!asked_to_end()) throw;
    return stopped_status(out.json);
  }
  const TuneResult& result = *found;
  if (isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r\033[K");
  task.settings.modes = result.num_modes;

  const nlohmann::ordered_json document = tune_json(task, result, scene, out.stats);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : tune_table(task, result, scene);
  if (!out.json && folder)
    delivery.printed += fmt::format("written: {}\n", (*out.folder / scene_file(result)).string());
  delivery.write_data = [&](OutputFolder& place) -> std::vector<Figure> {
    place.write(scene_file(result), tuned_scene(asked.source, task, result, scene.units, file, *out.folder));
    place.write("tune.json", json_file_text(document));
    const CsvFile history = history_csv(task, result);
    place.write(history.name, csv_text(history));
    write_curves(task, result, scene, place);
    return {};
  };
  delivery.write_more = [&](OutputFolder& place) { return tune_figures(task, result, scene, out.threads, place); };
  if (out.html)
    delivery.page = [&](std::vector<PageText::Picture> pictures) {
      SharedWork work(out.threads);
      return design_page(task, result, scene, document, work, page_text(origin, std::move(pictures)));
    };
  const int status = deliver(folder ? &*folder : nullptr, out.pictures,
                             ended_status(shortfall(result).empty() ? exit_ok : exit_not_reached), delivery);
  if (out.stats && !out.json) fmt::print(stderr, "\n{}{}", stages_table(result.stages), accuracy_table(task.settings));
  return status;
}

}  // namespace

void add_tune_command(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("tune", "design: scene numbers that minimise a goal under conditions over a range of speeds");
  const auto flags = std::make_shared<TuneFlags>();
  add_tune_flags(*command, *flags);
  command->callback([flags, &status] { status = run_tune(*flags); });
}

}  // namespace hb::tools
