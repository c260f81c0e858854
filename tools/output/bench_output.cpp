#include "tools/output/bench_output.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/output/json.hpp"
#include "tools/output/json_output.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

constexpr double accuracies[] = {1e-3, 1e-6, 1e-9, 1e-12};

double peak_memory_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

// A name between the quotes of bench.csv.
std::string csv_name(std::string name) {
  std::replace(name.begin(), name.end(), '"', '\'');
  return name;
}

// An error is told by the reference as far as that is known itself.
std::string error_text(double error, double reference_error) {
  return error < reference_error ? fmt::format("< {:.1e}", reference_error) : fmt::format("{:.1e}", error);
}

// Of the scene, then of the linear theory where it is that.
std::vector<std::string> bench_warnings(const Bench& found) {
  std::vector<std::string> sentences = found.model->scene.warnings;
  if (!found.theory) return sentences;
  std::vector<std::string> rods;
  for (const auto& [name, verdict] : found.verdicts) rods.push_back(name);
  for (std::string& sentence : theory_warnings(rods, found.theory)) sentences.push_back(std::move(sentence));
  return sentences;
}

// That of one rod of the linear theory.
std::optional<double> theory_error_of(const Bench& found, const std::string& name) {
  const auto rod = std::ranges::find(found.verdicts, name, [](const auto& entry) { return entry.first; });
  return found.theory->rods[static_cast<std::size_t>(rod - found.verdicts.begin())].q;
}

}  // namespace

std::string bench_text(const Bench& found) {
  const SceneModel& model = *found.model;
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  const std::string verdict = mechanism_verdict(found.verdicts);
  fmt::format_to(out, "{}, {}{}{}\nerror against run time of the periodic state{}\n", scene_name(model.scene),
                 speed_text(found.given.omega, model.scene), verdict.empty() ? "" : ": ", verdict,
                 found.nonlinear ? ", motion without linearisation of all rods together" : "");
  fmt::format_to(out,
                 "Geometry, once for all speeds (harmonic balance only): {:.3g} s. Integration evaluates the "
                 "equations from the {} at every step.\n",
                 found.geometry_seconds, model.linkage() != nullptr ? "kinematics" : "series");
  for (const RodBench& bench : found.rods) {
    fmt::format_to(out, "\n{}, {}; reference by {}, error {:.1e}\n", bench.name, to_string(bench.verdict),
                   found.nonlinear ? "shooting (CVODE)" : "Radau collocation", bench.reference_error);
    if (found.theory)
      if (const std::optional<double> error = theory_error_of(found, bench.name))
        fmt::format_to(out, "  what the linear theory itself leaves out of q: {:.1e} of the largest\n", *error);
    fmt::format_to(out, "  {:<36} {:>8} {:>10} {:>10} {:>11} {:>11}\n", "method", "asked", "harm/steps", "error",
                   "min [s]", "median [s]");
    for (const BenchRow& row : bench.rows)
      fmt::format_to(out, "  {:<36} {:>8} {:>10} {:>10} {:>11.1e} {:>11.1e}\n", row.method,
                     row.asked > 0 ? fmt::format("{:.0e}", row.asked) : "", row.size,
                     error_text(row.error, bench.reference_error), row.seconds, row.median_seconds);
    for (const std::string& sentence : bench.notes) fmt::format_to(out, "  left out: {}\n", sentence);
    if (bench.rows.empty()) continue;
    for (const double error : accuracies) fmt::format_to(out, "  {}\n", ratio_sentence(bench, error));
    fmt::format_to(out, "  (shooting also gives the Floquet exponents, the others do not)\n");
  }
  fmt::format_to(out, "\nlargest memory of the whole run: {:.0f} MB\n", peak_memory_megabytes());
  for (const std::string& warning : bench_warnings(found)) fmt::format_to(out, "WARNING: {}\n", warning);
  return fmt::to_string(text);
}

Json bench_json(const Bench& found) {
  const Scene& scene = found.model->scene;
  const double speed = found.given.omega;
  Json json;
  json["title"] = scene.title;
  json["rpm"] = rpm_from_speed(speed, scene.units);
  json["omega"] = speed;
  json["theory"] = found.nonlinear ? "nonlinear" : "linear";
  if (const std::optional<Verdict> verdict = worst_of(found.verdicts)) json["verdict"] = to_string(*verdict);
  json["geometry_seconds"] = found.geometry_seconds;
  json["memory_megabytes"] = peak_memory_megabytes();
  if (std::vector<std::string> warnings = bench_warnings(found); !warnings.empty())
    json["warnings"] = std::move(warnings);
  json["rods"] = Json::object();
  for (const RodBench& bench : found.rods) {
    Json& rod = json["rods"][bench.name];
    rod["reference_error"] = bench.reference_error;
    rod["verdict"] = to_string(bench.verdict);
    if (found.theory) rod["theory_error"] = number(theory_error_of(found, bench.name));
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

std::string bench_csv(const Bench& found) {
  const Scene& scene = found.model->scene;
  std::string text = fmt::format(
      "scene,speed [rad/{}],rod,method,asked tolerance,harmonics or steps,error,seconds min,seconds median\n",
      scene.units.time);
  const std::string name = csv_name(scene_name(scene));
  for (const RodBench& bench : found.rods)
    for (const BenchRow& row : bench.rows)
      text += fmt::format("\"{}\",{},\"{}\",\"{}\",{},{},{},{},{}\n", name, found.given.omega, csv_name(row.rod),
                          row.method, row.asked, row.size, row.error, row.seconds, row.median_seconds);
  return text;
}

}  // namespace hb::tools
