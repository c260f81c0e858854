// hb check: harmonic balance against time integration on an independent path.
#include <fmt/core.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/cross_check.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/check_json.hpp"
#include "tools/output/check_report.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/nonlinear_check_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/check_pictures.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/parallel_for.hpp"
#include "tools/work/progress.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

struct CheckFlags {
  CommonFlags common;
  TheoryFlags theory;
  std::string integrator, case_limit;
  bool march = false;
};

CheckOptions check_options(const CheckFlags& flags) {
  CheckOptions options;
  options.march = flags.march;
  if (!flags.case_limit.empty())
    options.time_limit = number_flag("--case-limit", flags.case_limit, 1e-3, 1e6, "seconds from 0.001 to 1000000");
  const std::string& name = flags.integrator;
  if (name.empty() || name == "automatic")
    options.integrator = Integrator::automatic;
  else if (name == "adams")
    options.integrator = Integrator::adams;
  else if (name == "bdf")
    options.integrator = Integrator::bdf;
  else if (name == "collocation")
    options.integrator = Integrator::collocation;
  else
    throw UsageError(fmt::format("--integrator: found \"{}\", allowed: automatic, adams, bdf, collocation", name));
  return options;
}

// In rad per unit time.
std::vector<double> speeds_of(const SpeedRange& range, const Units& units) {
  constexpr std::size_t most = 100000;
  std::vector<double> speeds = {range.speeds.from};
  if (range.speeds.from < range.speeds.to) speeds = speed_values(range);
  if (speeds.size() > most)
    throw UsageError(fmt::format("--rpm: found {} speeds, allowed: up to {}", speeds.size(), most));
  if (range.in_rpm)
    for (double& speed : speeds) speed = speed_from_rpm(speed, units);
  return speeds;
}

// On standard error if that is a terminal: speeds done, and the integration under way if it takes long.
class CheckProgress {
 public:
  CheckProgress(std::size_t num_speeds, int num_threads)
      : num_speeds_(num_speeds), shown_(isatty(STDERR_FILENO) != 0), forecast_("the check", num_speeds, num_threads) {}
  CheckProgress(const CheckProgress&) = delete;
  CheckProgress& operator=(const CheckProgress&) = delete;
  ~CheckProgress() {
    if (dirty_) fmt::print(stderr, "\r\033[K");
  }

  void begin(const std::string& rod, const std::string& speed, Integrator integrator, double seconds) {
    const std::lock_guard lock(mutex_);
    constexpr double worth_saying = 10;
    if (num_speeds_ == 1 && seconds > worth_saying)
      fmt::print(stderr,
                 "hb: {}, integration in time takes about {:.0f} s; --case-limit and --time-limit change that\n", rod,
                 std::ceil(seconds));
    if (!shown_ || (seconds < 1 && Clock::now() - start_ < std::chrono::milliseconds(400))) return;
    dirty_ = true;
    fmt::print(stderr, "\r\033[K{} of {} speeds done; {} at {}: {}, about {:.0f} s", num_done_, num_speeds_, rod, speed,
               to_string(integrator), std::ceil(seconds));
  }
  void end() {
    const std::lock_guard lock(mutex_);
    ++num_done_;
    forecast_.advance();
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::size_t num_speeds_, num_done_ = 0;
  bool shown_, dirty_ = false;
  Clock::time_point start_ = Clock::now();
  Forecast forecast_;
  std::mutex mutex_;
};

// Drops what was not computed; gives how many.
std::size_t keep_done(std::vector<SpeedCheck>& checks, const std::vector<char>& done) {
  std::vector<SpeedCheck> kept;
  for (std::size_t k = 0; k < done.size(); ++k)
    if (done[k]) kept.push_back(std::move(checks[k]));
  checks = std::move(kept);
  return done.size() - checks.size();
}

int run_nonlinear_check(const CheckFlags& flags) {
  const SceneInput input = scene_input(flags.common.scene_file);
  Scene scene = input.source.with(overrides(flags.common));
  const Settings options = settings(flags.common, scene);
  const Output out = output(flags.common);
  const CheckOptions check_with = check_options(flags);
  if (flags.march) throw UsageError("--march: found with --theory nonlinear, allowed: with the linear theory");
  if (check_with.integrator == Integrator::collocation)
    throw UsageError("--integrator: found \"collocation\" with --theory nonlinear, allowed: automatic, adams, bdf");
  const InterruptGuard guard(false);
  NonlinearOptions asked;
  asked.turns = turns_of(flags.theory);
  asked.stop = stop_of();
  const std::vector<double> speeds = speeds_of(speed_range(flags.common, scene), scene.units);
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "check", provenance(flags.common.line, input));

