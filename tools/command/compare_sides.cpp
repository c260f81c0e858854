#include "tools/command/compare_sides.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "hb/analysis/analyses.hpp"
#include "hb/analysis/steady.hpp"
#include "tools/command/asked.hpp"
#include "tools/command/command.hpp"
#include "tools/command/scene_input.hpp"
#include "tools/command/speed_flags.hpp"
#include "tools/command/sweep_axis.hpp"
#include "tools/output/compare_along.hpp"
#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/work/shared_work.hpp"

namespace hb::tools {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

ComparedSides compared_sides(const CompareFlags& flags, int threads) {
  require_a_scene(flags);
  const bool sweeps = asks_for_sweeps(flags);
  ComparedSides sides;
  const auto side = [&](const std::string& given, const std::vector<std::string>& more) {
    if (is_document(given)) {
      if (!more.empty()) throw UsageError("--set-b: found beside a folder of results, allowed: beside a scene");
      return from_files(given, sweeps ? "sweep.json" : "steady.json");
    }
    const SceneInput input = scene_input(given);
    sides.texts += input.text;
    return computed(flags, input, more, sweeps, threads);
  };
  sides.a = side(flags.scene_file, {});
  sides.b = side(flags.other, flags.set_b);
  require_one_kind(sides.a, sides.b);
  return sides;
}

}  // namespace hb::tools
