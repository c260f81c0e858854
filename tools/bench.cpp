// hb bench: error against run time of the periodic state, for harmonic balance and for time integration.
#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "hb/fixed_step.hpp"
#include "hb/shooting.hpp"
#include "lib/time_domain_rod.hpp"
#include "tools/command.hpp"
#include "tools/common_flags.hpp"
#include "tools/gnuplot.hpp"
#include "tools/json_output.hpp"
#include "tools/linkage_analysis.hpp"
#include "tools/output_folder.hpp"
#include "tools/wording.hpp"

namespace hb::tools {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Row {
  std::string rod, method;
  double asked = 0;  // tolerance; 0: none
  long size = 0;  // harmonics, or steps
  double error = 0;  // max |q - reference| / max |reference|
  double seconds = 0, median_seconds = 0;
  bool harmonic_balance = false;
};

struct RodBench {
  std::string name;
  Integrator reference = Integrator::collocation;
  double reference_error = 0;
  Verdict verdict = Verdict::undecided;
  std::vector<Row> rows;
  std::vector<std::string> notes;  // what was left out, and why
};

// The orbit at the reference's angles, from N samples of which N is a multiple or a divisor.
double error_of(const Eigen::MatrixXd& q, const Eigen::MatrixXd& reference) {
  const Eigen::Index n = std::min(q.cols(), reference.cols());
  double difference = 0;
  for (Eigen::Index j = 0; j < n; ++j)
    difference = std::max(
        difference, (q.col(j * (q.cols() / n)) - reference.col(j * (reference.cols() / n))).cwiseAbs().maxCoeff());
  const double error = difference / reference.cwiseAbs().maxCoeff();
  return std::isfinite(error) ? error : INFINITY;
}

Eigen::MatrixXd at_angles(const FourierSeries& series, Eigen::Index N) {
  Eigen::MatrixXd values(series.num_components(), N);
  for (Eigen::Index j = 0; j < N; ++j)
    values.col(j) = fourier::evaluate(series, 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(N));
  return values;
}

// Repeats until 50 ms or 200 runs have passed, at least once; shortest and median time of one run.
void time_row(Row& row, const std::function<void()>& work) {
  std::vector<double> times;
  const auto start = Clock::now();
  do {
    const auto begin = Clock::now();
    work();
    times.push_back(seconds_since(begin));
  } while (seconds_since(start) < 0.05 && times.size() < 200);
  std::sort(times.begin(), times.end());
  row.seconds = times.front();
  row.median_seconds = times[times.size() / 2];
}

RodBench bench_rod(const RodModel& rod, const TimeDomainSystem& system, double time_limit) {
  const double speed = system.speed;
  RodBench bench;
  bench.name = rod.name;
  ShootingOptions tight;
  tight.integrator = Integrator::collocation;
  tight.tolerance = 1e-13;
  tight.time_limit = 10 * time_limit;
  const ShootingResult reference = solve_by_shooting(system, tight);
  if (reference.orbit.q.size() == 0 || !(reference.orbit.q.cwiseAbs().maxCoeff() > 0)) {
    bench.notes.push_back("no reference: " +
                          (reference.message.empty() ? "the rod carries no load" : reference.message));
    return bench;
  }
  const Eigen::MatrixXd& exact = reference.orbit.q;
  bench.reference_error = reference.q_error;
  bench.verdict = reference.verdict;
  const auto note = [&](const std::string& sentence) { bench.notes.push_back(sentence); };

  const auto series_row = [&](const char* method, const SteadyOptions& options, double asked) {
    Row row{rod.name, method, asked, 0, 0, 0, 0, true};
    SteadyState state;
    time_row(row, [&] { state = solve_steady_state(rod.system, speed, options); });
    if (state.status == SteadyStatus::singular) return;
    row.size = state.num_harmonics;
    row.error = error_of(at_angles(state.q, exact.cols()), exact);
    bench.rows.push_back(row);
  };
  for (const int H : {1, 2, 4, 6, 8, 12, 16, 24, 32, 48, 64})
    series_row("harmonic balance, given harmonics", {.tolerance = 1e-14, .num_harmonics = H}, 0);
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12})
    series_row("harmonic balance, automatic", {.tolerance = tolerance}, tolerance);

  for (const Integrator integrator : {Integrator::adams, Integrator::bdf}) {
    for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13}) {
      Row row{rod.name, std::string("shooting, ") + to_string(integrator), tolerance};
      ShootingResult result;
      time_row(row, [&] {
        result =
            solve_by_shooting(system, {.integrator = integrator, .time_limit = time_limit, .single_run = tolerance});
      });
      if (result.orbit.q.size() == 0) {
        note(fmt::format("{} at {:.0e}: {}", row.method, tolerance, result.message));
        continue;
      }
      row.size = result.steps;
      row.error = error_of(result.orbit.q, exact);
      bench.rows.push_back(row);
    }
  }
  if (bench.verdict == Verdict::unstable) {
    note("marching: the motion is unstable, no integration from rest settles on the periodic state");
    return bench;
  }
  for (const Integrator integrator : {Integrator::adams, Integrator::bdf}) {
    for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11}) {
      Row row{rod.name, std::string("marching, ") + to_string(integrator), tolerance};
      MarchingResult result;
      time_row(row, [&] {
        result = march_from_rest(system, {.tolerance = tolerance,
                                          .integrator_tolerance = tolerance / 10,
                                          .integrator = integrator,
                                          .time_limit = time_limit,
                                          .growth_rate = reference.growth_rate});
      });
      if (result.status != ShootingStatus::converged) {
        note(fmt::format("{} at {:.0e}: {}", row.method, tolerance,
                         result.message.empty() ? to_string(result.status) : result.message));
        continue;
      }
      row.size = result.steps;
      row.error = error_of(result.orbit.q, exact);
      bench.rows.push_back(row);
    }
  }
  for (const FixedStep method : {FixedStep::newmark, FixedStep::runge_kutta}) {
    const char* name = method == FixedStep::newmark ? "marching, Newmark" : "marching, Runge-Kutta 4";
    // The transient is followed down to about the error of the smallest step.
    const double settled = method == FixedStep::newmark ? 1e-7 : 1e-11;
    for (int steps = 128; steps <= (1 << 20); steps *= 4) {
      Row row{rod.name, name};
      MarchingResult result;
      time_row(row, [&] { result = march_fixed_step(system, method, steps, settled, 100000, time_limit); });
      if (result.status == ShootingStatus::time_limit) {
        note(fmt::format("{} with {} steps a turn: {}", name, steps, result.message));
        break;
      }
      if (result.status != ShootingStatus::converged) {
        note(fmt::format("{} with {} steps a turn: {}", name, steps, result.message));
        continue;
      }
      row.size = result.steps;
      row.error = error_of(result.orbit.q, exact);
      bench.rows.push_back(row);
    }
  }
  return bench;
}

