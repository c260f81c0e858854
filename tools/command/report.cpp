// hb report: speeds, and if asked for a map, as one self-contained HTML page.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/sweep_analysis.hpp"
#include "tools/command/asked_map.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/result_files.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/sweep_axis.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/output_file.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

struct ReportFlags : CommonFlags {
  std::string x, y;
  TheoryFlags theory;
};

// The map asked for beside the sweep, whose speeds are not its own.
std::optional<AskedMap> asked_map(const ReportFlags& flags, const SceneInput& input, const Work& work) {
  if (flags.x.empty() && flags.y.empty()) return std::nullopt;
  CommonFlags of_map = flags;
  of_map.rpm.clear();
  of_map.omega.clear();
  return AskedMap(of_map, flags.x, flags.y, "", BoundaryFlags{}, input, work);
}

int run_report(const ReportFlags& flags) {
  if (const std::string obstacle = report_obstacle(); !obstacle.empty()) throw UsageError("report: " + obstacle);
  const SceneInput input = scene_input(flags.scene_file);
  const std::vector<Override> set = overrides(flags);
  const Scene scene = input.source.with(set);
  const Settings options = settings(flags, scene);
  const Output out = output(flags);
  if (!out.folder) throw UsageError("--out: not given, allowed: the page's file, as in --out report.html");
  AxisAndSpeed asked = axis_of(flags, "", scene);
  const SharedWork geometry(out.threads, nullptr, {}, time_is_up);
  std::optional<AskedMap> map = asked_map(flags, input, geometry);
  const SweepScene sweep_scene(input.source, set, options, std::move(asked.axis), asked.speed, asked.rpm);
  const bool nonlinear = is_nonlinear(flags.theory);
  NonlinearSweepOptions branches_asked;
  branches_asked.turns = turns_of(flags.theory);
  branches_asked.stop = stop_of();
  if (nonlinear) require_nonlinear(sweep_scene, branches_asked);
  OutputFile file(*out.folder, "report");

  // A page whose file is not there yet: Ctrl-C leaves nothing, the end of the time what there is.
  std::optional<InterruptGuard> guard(std::in_place, false);
  SharedWork work(out.threads, nullptr, {}, time_is_up);
  const SweepResult result = run_sweep(sweep_scene, work);
  std::optional<NonlinearSweep> branches;
  if (nonlinear) branches = nonlinear_sweep(sweep_scene, branches_asked);
  const NonlinearSweep* along = branches ? &*branches : nullptr;
  ReportData data(scene);
  data.add_sweep(sweep_scene, result, places_along(sweep_scene, work, along), along);
  bool reached = result.shortfalls.empty() && (!branches || branches->shortfalls.empty());
  if (map) {
    map->compute(work);
    reached = reached && map->document().complete;
    data.add_map(map_json(map->document()), input.source);
  }
  guard.reset();
  begin_delivery();
  std::vector<PageText::Picture> still;
  if (out.plots) {
    const std::optional<MapDocument> document = map ? std::optional(map->document()) : std::nullopt;
    still = report_pictures(sweep_scene, result, along, document ? &*document : nullptr);
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
  command->get_option("--no-plots")->description("no pictures for readers without JavaScript");
  command->add_option("--x", flags->x, "a map too: its first parameter, as in rpm=200:6000:100 (100 points)")
      ->type_name("PATH=A:B:N|A:B:xN");
  command->add_option("--y", flags->y, "its second parameter, as in AB.J=30:60:50 or *.J=30:60:50")
      ->type_name("PATH=A:B:N|A:B:xN");
  command->callback([flags, &status] { status = run_report(*flags); });
}

}  // namespace hb::tools
