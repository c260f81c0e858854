// hb bench: error against run time of the periodic state, for harmonic balance and for time integration.
#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/bench_rod.hpp"
#include "hb/analysis/nonlinear/nonlinear_bench.hpp"
#include "lib/rod/time_domain_rod.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/figure_text.hpp"
#include "tools/pictures/gnuplot.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/progress.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr double accuracies[] = {1e-3, 1e-6, 1e-9, 1e-12};

double peak_memory_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

std::string bench_text(const SceneModel& model, double speed, const std::vector<RodBench>& benches, double geometry,
                       bool nonlinear, const NamedVerdicts& verdicts) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  const std::string verdict = mechanism_verdict(verdicts);
  fmt::format_to(out, "{}, {}{}{}\nerror against run time of the periodic state{}\n", scene_name(model.scene),
                 speed_text(speed, model.scene), verdict.empty() ? "" : ": ", verdict,
                 nonlinear ? ", motion without linearisation of all rods together" : "");
  fmt::format_to(out,
                 "Geometry, once for all speeds (harmonic balance only): {:.3g} s. Integration evaluates the "
                 "equations from the {} at every step.\n",
                 geometry, model.linkage() != nullptr ? "kinematics" : "series");
  for (const RodBench& bench : benches) {
    fmt::format_to(out, "\n{}, {}; reference by {}, error {:.1e}\n", bench.name, to_string(bench.verdict),
                   nonlinear ? "shooting (CVODE)" : "Radau collocation", bench.reference_error);
    fmt::format_to(out, "  {:<36} {:>8} {:>10} {:>10} {:>11} {:>11}\n", "method", "asked", "harm/steps", "error",
                   "min [s]", "median [s]");
    for (const BenchRow& row : bench.rows)
      fmt::format_to(out, "  {:<36} {:>8} {:>10} {:>10.2e} {:>11.3e} {:>11.3e}\n", row.method,
                     row.asked > 0 ? fmt::format("{:.0e}", row.asked) : "", row.size, row.error, row.seconds,
                     row.median_seconds);
    for (const std::string& sentence : bench.notes) fmt::format_to(out, "  left out: {}\n", sentence);
    if (bench.rows.empty()) continue;
    for (const double error : accuracies) fmt::format_to(out, "  {}\n", ratio_sentence(bench, error));
    fmt::format_to(out, "  (shooting also gives the Floquet exponents, the others do not)\n");
  }
  fmt::format_to(out, "\nlargest memory of the whole run: {:.0f} MB\n", peak_memory_megabytes());
  return fmt::to_string(text);
}

// A name between the quotes of bench.csv.
std::string csv_name(std::string name) {
  std::replace(name.begin(), name.end(), '"', '\'');
  return name;
}

std::string bench_csv(const SceneModel& model, double speed, const std::vector<RodBench>& benches) {
  std::string text = fmt::format(
      "scene,speed [rad/{}],rod,method,asked tolerance,harmonics or steps,error,seconds min,seconds median\n",
      model.scene.units.time);
  const std::string scene = csv_name(scene_name(model.scene));
  for (const RodBench& bench : benches)
    for (const BenchRow& row : bench.rows)
      text += fmt::format("\"{}\",{},\"{}\",\"{}\",{},{},{},{},{}\n", scene, speed, csv_name(row.rod), row.method,
                          row.asked, row.size, row.error, row.seconds, row.median_seconds);
  return text;
}

Json bench_json(const SceneModel& model, double speed, const std::vector<RodBench>& benches, double geometry,
                bool nonlinear, const NamedVerdicts& verdicts) {
  Json json;
  json["title"] = scene_name(model.scene);
  json["rpm"] = rpm_from_speed(speed, model.scene.units);
  json["omega"] = speed;
  json["theory"] = nonlinear ? "nonlinear" : "linear";
  if (const std::optional<Verdict> verdict = worst_of(verdicts)) json["verdict"] = to_string(*verdict);
  json["geometry_seconds"] = geometry;
  json["memory_megabytes"] = peak_memory_megabytes();
  json["rods"] = Json::object();
  for (const RodBench& bench : benches) {
    Json& rod = json["rods"][bench.name];
    rod["reference_error"] = bench.reference_error;
    rod["verdict"] = to_string(bench.verdict);
    rod["rows"] = Json::array();
    for (const BenchRow& row : bench.rows)
      rod["rows"].push_back({{"method", row.method},
                             {"asked", row.asked > 0 ? Json(row.asked) : Json()},
                             {"harmonics_or_steps", row.size},
                             {"error", std::isfinite(row.error) ? Json(row.error) : Json()},
                             {"seconds", row.seconds},
                             {"seconds_median", row.median_seconds}});
    rod["left_out"] = bench.notes;
    rod["ratios"] = Json::array();
    if (!bench.rows.empty())
      for (const double error : accuracies) rod["ratios"].push_back(ratio_sentence(bench, error));
  }
  return json;
}

