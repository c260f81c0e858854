// hb report: speeds, and if asked for a map, as one self-contained HTML page.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/analyses.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/map_flags.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/result_files.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/sweep_axis.hpp"
#include "tools/command/sweep_flags.hpp"
#include "tools/command/sweep_forecast.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/output_file.hpp"
#include "tools/output/sweep_bands.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

struct ReportFlags : CommonFlags {
  std::string x, y;
  std::vector<std::string> bands;
  TheoryFlags theory;
};

// The map asked for beside the sweep, whose speeds are not its own.
std::optional<MapTask> asked_map(const ReportFlags& flags, const SceneInput& input, const Work& work) {
  if (flags.x.empty() && flags.y.empty()) return std::nullopt;
  CommonFlags of_map = flags;
  of_map.rpm.clear();
  of_map.omega.clear();
  MapFlags map;
  map.x = flags.x;
  map.y = flags.y;
  return std::optional<MapTask>(std::in_place, SceneFamily(input.source, overrides(flags)),
                                asked_map(of_map, map, input), work);
}

// The file is a web page, and its name says so.
void require_page(const std::string& file) {
  if (file.empty()) throw UsageError("--out: not given, allowed: the page's file, as in --out report.html");
  std::string ending = std::filesystem::path(file).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".html" || ending == ".htm") return;
  throw UsageError(fmt::format("--out: found \"{}\", allowed: a file that ends in .html or .htm{}", file,
                               ending == ".pdf" ? " (a browser prints the page to PDF)" : ""));
}

int run_report(const ReportFlags& flags) {
  if (const std::string obstacle = report_obstacle(); !obstacle.empty()) throw UsageError("report: " + obstacle);
  require_page(flags.out.value_or(""));
  const SceneInput input = scene_input(flags.scene_file);
  const std::vector<Override> set = overrides(flags);
  const Scene scene = input.source.with(set);
  const Output out = output(flags);
  const SweepRequest request = asked_sweep(flags, "", input.source, scene);
  const SharedWork geometry(out.threads, nullptr, {}, time_is_up);
  const std::optional<MapTask> task = asked_map(flags, input, geometry);
  const std::shared_ptr<const SweepScene> along = sweep_scene(SceneFamily(input.source, set), request);
  NonlinearSweepOptions branches_asked;
  branches_asked.turns = turns_of(flags.theory);
  branches_asked.stop = stop_of();
  const bool nonlinear = is_nonlinear(flags.theory);
  if (nonlinear) require_nonlinear(*along, branches_asked);
  const std::vector<BandRequest> bands_asked = bands_of(flags.bands, flags.theory);
  OutputFile file(*out.folder, "report");

  // A page whose file is not there yet: Ctrl-C leaves nothing, the end of the time what there is.
  std::optional<InterruptGuard> guard(std::in_place, false);
  SharedWork work(out.threads, nullptr, {}, time_is_up, "the page");
  const SweepResult result = run_sweep(*along, work);
  std::optional<NonlinearSweep> found;
  if (nonlinear) found = announced_branches(*along, branches_asked);
  const NonlinearSweep* branches = found ? &*found : nullptr;
  ReportData data(scene);
  data.add_sweep(*along, result, places_along(*along, work, branches), branches);
  if (!bands_asked.empty()) {
    nlohmann::ordered_json document = sweep_json(*along, result, false);
    document["bands"] = sweep_bands_json(document, sweep_bands(scene, request, bands_asked, work));
    data.add_sweep_bands(document);
  }
  bool reached = result.shortfalls.empty() && (!branches || branches->shortfalls.empty());
  std::optional<Map> map;
  if (task) {
    map = task->compute(work);
    reached = reached && map->complete;
    data.add_map(map_json(document_of(*map)), input.source);
  }
  guard.reset();
  begin_delivery();
  std::vector<PageText::Picture> still;
  if (out.pictures.drawn) {
    const std::optional<MapDocument> document = map ? std::optional(document_of(*map)) : std::nullopt;
    still = report_pictures(*along, result, branches, document ? &*document : nullptr);
  }
  file.commit(data.page(page_text(provenance(flags.line, input), std::move(still))));
  std::vector<std::string> shortfalls = result.shortfalls;
  if (branches) shortfalls.insert(shortfalls.end(), branches->shortfalls.begin(), branches->shortfalls.end());
  for (const std::string& sentence : shortfalls) fmt::print(stderr, "NOT REACHED: {}\n", sentence);
  return reached ? exit_ok : exit_not_reached;
}

}  // namespace

void add_report_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("report", "one HTML page that moves: a sweep and, with --x and --y, a map");
  const auto flags = std::make_shared<ReportFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags);
  command->get_option("--out")->description("the page's file")->type_name("FILE");
  command->remove_option(command->get_option("--json"));
  command->remove_option(command->get_option("--stats"));
  add_theory_flags(*command, flags->theory);
  add_band_flag(*command, flags->bands);
  for (const char* name : {"--format", "--size", "--no-titles", "--label"})
    command->remove_option(command->get_option(name));
  command->get_option("--no-plots")->description("no pictures for readers without JavaScript");
  command->add_option("--x", flags->x, "a map too: its first parameter, as in rpm=200:6000:100 (100 points)")
      ->type_name("PATH=A:B:N|A:B:xN");
  command->add_option("--y", flags->y, "its second parameter, as in AB.J=30:60:50 or *.J=30:60:50")
      ->type_name("PATH=A:B:N|A:B:xN");
  command->callback([flags, &status] { status = run_report(*flags); });
}

}  // namespace hb::tools