const Row* fastest(const std::vector<Row>& rows, double error, bool harmonic_balance) {
  const Row* best = nullptr;
  for (const Row& row : rows)
    if (row.harmonic_balance == harmonic_balance && row.error <= error &&
        (best == nullptr || row.seconds < best->seconds))
      best = &row;
  return best;
}

std::string ratio_sentence(const RodBench& bench, double error) {
  const Row* series = fastest(bench.rows, error, true);
  const Row* integration = fastest(bench.rows, error, false);
  if (series == nullptr && integration == nullptr) return fmt::format("at {:.0e}: no method reaches it", error);
  if (series == nullptr)
    return fmt::format("at {:.0e}: only {} reaches it, in {:.3g} s", error, integration->method, integration->seconds);
  if (integration == nullptr)
    return fmt::format("at {:.0e}: only harmonic balance reaches it, in {:.3g} s", error, series->seconds);
  const double ratio = integration->seconds / series->seconds;
  return fmt::format("at {:.0e}: harmonic balance {:.3g} s, the fastest integration ({}) {:.3g} s, {:.3g} times as {}",
                     error, series->seconds, integration->method, integration->seconds, ratio >= 1 ? ratio : 1 / ratio,
                     ratio >= 1 ? "long" : "fast");
}

constexpr double accuracies[] = {1e-3, 1e-6, 1e-9, 1e-12};

double peak_memory_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

