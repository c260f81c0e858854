#include "tools/output/theory_words.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hb::tools {
namespace {

constexpr const char* beyond = "beyond the linear theory";
constexpr const char* large = "beyond small deflections";

// What is too large for the theory of small deflections, in words; empty: nothing. The theory error, where there is
// one, says more than the deflection.
std::string too_large(const RodResult& rod, const Body& link, const std::optional<double>& theory_error) {
  std::vector<std::string> reasons;
  if (rod.stress && rod.stress->buckling_share() > buckling_share_limit)
    reasons.push_back(fmt::format("pushed with {:.3g} of its buckling load", rod.stress->buckling_share()));
  if (rod.stress && rod.stress->strain > strain_limit)
    reasons.push_back(fmt::format("strained by up to {:.2g} %", 100 * rod.stress->strain));
  if (!theory_error && rod.shape && rod.shape->deflection.max_abs > deflection_share_limit * link.length)
    reasons.push_back(fmt::format("bent by {:.2g} of its length", rod.shape->deflection.max_abs / link.length));
  return fmt::format("{}", fmt::join(reasons, ", "));
}

// Ranges of neighbouring places where `is` holds: "1270 to 1370, 1440 to 6000".
std::string runs(const std::vector<double>& x, const std::vector<bool>& is) {
  std::string text;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!is[k]) continue;
    const std::size_t first = k;
    while (k + 1 < x.size() && is[k + 1]) ++k;
    text += fmt::format("{}{:.6g}{}", text.empty() ? "" : ", ", x[first],
                        first == k ? "" : fmt::format(" to {:.6g}", x[k]));
  }
  return text;
}

}  // namespace

std::vector<std::string> theory_warnings(const std::vector<std::string>& rods,
                                         const std::optional<TheoryErrors>& errors) {
  std::vector<std::string> sentences;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    const std::string& name = rods[r];
    if (!errors) {
      sentences.push_back(name + ": " + not_judged);
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

std::string theory_warning(const std::string& name, const std::string& path, const std::vector<TheoryAlong>& places) {
  std::size_t count = 0, points = 0, without = 0;
  double largest = 0;
  std::string why;
  std::vector<double> x;
  std::vector<bool> is;
  for (const TheoryAlong& place : places) {
    x.push_back(place.x);
    is.push_back(place.there && beyond_theory(place.error));
    points += place.there;
    if (!is.back()) continue;
    ++count;
    if (place.error) largest = std::max(largest, *place.error);
    without += !place.error;
    if (!place.error && why.empty()) why = fmt::format("at {} = {:.6g}: {}", path, place.x, place.reason);
  }
  if (count == 0) return "";
  std::string size = largest > 0 ? fmt::format("theory error up to {:.2g}", largest) : "";
  if (without > 0) size += fmt::format("{}no value at {} of them, first {}", size.empty() ? "" : ", ", without, why);
  return fmt::format("{}: {} at {} of {} points ({}): {} = {}", name, beyond, count, points, size, path, runs(x, is));
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
      sentences.push_back(name + ": " + not_judged);
      continue;
    }
    std::vector<TheoryAlong> places;
    for (const SweepPoint& point : result.points)
      places.push_back({point.x, !point.rods.empty(), point.rods.empty() ? std::nullopt : point.rods[r].theory_error,
                        point.theory_reason});
    if (std::string sentence = theory_warning(name, scene.axis().path, places); !sentence.empty())
      sentences.push_back(std::move(sentence));
  }
  return sentences;
}

std::vector<std::string> limit_warnings(const SceneModel& model, const SpeedResult& result) {
  std::vector<std::string> sentences;
  for (std::size_t r = 0; model.linkage() && r < result.rods.size(); ++r) {
    const RodResult& rod = result.rods[r];
    const std::string why =
        too_large(rod, *body_at(*model.linkage(), rod.link), result.theory ? result.theory->rods[r].q : std::nullopt);
    if (!why.empty()) sentences.push_back(fmt::format("{}: {}: {}", rod.name, large, why));
  }
  return sentences;
}

std::vector<std::string> limit_warnings(const SweepScene& scene, const SweepResult& result) {
  std::vector<std::string> sentences;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    std::vector<double> x;
    std::vector<bool> is;
    for (const SweepPoint& point : result.points) {
      x.push_back(point.x);
      is.push_back(!point.rods.empty() && beyond_limits(point.rods[r]));
    }
    const std::string where = runs(x, is);
    if (where.empty()) continue;
    double share = 0, strain = 0;
    for (const SweepPoint& point : result.points) {
      if (point.rods.empty()) continue;
      share = std::max(share, point.rods[r].buckling_share.value_or(0));
      strain = std::max(strain, point.rods[r].strain.value_or(0));
    }
    sentences.push_back(
        fmt::format("{}: {} (pushed with up to {:.3g} of its buckling load, strained by up to {:.2g} %): "
                    "{} = {}",
                    result.rods[r].name, large, share, 100 * strain, scene.axis().path, where));
  }
  return sentences;
}

std::string beyond_text(const SpeedResult& result, std::size_t r) {
  const RodResult& rod = result.rods[r];
  std::string text;
  if (result.theory && beyond_theory(result.theory->rods[r].q)) {
    const std::optional<double>& error = result.theory->rods[r].q;
    text = error ? fmt::format("{} ({:.2g})", beyond, *error) : beyond;
  }
  if (rod.stress && (rod.stress->buckling_share() > buckling_share_limit || rod.stress->strain > strain_limit))
    text += (text.empty() ? "" : ", ") + std::string(large);
  return text;
}

std::string beyond_text(const SpeedResult& result) {
  std::string text;
  for (std::size_t r = 0; r < result.rods.size(); ++r)
    if (const std::string one = beyond_text(result, r); !one.empty())
      text += (text.empty() ? "" : "; ") + result.rods[r].name + " " + one;
  return text;
}

}  // namespace hb::tools
