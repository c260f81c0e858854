// hb bench: error against run time of the periodic state, for harmonic balance and for time integration.
#include "hb/analysis/bench.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/speed_flags.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/bench_output.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/pictures/bench_figures.hpp"
#include "tools/work/forecast.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/progress.hpp"

namespace hb::tools {
namespace {

struct BenchFlags {
  CommonFlags common;
  TheoryFlags theory;
  std::string case_limit;
};

int run_bench(const BenchFlags& flags) {
  const SceneInput input = scene_input(flags.common.scene_file);
  const Scene scene = input.source.with(overrides(flags.common));
  BenchRequest request;
  static_cast<Request&>(request) = asked_request(flags.common, scene);
  const Output out = output(flags.common);
  set_speed(request, first_speed(flags.common, scene));
  if (!flags.case_limit.empty()) request.case_limit = seconds_flag("--case-limit", flags.case_limit, 1e6);
  const bool nonlinear = is_nonlinear(flags.theory);
  std::optional<InterruptGuard> guard;
  if (nonlinear) guard.emplace(false);
  NonlinearOptions motion;
  motion.turns = turns_of(flags.theory);
  motion.stop = stop_of();
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "bench", provenance(flags.common.line, input));

  std::optional<Progress> progress;
  std::optional<Forecast> forecast;
  request.told = [&](std::size_t, std::size_t total) {
    if (!progress) {
      progress.emplace("cases", total);
      forecast.emplace("the benchmark", 1);
      forecast->begin(total);
    }
    progress->advance();
    forecast->advance();
  };
  const Bench found = nonlinear ? nonlinear_bench(scene, request, motion) : bench(scene, request);
  progress.reset();
  const nlohmann::ordered_json document = bench_json(found);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : bench_text(found);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("bench.json", json_file_text(document));
    place.write("bench.csv", bench_csv(found));
    return bench_figures(found);
  };
  return deliver(folder ? &*folder : nullptr, out.pictures, found.complete() ? exit_ok : exit_not_reached, delivery);
}

}  // namespace

void add_bench_command(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("bench", "error against run time: harmonic balance, shooting, marching, Newmark, Runge-Kutta");
  const auto flags = std::make_shared<BenchFlags>();
  add_scene_flags(*command, flags->common);
  add_analysis_flags(*command, flags->common, SpeedsTaken::one);
  add_theory_flags(*command, flags->theory);
  command->add_option("--case-limit", flags->case_limit, "seconds for each case; default 5")->type_name("SECONDS");
  command->footer(
      "Every method runs on one thread at its own list of tolerances, on the periodic state: --tol, --only, "
      "--threads,\n"
      "--stability-method and --stats change nothing.");
  command->callback([flags, &status] { status = run_bench(*flags); });
}

}  // namespace hb::tools