  // The motion is that of all rods, whatever is compared of it.
  Settings all = options;
  all.only.steady = true;
  const SceneModel model = make_model(std::move(scene), all, false);
  std::vector<NonlinearCheck> checks(speeds.size());
  parallel_for(speeds.size(), out.threads, [&](std::size_t k) {
    checks[k] = nonlinear_check(model, speeds[k], options, check_with, asked);
    if (!checks[k].not_compared.empty()) say_time_limit(flags.common.time_limit, asked.stop, checks[k].shortfalls);
  });

  const nlohmann::ordered_json document = nonlinear_check_json(model, checks, options);
  const bool agree = std::ranges::all_of(checks, &NonlinearCheck::agrees);
  const bool reached = std::ranges::all_of(checks, [](const NonlinearCheck& c) { return c.shortfalls.empty(); });
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : nonlinear_check_report(model, checks, options);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("check.json", json_file_text(document));
    return std::vector<Figure>();
  };
  return deliver(folder ? &*folder : nullptr, out.plots,
                 ended_status(!agree    ? exit_failed
                              : reached ? exit_ok
                                        : exit_not_reached),
                 delivery);
}

int run_check(const CheckFlags& flags) {
  if (is_nonlinear(flags.theory)) return run_nonlinear_check(flags);
  const SceneInput input = scene_input(flags.common.scene_file);
  Scene scene = input.source.with(overrides(flags.common));
  const Settings options = settings(flags.common, scene);
  const Output out = output(flags.common);
  const CheckOptions check_with = check_options(flags);
  const std::vector<double> speeds = speeds_of(speed_range(flags.common, scene), scene.units);
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "check", provenance(flags.common.line, input));

  const SceneModel model = make_model(std::move(scene), options);
  std::vector<SpeedCheck> checks(speeds.size());
  std::vector<char> done(speeds.size(), 0);
  {
    const InterruptGuard guard(!out.folder);
    CheckProgress progress(speeds.size(), out.threads);
    const auto check_one = [&](std::size_t k) {
      CheckOptions here = check_with;
      here.begin = [&](const std::string& rod, Integrator integrator, double seconds) {
        progress.begin(rod, speed_text(speeds[k], model.scene), integrator, seconds);
      };
      checks[k] = cross_check(model, speeds[k], options, here);
      done[k] = 1;
      progress.end();
    };
    if (!parallel_for(speeds.size(), out.threads, check_one, early_end(out.folder.has_value()))) {
      const std::size_t missing = keep_done(checks, done);
      if (checks.empty()) return stopped_status();
      checks.front().shortfalls.push_back(
          fmt::format("ended before the answer was complete: {} of {} speeds were not computed", missing, done.size()));
    }
  }

  const nlohmann::ordered_json document = check_json(model, checks, options);
  const bool agree = std::all_of(checks.begin(), checks.end(), [](const SpeedCheck& c) { return c.agrees(); });
  const bool reached =
      std::all_of(checks.begin(), checks.end(), [](const SpeedCheck& c) { return c.shortfalls.empty(); });
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : check_report(model, checks, options, out.stats);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("check.json", json_file_text(document));
    return write_check_tables(model, checks, place);
  };
  return deliver(folder ? &*folder : nullptr, out.plots,
                 ended_status(!agree    ? exit_failed
                              : reached ? exit_ok
                                        : exit_not_reached),
                 delivery);
}

}  // namespace

void add_check_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "check", "cross-check against time integration on an independent path; exit 1 when they disagree");
  const auto flags = std::make_shared<CheckFlags>();
  add_scene_flags(*command, flags->common);
  add_analysis_flags(*command, flags->common);
  add_theory_flags(*command, flags->theory);
  command->add_option("--integrator", flags->integrator, "automatic, adams, bdf (CVODE) or collocation (Radau)")
      ->type_name("NAME");
  command->add_option("--case-limit", flags->case_limit, "seconds for each rod and speed; default 60")
      ->type_name("SECONDS");
  command->add_flag("--march", flags->march, "also march from rest until the transient has died out");
  command->callback([flags, &status] { status = run_check(*flags); });
}

}  // namespace hb::tools
