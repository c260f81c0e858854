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
#include "tools/output/csv_output.hpp"
#include "tools/output/output_file.hpp"
#include "tools/pictures/figures.hpp"
#include "tools/report/page_pictures.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

struct ReportFlags : CommonFlags {
  std::string x, y;
};

// The map asked for beside the sweep, whose speeds are not its own.
std::optional<AskedMap> asked_map(const ReportFlags& flags, const SceneInput& input, const Work& work) {
  if (flags.x.empty() && flags.y.empty()) return std::nullopt;
  CommonFlags of_map = flags;
  of_map.rpm.clear();
  of_map.omega.clear();
  return AskedMap(of_map, flags.x, flags.y, "", BoundaryFlags{}, input, work);
}

std::vector<PageText::Picture> pictures(const SweepScene& scene, const SweepResult& result, const AskedMap* map) {
  return page_pictures([&](OutputFolder& folder) {
    std::vector<Figure> figures = sweep_files(scene, result, folder);
    if (scene.first().linkage() != nullptr) {
      const CsvFile mechanism = mechanism_csv(scene.scene());
      folder.write(mechanism.name, csv_text(mechanism));
      figures.push_back(mechanism_figure(scene.scene(), mechanism));
    }
    if (map != nullptr)
      for (Figure& figure : map_files(map->document(), MapColour::growth, folder)) figures.push_back(std::move(figure));
    return figures;
  });
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
  OutputFile file(*out.folder);

  const SweepScene sweep_scene(input.source, set, options, std::move(asked.axis), asked.speed, asked.rpm);
  // A page whose file is not there yet: Ctrl-C leaves nothing, the end of the time what there is.
  std::optional<InterruptGuard> guard(std::in_place, false);
  SharedWork work(out.threads, nullptr, {}, time_is_up);
  const SweepResult result = run_sweep(sweep_scene, work);
  ReportData data(scene);
  data.add_sweep(sweep_scene, result, places_along(sweep_scene, work));
  bool reached = result.shortfalls.empty();
  if (map) {
    map->compute(work);
    reached = reached && map->document().complete;
    data.add_map(map_json(map->document()), input.source);
  }
  guard.reset();
  begin_delivery();
  std::vector<PageText::Picture> still;
  if (out.plots) still = pictures(sweep_scene, result, map ? &*map : nullptr);
  file.commit(data.page(page_text(provenance(flags.line, input), std::move(still))));
  for (const std::string& sentence : result.shortfalls) fmt::print(stderr, "NOT REACHED: {}\n", sentence);
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
  command->get_option("--no-plots")->description("no pictures for readers without JavaScript");
  command->add_option("--x", flags->x, "a map too: its first parameter, as in rpm=200:6000:100 (100 points)")
      ->type_name("PATH=A:B:N|A:B:xN");
  command->add_option("--y", flags->y, "its second parameter, as in AB.J=30:60:50 or *.J=30:60:50")
      ->type_name("PATH=A:B:N|A:B:xN");
  command->callback([flags, &status] { status = run_report(*flags); });
}

}  // namespace hb::tools
