// hb sweep: everything along the speed or any other scene number, with resonance peaks and unstable bands located.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/sweep_analysis.hpp"
#include "lib/scene/scene_reader.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/result_files.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/sweep_axis.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/branches_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/motion_input.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/table_output.hpp"
#include "tools/report/report_data.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/ranks.hpp"
#include "tools/work/shared_work.hpp"
#include "tools/work/sweep_key.hpp"

namespace hb::tools {
namespace {

struct SweepFlags : CommonFlags {
  std::string x;
  TheoryFlags theory;
  std::vector<std::string> start;
  bool no_search = false, resume = false, restart = false;
};

int run_sweep_command(const SweepFlags& flags) {
  const SceneInput input = scene_input(flags.scene_file);
  const std::vector<Override> set = overrides(flags);
  const Scene scene = input.source.with(set);
  Settings options = settings(flags, scene);
  options.search = !flags.no_search;
  const Output out = output(flags);
  AxisAndSpeed asked = axis_of(flags, flags.x, scene);
  const bool nonlinear = is_nonlinear(flags.theory);
  NonlinearSweepOptions branches_asked;
  branches_asked.turns = turns_of(flags.theory);
  branches_asked.stop = stop_of();
  if (!nonlinear && !flags.start.empty())
    throw UsageError(
        fmt::format("--start: found {} with the linear theory, allowed: with --theory nonlinear", flags.start.front()));
  const EarlierParts earlier = earlier_parts_flag(flags.resume, flags.restart, out.folder.has_value());
  const Provenance origin = provenance(flags.line, input);
  std::optional<OutputFolder> folder;
  if (out.folder && ranks().first()) folder.emplace(*out.folder, "sweep", origin);

  const SweepScene sweep_scene(input.source, set, options, std::move(asked.axis), asked.speed, asked.rpm);
  for (const std::string& file : flags.start)
    branches_asked.starts.push_back(motion_from_json(read_text_file(file), file, sweep_scene));
  if (nonlinear) require_nonlinear(sweep_scene, branches_asked);
  SweepResult result;
  KeptRun run("sweep", out.folder, earlier, sweep_key(sweep_scene), out.threads);
  if (!run.run([&](SharedWork& work) { result = run_sweep(sweep_scene, work); })) return stopped_status();
  std::optional<NonlinearSweep> branches;
  if (nonlinear) {
    const InterruptGuard guard(false);
    branches = nonlinear_sweep(sweep_scene, branches_asked);
    if (branches->stopped) say_time_limit(flags.time_limit, branches_asked.stop, branches->shortfalls);
  }
  nlohmann::ordered_json document =
      out.json || folder ? sweep_json(sweep_scene, result, out.stats) : nlohmann::ordered_json();
  if (branches && !document.is_null()) add_branches(document, sweep_scene, *branches);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : sweep_table(sweep_scene, result);
  if (branches && !out.json)
    delivery.printed = "By the linear theory; the motion without linearisation stands below.\n" + delivery.printed +
                       branches_table(sweep_scene, *branches);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("sweep.json", json_file_text(document));
    std::vector<Figure> figures = sweep_files(sweep_scene, result, place);
    if (branches)
      for (Figure& figure : branch_files(sweep_scene, result, *branches, place)) figures.push_back(std::move(figure));
    return figures;
  };
  delivery.committed = [&] { run.delivered(); };
  if (out.html)
    delivery.page = [&](std::vector<PageText::Picture> pictures) {
      ReportData data(sweep_scene.scene());
      const NonlinearSweep* along = branches ? &*branches : nullptr;
      data.add_sweep(sweep_scene, result, places_along(sweep_scene, SharedWork(out.threads), along), along);
      return data.page(page_text(origin, std::move(pictures)));
    };
  const bool reached = result.shortfalls.empty() && (!branches || branches->shortfalls.empty());
  const int status =
      deliver(folder ? &*folder : nullptr, out.plots, ended_status(reached ? exit_ok : exit_not_reached), delivery);
  if (out.stats && !out.json) fmt::print(stderr, "\n{}", stages_table(result.stages));
  if (out.stats && !out.json && branches) fmt::print(stderr, "{}", stages_table(branches->stages));
  return status;
}

}  // namespace

void add_sweep_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "sweep", "along speeds or any other number: peaks, exponents, Campbell diagram, critical speeds, unstable bands");
  const auto flags = std::make_shared<SweepFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags);
  allow_growth_alone(*command, *flags);
  command->add_flag("--no-search", flags->no_search, "the points alone: no bands, boundaries or peaks between them");
  add_html_flag(*command, *flags);
  command
      ->add_option("--x", flags->x,
                   "sweep this scene number instead of the speed, as in AB.J=30:60:1 or AB.J=30:60:x31 (31 points)")
      ->type_name("PATH=A:B:STEP|A:B:xN");
  add_theory_flags(*command, flags->theory);
  command
      ->add_option("--start", flags->start,
                   "with --theory nonlinear: follow branches from this motion as well, a steady.json of hb steady")
      ->type_name("FILE");
  command->add_flag("--resume", flags->resume, "go on where an interrupted run into the same --out stopped");
  command->add_flag("--restart", flags->restart, "throw away what an interrupted run into the same --out left");
  command->callback([flags, &status] { status = run_sweep_command(*flags); });
}

}  // namespace hb::tools