std::string bench_text(const SceneModel& model, double speed, const std::vector<RodBench>& benches, double geometry) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{}, {}: error against run time of the periodic state\n", scene_name(model.scene),
                 speed_text(speed, model.scene));
  fmt::format_to(out,
                 "Geometry, once for all speeds (harmonic balance only): {:.3g} s. Integration evaluates the "
                 "equations from the {} at every step.\n",
                 geometry, model.linkage() != nullptr ? "kinematics" : "series");
  for (const RodBench& bench : benches) {
    fmt::format_to(out, "\n{}, {}; reference by Radau collocation, error {:.1e}\n", bench.name,
                   to_string(bench.verdict), bench.reference_error);
    fmt::format_to(out, "  {:<36} {:>8} {:>10} {:>10} {:>11} {:>11}\n", "method", "asked", "harm/steps", "error",
                   "min [s]", "median [s]");
    for (const Row& row : bench.rows)
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

std::string bench_csv(const SceneModel& model, double speed, const std::vector<RodBench>& benches) {
  std::string text = "scene,speed,rod,method,asked tolerance,harmonics or steps,error,seconds min,seconds median\n";
  std::string scene = scene_name(model.scene);
  std::replace(scene.begin(), scene.end(), '"', '\'');
  for (const RodBench& bench : benches)
    for (const Row& row : bench.rows)
      text += fmt::format("\"{}\",{},\"{}\",\"{}\",{},{},{},{},{}\n", scene, speed, row.rod, row.method, row.asked,
                          row.size, row.error, row.seconds, row.median_seconds);
  return text;
}

Json bench_json(const SceneModel& model, double speed, const std::vector<RodBench>& benches, double geometry) {
  Json json;
  json["title"] = scene_name(model.scene);
  json["rpm"] = rpm_from_speed(speed, model.scene.units);
  json["omega"] = speed;
  json["geometry_seconds"] = geometry;
  json["memory_megabytes"] = peak_memory_megabytes();
  json["rods"] = Json::object();
  for (const RodBench& bench : benches) {
    Json& rod = json["rods"][bench.name];
    rod["reference_error"] = bench.reference_error;
    rod["verdict"] = to_string(bench.verdict);
    rod["rows"] = Json::array();
    for (const Row& row : bench.rows)
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

// One CSV per method, so that gnuplot joins its points.
Figure bench_figure(const SceneModel& model, double speed, const RodBench& bench, OutputFolder& folder) {
  Figure figure;
  figure.name = file_name("bench_" + bench.name);
  figure.width = 1050;
  figure.commands = fmt::format(
      "set title {}\nset logscale xy\nset format xy '10^{{%L}}'\nset xlabel 'time of one solution [s]'\n"
      "set ylabel 'max |error of q| / max |q|'\nset yrange [1e-16:10]\nset key outside right top\nplot ",
      quoted(fmt::format("{}, {}, {}: error against run time", scene_name(model.scene), bench.name,
                         speed_text(speed, model.scene))));
  std::vector<std::string> methods;
  for (const Row& row : bench.rows)
    if (std::find(methods.begin(), methods.end(), row.method) == methods.end()) methods.push_back(row.method);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::string csv = "seconds,error\n";
    for (const Row& row : bench.rows)
      if (row.method == methods[m] && std::isfinite(row.error))
        csv += fmt::format("{},{}\n", row.seconds, std::max(row.error, 1e-16));
    const std::string name = file_name("bench_" + bench.name + "_" + methods[m]) + ".csv";
    folder.write(name, csv);
    figure.commands += fmt::format("{}'{}' using 1:2 with linespoints lt {} ps 0.7 title {}", m == 0 ? "" : ", ", name,
                                   m + 1, tools::quoted(methods[m]));
  }
  figure.commands +=
      "\nunset logscale xy\nset format xy '%g'\nset yrange [*:*]\nunset title\nunset xlabel\nunset ylabel\nset key "
      "default\n";
  return figure;
}

struct BenchFlags {
  CommonFlags common;
  std::string time_limit;
};

int run_bench(const BenchFlags& flags) {
  Scene scene = read_scene(flags.common.scene_file, overrides(flags.common));
  Settings options = settings(flags.common, scene);
  options.only = {true, false, false, false};
  const double speed = single_speed(flags.common, scene);
  const double time_limit = flags.time_limit.empty() ? 5
                                                     : number_flag("--time-limit", flags.time_limit, 1e-3, 1e6,
                                                                   "seconds from 0.001 to 1000000");
  std::optional<OutputFolder> folder;
  if (options.out) folder.emplace(*options.out);

  const auto start = Clock::now();
  const SceneModel model = make_model(std::move(scene), options);
  const double geometry = seconds_since(start);
  std::vector<RodBench> benches;
  for (const RodModel& rod : model.rods) {
    if (!rod.reported) continue;
    const TimeDomainSystem system = model.linkage() != nullptr
                                        ? time_domain_rod(*model.linkage(), rod.link, rod.system.num_modes(), speed)
                                        : time_domain_system(rod.system, speed);
    benches.push_back(bench_rod(rod, system, time_limit));
  }
  const Json document = bench_json(model, speed, benches, geometry);
  if (folder) {
    folder->write("bench.json", document.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    folder->write("bench.csv", bench_csv(model, speed, benches));
    std::vector<Figure> figures;
    for (const RodBench& bench : benches)
      if (!bench.rows.empty()) figures.push_back(bench_figure(model, speed, bench, *folder));
    draw_figures(figures, *folder, options.plots);
    folder->commit();
  }
  if (options.json)
    print_json(document);
  else
    fmt::print("{}", bench_text(model, speed, benches, geometry));
  const bool complete = std::none_of(benches.begin(), benches.end(), [](const RodBench& b) { return b.rows.empty(); });
  return complete ? exit_ok : exit_not_reached;
}

}  // namespace

void add_bench_command(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("bench", "error against run time: harmonic balance, shooting, marching, Newmark, Runge-Kutta");
  const auto flags = std::make_shared<BenchFlags>();
  add_scene_flags(*command, flags->common);
  add_analysis_flags(*command, flags->common);
  command->add_option("--time-limit", flags->time_limit, "seconds for each case; default 5")->type_name("SECONDS");
  command->callback([flags, &status] { status = run_bench(*flags); });
}

}  // namespace hb::tools
