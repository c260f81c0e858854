// hb check: harmonic balance against time integration on an independent path.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "hb/analysis/nonlinear/nonlinear_analyses.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/check_progress.hpp"
#include "tools/command/command.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/flag_values.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/speed_flags.hpp"
#include "tools/command/theory_flags.hpp"
#include "tools/output/check_json.hpp"
#include "tools/output/check_report.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/nonlinear_check_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/wording.hpp"
#include "tools/pictures/check_pictures.hpp"
#include "tools/work/interrupts.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

struct CheckFlags {
  CommonFlags common;
  TheoryFlags theory;
  std::string integrator, case_limit;
  bool march = false;
};

CheckRequest asked_check(const CheckFlags& flags, const Scene& scene) {
  CheckRequest request;
  static_cast<Request&>(request) = asked_request(flags.common, scene);
  request.march = flags.march;
  if (!flags.case_limit.empty()) request.case_limit = seconds_flag("--case-limit", flags.case_limit, 1e6);
  const std::string& name = flags.integrator;
  if (name.empty() || name == "automatic")
    request.integrator = Integrator::automatic;
  else if (name == "adams")
    request.integrator = Integrator::adams;
  else if (name == "bdf")
    request.integrator = Integrator::bdf;
  else if (name == "collocation")
    request.integrator = Integrator::collocation;
  else
    throw UsageError(fmt::format("--integrator: found \"{}\", allowed: automatic, adams, bdf, collocation", name));
  constexpr std::size_t most = 100000;
  const SpeedRange range = speed_range(flags.common, scene);
  std::vector<double>& speeds = range.in_rpm ? request.rpms : request.omegas;
  speeds = {range.speeds.from};
  if (range.speeds.from < range.speeds.to) speeds = speed_values(range);
  if (speeds.size() > most)
    throw UsageError(fmt::format("--rpm: found {} speeds, allowed: up to {}", speeds.size(), most));
  return request;
}

int check_status(bool agrees, bool reached) {
  return ended_status(!agrees ? exit_failed : reached ? exit_ok : exit_not_reached);
}

int run_nonlinear_check(const CheckFlags& flags) {
  const SceneInput input = scene_input(flags.common.scene_file);
  const Scene scene = input.source.with(overrides(flags.common));
  const Output out = output(flags.common);
  const CheckRequest request = asked_check(flags, scene);
  if (flags.march) throw UsageError("--march: found with --theory nonlinear, allowed: with the linear theory");
  if (request.integrator == Integrator::collocation)
    throw UsageError("--integrator: found \"collocation\" with --theory nonlinear, allowed: automatic, adams, bdf");
  const InterruptGuard guard(false);
  NonlinearOptions asked;
  asked.turns = turns_of(flags.theory);
  asked.stop = stop_of();
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "check", provenance(flags.common.line, input));

  NonlinearChecks found = nonlinear_check(scene, request, asked, SharedWork(out.threads));
  for (NonlinearCheck& check : found.speeds)
    if (!check.not_compared.empty()) say_time_limit(flags.common.time_limit, asked.stop, check.shortfalls);
  const nlohmann::ordered_json document = nonlinear_check_json(*found.model, found.speeds, found.settings);
  Delivery delivery;
  delivery.printed =
      out.json ? json_text(document) : nonlinear_check_report(*found.model, found.speeds, found.settings);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("check.json", json_file_text(document));
    return std::vector<Figure>();
  };
  return deliver(folder ? &*folder : nullptr, out.pictures, check_status(found.agrees(), found.reached()), delivery);
}

int run_check(const CheckFlags& flags) {
  if (is_nonlinear(flags.theory)) return run_nonlinear_check(flags);
  const SceneInput input = scene_input(flags.common.scene_file);
  const Scene scene = input.source.with(overrides(flags.common));
  const Output out = output(flags.common);
  CheckRequest request = asked_check(flags, scene);
  std::optional<OutputFolder> folder;
  if (out.folder) folder.emplace(*out.folder, "check", provenance(flags.common.line, input));

  Check found;
  {
    const InterruptGuard guard(!out.folder);
    const std::size_t num_speeds = request.rpms.size() + request.omegas.size();
    CheckProgress progress(num_speeds, out.threads);
    request.begin = [&](const std::string& rod, double speed, Integrator integrator, double seconds) {
      progress.begin(rod, speed_text(speed, scene), integrator, seconds);
    };
    const auto at_once = static_cast<double>(std::min(num_speeds, static_cast<std::size_t>(out.threads)));
    request.expected = [&](double bytes) { say_memory("the check", bytes * at_once); };
    request.done = [&](double) { progress.end(); };
    found = check(scene, request, SharedWork(out.threads, nullptr, {}, early_end(out.folder.has_value())));
  }
  if (found.speeds.empty()) return stopped_status(out.json);
  nlohmann::ordered_json document = check_json(found);
  if (out.stats) document["accuracy"] = accuracy_json(found.settings);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : check_report(found, out.stats);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("check.json", json_file_text(document));
    return write_check_tables(*found.model, found.speeds, place);
  };
  return deliver(folder ? &*folder : nullptr, out.pictures, check_status(found.agrees(), found.reached()), delivery);
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
