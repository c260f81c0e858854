// hb map: stability over two numbers of a scene, one of which may be the speed.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "lib/stopwatch.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/map_flags.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/result_files.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/table_output.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/forecast.hpp"
#include "tools/work/map_key.hpp"
#include "tools/work/ranks.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

// Of the values at the points, which are held until the end, and of the worst of several rods.
double bytes_of(const MapTask& task) {
  const std::size_t points = task.x().values.size() * task.y().values.size(), rods = task.plane().rods().size();
  return static_cast<double>(sizeof(MapPoint) * points * (rods > 1 ? rods + 1 : rods));
}

struct MapCommandFlags : CommonFlags {
  MapFlags map;
  std::string theory = "linear", colour = "growth";
  bool resume = false, restart = false;
};

MapColour colour_flag(const std::string& text) {
  if (text == "growth") return MapColour::growth;
  if (text == "turn") return MapColour::per_turn;
  if (text == "tenfold") return MapColour::tenfold_time;
  throw UsageError(fmt::format("--colour: found \"{}\", allowed: growth, turn, tenfold", text));
}

// What the map took, and what of it was not asked for.
std::vector<Stage> stages_of(const Map& map, double seconds) {
  std::vector<Stage> stages = {{"stability over the plane", seconds, map.evidence}};
  if (!map.settings.boundaries) stages.push_back({"boundaries", 0, "not asked for", true});
  return stages;
}

int run_map(const MapCommandFlags& flags) {
  const MapColour colour = colour_flag(flags.colour);
  require_linear(flags.theory, "stability without linearisation goes along one number: hb sweep --theory nonlinear");
  const SceneInput input = scene_input(flags.scene_file);
  const Output out = output(flags);
  const EarlierParts earlier = earlier_parts_flag(flags.resume, flags.restart, out.folder.has_value());
  const Provenance origin = provenance(flags.line, input);
  const SharedWork geometry(out.threads, nullptr, {}, early_end(out.folder.has_value()));
  const MapTask task(SceneFamily(input.source, overrides(flags)), asked_map(flags, flags.map, input), geometry);
  say_memory("the map", bytes_of(task));
  std::optional<OutputFolder> folder;
  if (out.folder && ranks().first()) folder.emplace(*out.folder, "map", origin);

  std::optional<Map> map;
  const Stopwatch watch;
  KeptRun run("map", out.folder, earlier, map_key(task), out.threads);
  if (!run.run([&](SharedWork& work) { map = task.compute(work); })) return stopped_status(out.json);

  MapDocument document = document_of(*map);
  const std::vector<Stage> stages = stages_of(*map, watch.seconds());
  if (out.stats) {
    document.settings = &task.settings();
    document.stages = stages;
  }
  Delivery delivery;
  const LongText text = [&](const TextSink& sink) { write_map(document, sink, out.threads); };
  if (out.json)
    delivery.document = text;
  else
    delivery.printed = map_summary(document);
  delivery.write_data = [&](OutputFolder& place) {
    place.write_long("map.json", text);
    return map_files(document, colour, place);
  };
  delivery.committed = [&] { run.delivered(); };
  if (out.html)
    delivery.page = [&](std::vector<PageText::Picture> pictures) {
      ReportData data(map->scene);
      data.add_map(map_json(document), input.source);
      return data.page(page_text(origin, std::move(pictures)));
    };
  // No tolerance of boundaries was asked for without the flag.
  const bool reached = flags.map.boundary_tolerance.empty() || boundary_points_not_reached(*map) == 0;
  const int status = deliver(folder ? &*folder : nullptr, out.pictures,
                             ended_status(document.complete && reached ? exit_ok : exit_not_reached), delivery);
  if (out.stats && !out.json) fmt::print(stderr, "\n{}{}", stages_table(stages), accuracy_table(task.settings()));
  return status;
}

}  // namespace

void add_map_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "map", "stability over two parameters: growth rate on a grid, boundaries with their kind, resonance lines");
  const auto flags = std::make_shared<MapCommandFlags>();
  add_scene_flags(*command, *flags);
  add_linear_theory_flag(*command, flags->theory);
  add_analysis_flags(*command, *flags, SpeedsTaken::one);
  allow_growth_alone(*command, *flags);
  command->add_flag("--no-boundaries", flags->map.no_boundaries, "the grid alone: no curves where the verdict changes");
  command->add_flag("--stress", flags->map.stress,
                    "also stress, safety and deflection at every point, of links with a section");
  command
      ->add_option("--boundary-tol", flags->map.boundary_tolerance,
                   "relative error of boundary points, 1e-14 to 0.01; default a tenth of --tol")
      ->type_name("T");
  flags->label_axes = "xy";
  add_band_flag(*command, flags->map.bands);
  add_html_flag(*command, *flags);
  command->add_option("--x", flags->map.x, "first parameter, as in rpm=200:6000:100 (100 points)")
      ->type_name("PATH=A:B:N|A:B:xN");
  command->add_option("--y", flags->map.y, "second parameter, as in AB.J=30:60:50 or *.J=30:60:50")
      ->type_name("PATH=A:B:N|A:B:xN");
  command
      ->add_option("--damping-range", flags->map.damping_range,
                   "boundaries also with the internal damping (of a [hill] scene: the damping) times both factors")
      ->type_name("A:B");
  command
      ->add_option("--colour", flags->colour, "colours of the picture: growth, turn (growth per turn), tenfold (time)")
      ->type_name("WHAT");
  command->add_flag("--resume", flags->resume, "go on where an interrupted run into the same --out stopped");
  command->add_flag("--restart", flags->restart, "throw away what an interrupted run into the same --out left");
  command->callback([flags, &status] { status = run_map(*flags); });
}

}  // namespace hb::tools
