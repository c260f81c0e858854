#include "tools/output/sweep_words.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/scene/scene_keys.hpp"
#include "tools/output/path_unit.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/verdict_words.hpp"

namespace hb::tools {
namespace {

// Where any elastic link is unstable; touching bands are one.
std::vector<std::array<double, 2>> unstable_anywhere(const SweepResult& result) {
  std::vector<std::array<double, 2>> bands;
  for (const SweepRod& rod : result.rods)
    for (const UnstableBand& band : rod.bands) bands.push_back({band.from, band.to});
  std::sort(bands.begin(), bands.end());
  std::vector<std::array<double, 2>> joined;
  for (const auto& band : bands) {
    if (joined.empty() || band[0] > joined.back()[1])
      joined.push_back(band);
    else
      joined.back()[1] = std::max(joined.back()[1], band[1]);
  }
  return joined;
}

// The worst of each rod over all points and bands.
NamedVerdicts worst_along(const SweepResult& result) {
  NamedVerdicts verdicts;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    std::optional<Verdict> verdict;
    for (const SweepPoint& point : result.points) {
      if (point.rods.empty() || !point.rods[r].stability) continue;
      const Verdict own = point.rods[r].stability->stability.verdict;
      verdict = verdict ? worst(*verdict, own) : own;
    }
    if (!result.rods[r].bands.empty()) verdict = Verdict::unstable;
    verdicts.emplace_back(result.rods[r].name, verdict);
  }
  return verdicts;
}

// "7503.3 to 7948.02"; of a band narrower than six digits show its place alone.
std::string span_text(double from, double to) {
  const std::string first = fmt::format("{:.6g}", from), last = fmt::format("{:.6g}", to);
  return first == last ? first : first + " to " + last;
}

// Of the points with an answer, how many have which verdict of all rods together.
struct Counts {
  std::size_t answers = 0, undecided = 0, bounded = 0, unstable = 0;
  std::size_t stable() const { return answers - undecided - bounded - unstable; }
};

Counts count_verdicts(const SweepResult& result) {
  Counts n;
  for (const SweepPoint& point : result.points) {
    if (point.rods.empty()) continue;
    ++n.answers;
    Verdict all = Verdict::stable;
    for (const RodPoint& rod : point.rods)
      if (rod.stability) all = worst(all, rod.stability->stability.verdict);
    n.undecided += all == Verdict::undecided;
    n.bounded += all == Verdict::bounded;
    n.unstable += all == Verdict::unstable;
  }
  return n;
}

}  // namespace

bool is_speed(const SweepScene& scene) { return scene.axis().kind != Axis::Kind::parameter; }

std::string axis_unit(const SweepScene& scene) {
  switch (scene.axis().kind) {
    case Axis::Kind::rpm:
      return "rpm";
    case Axis::Kind::omega:
      return "rad/" + scene.scene().units.time;
    case Axis::Kind::parameter:
      break;
  }
  return path_unit(scene.axis().path, scene.scene().units);
}

const SweepPoint* refined_point(const SweepResult& result, double x) {
  const auto found =
      std::find_if(result.refined.begin(), result.refined.end(), [&](const SweepPoint& point) { return point.x == x; });
  return found != result.refined.end() && !found->rods.empty() ? &*found : nullptr;
}

std::optional<double> distance_to_boundary(const SweepRod& rod, double x) {
  std::optional<double> nearest;
  const auto take = [&](double end) {
    if (const double distance = std::abs(x - end); !nearest || distance < *nearest) nearest = distance;
  };
  for (const UnstableBand& band : rod.bands) {
    if (!band.open_from) take(band.from);
    if (!band.open_to) take(band.to);
  }
  return nearest;
}

std::string sweep_verdict(const SweepScene& scene, const SweepResult& result) {
  if (!result.computed.stability || result.rods.empty()) return "";
  const Counts n = count_verdicts(result);
  const std::size_t none = result.points.size() - n.answers;
  const std::string rest = none > 0 ? fmt::format("; no answer at {}", counted(none, "point")) : "";
  std::vector<std::string> bands;
  for (const auto& [from, to] : unstable_anywhere(result)) bands.push_back(span_text(from, to));
  if (n.unstable == 0 && bands.empty()) {
    if (n.answers == 0) return "no answer at any point";
    if (n.undecided > 0) return fmt::format("undecided at {} of {} points{}", n.undecided, n.answers, rest);
    return fmt::format("{} at all {} points{}{}",
                       n.bounded == 0           ? "stable"
                       : n.bounded == n.answers ? "bounded"
                                                : "bounded or stable",
                       n.answers, none > 0 ? " that have an answer" : "", rest);
  }
  constexpr std::size_t most = 4;
  std::string where = fmt::format(" at {} of {} points", n.unstable, n.answers);
  if (!bands.empty()) {
    const std::size_t more = bands.size() > most ? bands.size() - most : 0;
    bands.resize(bands.size() - more);
    const std::string unit = axis_unit(scene);
    where = fmt::format(" at {}{}{}", fmt::join(bands, ", "), unit.empty() ? "" : " " + unit,
                        more > 0 ? fmt::format(" and in {} more bands", more) : "");
  }
  if (n.undecided > 0) where += fmt::format("; undecided at {} of {} points", n.undecided, n.answers);
  if (n.unstable + n.undecided < n.answers)
    where += fmt::format("; {} {}",
                         n.bounded == 0    ? "stable"
                         : n.stable() == 0 ? "bounded"
                                           : "bounded or stable",
                         result.searched_bands && none == 0 ? "elsewhere" : "at the others");
  return mechanism_verdict(worst_along(result)) + where + rest;
}

std::string sweep_title_verdict(const SweepResult& result) {
  if (!result.computed.stability || result.rods.empty()) return "";
  const NamedVerdicts verdicts = worst_along(result);
  const std::string text = title_verdict(verdicts);
  return text.starts_with("UNSTABLE") ? "UNSTABLE at some speeds" + text.substr(8) : text;
}

std::vector<std::string> sweep_warnings(const SweepScene& scene, const SweepResult& result) {
  std::vector<std::string> warnings = scene.warnings();
  for (std::string& sentence : theory_warnings(scene, result)) warnings.push_back(std::move(sentence));
  const std::vector<double>& values = scene.axis().values;
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const std::vector<std::array<double, 2>>& places = result.rods[r].not_excluded;
    if (places.empty()) continue;
    double width = 0;
    for (const auto& [from, to] : places) width += to - from;
    const auto widest =
        std::ranges::max_element(places, {}, [](const std::array<double, 2>& place) { return place[1] - place[0]; });
    warnings.push_back(fmt::format(
        "{}: further unstable bands or stable gaps are not excluded in {:.3g} % of the range, the widest place being "
        "{} = {:.10g} .. {:.10g}",
        result.rods[r].name, 100 * width / (values.back() - values.front()), scene.axis().path, (*widest)[0],
        (*widest)[1]));
  }
  for (std::string& sentence : limit_warnings(scene, result)) warnings.push_back(std::move(sentence));
  return warnings;
}

}  // namespace hb::tools
