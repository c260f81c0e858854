// hb sweep: everything along the speed or any other scene number, with resonance peaks and unstable bands located.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/command/parameter_range.hpp"
#include "tools/work/ranks.hpp"
#include "tools/work/shared_work.hpp"
#include "hb/analysis/sweep_analysis.hpp"
#include "tools/pictures/sweep_figures.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/work/sweep_parts.hpp"
#include "tools/output/table_output.hpp"

namespace hb::tools {
namespace {

struct SweepFlags : CommonFlags {
  std::string x;
  bool resume = false;
};

void require_speeds(const std::string& flag, const Axis& axis, const Units& units) {
  const double lowest = axis.kind == Axis::Kind::rpm ? speed_from_rpm(axis.values.front(), units) : axis.values.front();
  if (!(lowest >= std::numeric_limits<double>::min())) {
    throw UsageError(fmt::format("{}: found a range from {}, allowed: positive speeds", flag, axis.values.front()));
  }
}

struct AxisAndSpeed {
  Axis axis;
  double speed = 0, rpm = 0;  // where that is not the axis
};

AxisAndSpeed axis_of(const SweepFlags& flags, const Scene& scene) {
  Axis axis;
  if (flags.x.empty()) {
    const auto [speeds, in_rpm] = speed_range(flags, scene);
    axis.kind = in_rpm ? Axis::Kind::rpm : Axis::Kind::omega;
    axis.path = in_rpm ? "rpm" : "omega";
    const std::string flag = "--" + axis.path;
    if (speeds.from == speeds.to || speeds.step == 0) {
      throw UsageError(
          fmt::format("{}: found the single speed {}, allowed: a range FROM:TO:STEP (hb steady does one "
                      "speed)",
                      flag, speeds.from));
    }
    axis.values = range_by_step(flag, speeds.from, speeds.to, speeds.step);
    require_speeds(flag, axis, scene.units);
    return {std::move(axis)};
  }
  const NamedRange range = named_range("--x", flags.x);
  axis.path = range.path;
  axis.values = range_by_step("--x", range.range);
  for (const Override& set : overrides(flags)) {
    if (set.path == axis.path) {
      throw UsageError(fmt::format("--set: found {} beside --x {}, allowed: one of the two", set.path, flags.x));
    }
  }
  if (axis.path == "rpm" || axis.path == "omega") {
    axis.kind = axis.path == "rpm" ? Axis::Kind::rpm : Axis::Kind::omega;
    if (!flags.rpm.empty() || !flags.omega.empty()) {
      throw UsageError(fmt::format("--{}: found {} beside --x {}, allowed: one of the two",
                                   flags.rpm.empty() ? "omega" : "rpm", flags.rpm.empty() ? flags.omega : flags.rpm,
                                   flags.x));
    }
    require_speeds("--x", axis, scene.units);
    return {std::move(axis)};
  }
  axis.kind = Axis::Kind::parameter;
  const double speed = single_speed(flags, scene);
  const auto [speeds, in_rpm] = speed_range(flags, scene);
  return {std::move(axis), speed, in_rpm ? speeds.from : rpm_from_speed(speed, scene.units)};
}

std::vector<Figure> write_tables(const SweepScene& scene, const SweepResult& result, OutputFolder& folder) {
  std::vector<Figure> figures;
  const Only& only = result.computed;
  const CsvFile critical = critical_csv(scene, result);
  if (only.steady) folder.write(critical.name, csv_text(critical));
  if (only.stability) {
    const CsvFile bands = bands_csv(scene, result);
    folder.write(bands.name, csv_text(bands));
  }
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    if (!result.rods[r].reported || !(only.steady || only.stability || only.shape)) continue;
    const CsvFile rod = sweep_rod_csv(scene, result, r);
    folder.write(rod.name, csv_text(rod));
    if (only.stability) {
      figures.push_back(campbell_figure(scene, result, r, rod, critical.name));
      figures.push_back(growth_figure(scene, result, r, rod));
    }
    if (only.steady) figures.push_back(peaks_figure(scene, result, r, rod));
    if (only.shape) figures.push_back(strain_figure(scene, result, r, rod));
  }
  if (only.reactions) {
    const CsvFile forces = sweep_forces_csv(scene, result);
    folder.write(forces.name, csv_text(forces));
    for (Figure& figure : sweep_force_figures(scene, result, forces)) figures.push_back(std::move(figure));
  }
  return figures;
}

int run_sweep_command(const SweepFlags& flags) {
  SceneSource source(flags.scene_file);
  const std::vector<Override> set = overrides(flags);
  const Scene scene = source.with(set);
  Settings options = settings(flags, scene);
  AxisAndSpeed asked = axis_of(flags, scene);
  std::optional<OutputFolder> folder;
  if (options.out && ranks().first()) folder.emplace(*options.out);

  const SweepScene sweep_scene(std::move(source), set, options, std::move(asked.axis), asked.speed, asked.rpm);
  SweepResult result;
  const bool finished = run_kept("sweep", options.out, flags.resume, sweep_key(sweep_scene), options.threads,
                                 [&](SharedWork& work) { result = run_sweep(sweep_scene, work); });
  if (!finished) return exit_interrupted;
  const nlohmann::ordered_json document =
      options.json || folder ? sweep_json(sweep_scene, result) : nlohmann::ordered_json();
  if (folder) {
    folder->write("sweep.json", document.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    draw_figures(write_tables(sweep_scene, result, *folder), *folder, options.plots);
    folder->commit();
  }
  if (options.json) {
    print_json(document);
  } else {
    fmt::print("{}", sweep_table(sweep_scene, result));
  }
  if (options.stats && !options.json) fmt::print(stderr, "\n{}", stages_table(result.stages));
  return result.shortfalls.empty() ? exit_ok : exit_not_reached;
}

}  // namespace

void add_sweep_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "sweep", "along speeds or any other number: peaks, exponents, Campbell diagram, critical speeds, unstable bands");
  const auto flags = std::make_shared<SweepFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags);
  command->add_option("--x", flags->x, "sweep this scene number instead of the speed, as in AB.J=30:60:1")
      ->type_name("PATH=A:B:STEP");
  command->add_flag("--resume", flags->resume, "go on where an interrupted run into the same --out stopped");
  command->callback([flags, &status] { status = run_sweep_command(*flags); });
}

}  // namespace hb::tools
