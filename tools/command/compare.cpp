// hb compare: two steady answers or two sweeps side by side, of scenes or of folders that hb wrote.
#include "tools/command/compare.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>

#include "hb/analysis/analyses.hpp"
#include "hb/analysis/steady.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/common_flags.hpp"
#include "tools/command/delivery.hpp"
#include "tools/command/output_flags.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/speed_flags.hpp"
#include "tools/command/sweep_axis.hpp"
#include "tools/command/version.hpp"
#include "tools/output/compare_along.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/output_folder.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/pictures/compare_figures.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

namespace fs = std::filesystem;

struct CompareFlags : CommonFlags {
  std::string other;
  std::vector<std::string> set_b;
};

bool is_document(const fs::path& place) { return fs::is_directory(place) || place.extension() == ".json"; }

// What hb steady or hb sweep left in a folder (`document`: steady.json or sweep.json), or in a file.
ComparedSide from_files(const std::string& given, const std::string& document) {
  const fs::path file = fs::is_directory(given) ? fs::path(given) / document : fs::path(given);
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  const Json found = stream ? Json::parse(text.str(), nullptr, false) : Json();
  const bool usable = found.is_object() && found.contains("rods") && found["rods"].is_object() &&
                      found.contains("units") && found.contains("omega") &&
                      (found["omega"].is_number() || (found.contains("x") && found["x"].is_object()));
  if (!usable)
    throw UsageError(fmt::format(
        "{}: found {}, allowed a scene, or a folder or file that `hb steady --out` or `hb sweep --out` wrote", given,
        stream ? "no answer of hb steady or hb sweep in " + file.string() : "no " + file.string()));
  return {given, found};
}

// Sweeps are compared where a range of speeds is asked for, or where a side has nothing else.
bool asks_for_sweeps(const CompareFlags& flags) {
  if (flags.rpm.find(':') != std::string::npos || flags.omega.find(':') != std::string::npos) return true;
  for (const std::string& given : {flags.scene_file, flags.other}) {
    if (fs::is_directory(given) && !fs::exists(fs::path(given) / "steady.json") &&
        fs::exists(fs::path(given) / "sweep.json"))
      return true;
    if (fs::path(given).extension() == ".json" && fs::exists(given) && is_along(from_files(given, ""))) return true;
  }
  return false;
}

ComparedSide computed(const CompareFlags& flags, const SceneInput& input, const std::vector<std::string>& more,
                      bool sweeps, int threads) {
  CommonFlags own = flags;
  own.set.insert(own.set.end(), more.begin(), more.end());
  const std::vector<Override> set = overrides(own);
  const Scene scene = input.source.with(set);
  std::string source = input.name;
  for (const std::string& each : more) source += " --set " + each;
  if (sweeps) {
    const auto along = sweep_scene(SceneFamily(input.source, set), asked_sweep(own, "", input.source, scene));
    SharedWork work(threads);
    return {source, sweep_json(*along, run_sweep(*along, work), false)};
  }
  Request request = asked_request(own, scene);
  set_speed(request, first_speed(own, scene));
  const SteadyResult result = steady(scene, request);
  return {source, steady_json(*result.model, result, result.settings, false)};
}

void require_one_kind(const ComparedSide& a, const ComparedSide& b) {
  if (a.document["rods"].contains("system") != b.document["rods"].contains("system"))
    throw UsageError("compare: found a mechanism and a [hill] scene, allowed: two of one kind");
  if (is_along(a) != is_along(b)) throw UsageError("compare: found one speed and a sweep, allowed: two of one kind");
  if (is_along(a)) require_comparable(a, b);
}

std::vector<Figure> steady_files(const ComparedSide& a, const ComparedSide& b, OutputFolder& place) {
  std::vector<Figure> figures;
  for (const CsvFile& file : compare_csvs(a, b)) {
    place.write(file.name, csv_text(file));
    figures.push_back(compare_response_figure(a, b, file));
  }
  return figures;
}

std::vector<Figure> along_files(const ComparedSide& a, const ComparedSide& b, OutputFolder& place) {
  std::vector<Figure> figures;
  for (const AlongCurves& curves : along_curves(a, b)) {
    place.write(curves.a.name, csv_text(curves.a));
    place.write(curves.b.name, csv_text(curves.b));
    figures.push_back(compare_along_figure(a, b, curves));
  }
  return figures;
}

// What a computation is asked for with says nothing of results that are there.
void require_a_scene(const CompareFlags& flags) {
  if (!is_document(flags.scene_file) || !is_document(flags.other)) return;
  const std::pair<const char*, bool> given[] = {{"--set", !flags.set.empty()},     {"--rpm", !flags.rpm.empty()},
                                                {"--omega", !flags.omega.empty()}, {"--tol", !flags.tolerance.empty()},
                                                {"--modes", !flags.modes.empty()}, {"--rods", !flags.rods.empty()},
                                                {"--only", !flags.only.empty()}};
  for (const auto& [flag, there] : given)
    if (there) throw UsageError(fmt::format("{}: found beside two folders of results, allowed: beside a scene", flag));
}

int run_compare(const CompareFlags& flags) {
  require_a_scene(flags);
  const Output out = output(flags);
  const bool sweeps = asks_for_sweeps(flags);
  std::string texts;
  const auto side = [&](const std::string& given, const std::vector<std::string>& more) {
    if (is_document(given)) {
      if (!more.empty()) throw UsageError("--set-b: found beside a folder of results, allowed: beside a scene");
      return from_files(given, sweeps ? "sweep.json" : "steady.json");
    }
    const SceneInput input = scene_input(given);
    texts += input.text;
    return computed(flags, input, more, sweeps, out.threads);
  };
  const ComparedSide a = side(flags.scene_file, {}), b = side(flags.other, flags.set_b);
  require_one_kind(a, b);
  std::optional<OutputFolder> folder;
  if (out.folder)
    folder.emplace(
        *out.folder, "compare",
        Provenance{fmt::format("hb {}", version()), flags.line, flags.scene_file + ", " + flags.other, texts});
  const Json document = is_along(a) ? compare_along_json(a, b) : compare_json(a, b);
  Delivery delivery;
  delivery.printed = out.json ? json_text(document) : is_along(a) ? compare_along_table(a, b) : compare_table(a, b);
  delivery.write_data = [&](OutputFolder& place) {
    place.write("compare.json", json_file_text(document));
    return is_along(a) ? along_files(a, b, place) : steady_files(a, b, place);
  };
  const auto reached = [](const ComparedSide& one) { return one.document.value("status", "reached") == "reached"; };
  return deliver(folder ? &*folder : nullptr, out.pictures, reached(a) && reached(b) ? exit_ok : exit_not_reached,
                 delivery);
}

}  // namespace

void add_compare_command(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "compare",
      "two designs side by side at one speed or along speeds: scenes, or folders that hb steady --out or "
      "hb sweep --out wrote");
  const auto flags = std::make_shared<CompareFlags>();
  add_scene_flags(*command, *flags);
  add_analysis_flags(*command, *flags);
  command->get_option("--rpm")->description("speed of the crank in revolutions per minute, or a range: then sweeps");
  command->get_option("SCENE")->description(
      "a scene file (TOML), or a folder that hb steady --out or hb sweep --out wrote");
  command->add_option("B", flags->other, "the other scene, or folder")->required();
  command->add_option("--set-b", flags->set_b, "a number of the second scene alone, as in AB.J=60; repeatable")
      ->type_name("PATH=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->callback([flags, &status] { status = run_compare(*flags); });
}

}  // namespace hb::tools