// The rows of `bench` begin at `first_row` of bench.csv, those of each method stand together.
Figure bench_figure(const SceneModel& model, double speed, const RodBench& bench, std::size_t first_row,
                    const NamedVerdicts& verdicts) {
  Figure figure;
  figure.name = file_name("bench_" + bench.name);
  figure.width = 1050;
  figure.commands = fmt::format(
      "set title {}\nset logscale xy\nset format xy '10^{{%L}}'\nset xlabel 'time of one solution [s]'\n"
      "set ylabel 'max |error of q| / max |q|'\nset yrange [1e-16:10]\nset key outside right top Left reverse samplen "
      "2\nplot ",
      figure_title(model.scene,
                   {model.linkage() ? bench.name : "", speed_text(speed, model.scene), title_verdict(verdicts)},
                   "error of the periodic state against run time"));
  std::size_t m = 0;
  for (std::size_t begin = 0, end = 0; begin < bench.rows.size(); begin = end, ++m) {
    const std::string& method = bench.rows[begin].method;
    while (end < bench.rows.size() && bench.rows[end].method == method) ++end;
    figure.commands += fmt::format(
        "'bench.csv' every ::{}::{} using 8:($7 > 1e-16 ? $7 : 1e-16) with linespoints {} ps 0.7 title {}, ",
        first_row + begin, first_row + end - 1, m < 7 ? fmt::format("lt {}", m + 1) : "lt 7 lc rgb '#888888' pt 8",
        quoted(method));
  }
  figure.commands += fmt::format("{} with lines lt 7 lc rgb '#888888' dt 2 title 'error of the reference'\n",
                                 std::max(bench.reference_error, 1e-16));
  figure.commands +=
      "unset logscale xy\nset format xy '%g'\nset yrange [*:*]\nunset title\nunset xlabel\nunset ylabel\nset key "
      "default\n";
  return figure;
}

struct BenchFlags {
  CommonFlags common;
  TheoryFlags theory;
  std::string case_limit;
};

std::vector<RodBench> bench_rods(const SceneModel& model, double speed, const BenchOptions& options) {
  std::vector<RodBench> benches;
  for (const RodModel& rod : model.rods) {
    if (!rod.reported) continue;
    const TimeDomainSystem system = model.linkage() != nullptr
                                        ? time_domain_rod(*model.linkage(), rod.link, rod.num_modes, speed)
                                        : time_domain_system(rod.system, speed);
    benches.push_back(bench_rod(rod, system, options));
  }
  return benches;
}

// Of the linear theory, of all elastic links whichever are measured.
NamedVerdicts verdicts_at(const SceneModel& model, double speed, Settings settings) {
  settings.only = {false, true, false, false, true};
  return named_verdicts(analyse(model, speed, settings).rods);
}

// Of the motion of all rods together, by the reference; empty: there was none.
NamedVerdicts of_motion(const RodBench& bench) {
  if (bench.rows.empty()) return {};
  return {{bench.name, bench.verdict}};
}

int run_bench(const BenchFlags& flags) {
  const SceneInput input = scene_input(flags.common.scene_file);
  Scene scene = input.source.with(overrides(flags.common));
  Settings options = settings(flags.common, scene);
  const Output out = output(flags.common);
  options.only = {true, false, false, false};
  const double speed = single_speed(flags.common, scene);
  const double time_limit = flags.case_limit.empty() ? 5
                                                     : number_flag("--case-limit", flags.case_limit, 1e-3, 1e6,
                                                                   "seconds from 0.001 to 1000000");
  const bool nonlinear = is_nonlinear(flags.theory);
  std::optional<InterruptGuard> guard;
  if (nonlinear) guard.emplace(false);
  NonlinearOptions motion;
  motion.turns = turns_of(flags.theory);
  motion.stop = stop_of();
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "bench", provenance(flags.common.line, input));

  const auto start = Clock::now();
  const SceneModel model = make_model(std::move(scene), options);
  const double geometry = seconds_since(start);
  const auto num_rods = static_cast<std::size_t>(std::ranges::count_if(model.rods, &RodModel::reported));
  const std::size_t cases = nonlinear ? motion_bench_cases() : num_rods * bench_cases();
  std::optional<Progress> progress(std::in_place, "cases", cases);
  Forecast forecast("the benchmark", cases, 1);
  const BenchOptions with{options.steady_method, time_limit, [&] {
                            progress->advance();
                            forecast.advance();
                          }};
  const std::vector<RodBench> benches =
      nonlinear ? std::vector{bench_motion(model, speed, options, with, motion)} : bench_rods(model, speed, with);
  progress.reset();
  const NamedVerdicts verdicts = nonlinear ? of_motion(benches.front()) : verdicts_at(model, speed, options);
  const Json document = bench_json(model, speed, benches, geometry, nonlinear, verdicts);
  const bool complete = std::none_of(benches.begin(), benches.end(), [](const RodBench& b) { return b.rows.empty(); });
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : bench_text(model, speed, benches, geometry, nonlinear, verdicts);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("bench.json", json_file_text(document));
    place.write("bench.csv", bench_csv(model, speed, benches));
    std::vector<Figure> figures;
    std::size_t row = 0;
    for (const RodBench& bench : benches) {
      if (!bench.rows.empty()) figures.push_back(bench_figure(model, speed, bench, row, verdicts));
      row += bench.rows.size();
    }
    return figures;
  };
  return deliver(folder ? &*folder : nullptr, out.plots, complete ? exit_ok : exit_not_reached, delivery);
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
