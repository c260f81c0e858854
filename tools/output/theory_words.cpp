#include "tools/output/theory_words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace hb::tools {
namespace {

constexpr const char* beyond = "beyond the linear theory";

}  // namespace

std::vector<std::string> theory_warnings(const std::vector<std::string>& rods,
                                         const std::optional<TheoryErrors>& errors) {
  std::vector<std::string> sentences;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    const std::string& name = rods[r];
    if (!errors) {
      sentences.push_back(name + ": theory not judged: q was not computed");
      continue;
    }
    const std::optional<double>& error = errors->rods[r].q;
    if (!beyond_theory(error)) continue;
    sentences.push_back(error
                            ? fmt::format("{}: {}: the nonlinear correction changes q by {:.2g} of its largest value, "
                                          "more than {}",
                                          name, beyond, *error, theory_error_limit)
                            : fmt::format("{}: {}: {}", name, beyond, errors->reason));
  }
  return sentences;
}

std::vector<std::string> theory_warnings(const SceneModel& model, const SpeedResult& result) {
  if (!model.linkage()) return {};
  std::vector<std::string> rods;
  for (const RodResult& rod : result.rods) rods.push_back(rod.name);
  return theory_warnings(rods, result.theory);
}

bool has_theory(const SweepScene& scene, const SweepResult& result) {
  const Only& only = result.computed;
  return scene.first().linkage() && (only.steady || only.shape || only.reactions);
}

std::vector<std::string> theory_warnings(const SweepScene& scene, const SweepResult& result) {
  std::vector<std::string> sentences;
  if (!scene.first().linkage()) return sentences;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const std::string& name = result.rods[r].name;
    if (!has_theory(scene, result)) {
      sentences.push_back(name + ": theory not judged: q was not computed");
      continue;
    }
    // Runs of neighbouring points beyond.
    std::size_t count = 0, points = 0, without = 0;
    double largest = 0;
    std::string runs, why;
    const SweepPoint *first = nullptr, *last = nullptr;
    const auto close = [&] {
      if (first)
        runs += fmt::format("{}{:.6g}{}", runs.empty() ? "" : ", ", first->x,
                            first == last ? "" : fmt::format(" to {:.6g}", last->x));
      first = nullptr;
    };
    for (const SweepPoint& point : result.points) {
      if (point.rods.empty()) {
        close();
        continue;
      }
      ++points;
      const std::optional<double>& error = point.rods[r].theory_error;
      if (!beyond_theory(error)) {
        close();
        continue;
      }
      ++count;
      if (error) largest = std::max(largest, *error);
      without += !error;
      if (!error && why.empty())
        why = fmt::format("at {} = {:.6g}: {}", scene.axis().path, point.x, point.theory_reason);
      if (!first) first = &point;
      last = &point;
    }
    close();
    if (count == 0) continue;
    std::string size = largest > 0 ? fmt::format("theory error up to {:.2g}", largest) : "";
    if (without > 0)
      size += fmt::format("{}no value at {} of them, first {}", size.empty() ? "" : ", ", without, why);
    sentences.push_back(fmt::format("{}: {} at {} of {} points ({}): {} = {}", name, beyond, count, points, size,
                                    scene.axis().path, runs));
  }
  return sentences;
}

std::string beyond_text(const TheoryErrors& errors, std::size_t rod) {
  const std::optional<double>& error = errors.rods[rod].q;
  if (!beyond_theory(error)) return "";
  return error ? fmt::format("{} ({:.2g})", beyond, *error) : beyond;
}

std::string beyond_text(const SpeedResult& result) {
  std::string text;
  for (std::size_t r = 0; result.theory && r < result.rods.size(); ++r)
    if (const std::string one = beyond_text(*result.theory, r); !one.empty())
      text += (text.empty() ? "" : ", ") + result.rods[r].name + " " + one;
  return text;
}

}  // namespace hb::tools
