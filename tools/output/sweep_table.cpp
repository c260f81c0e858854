#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>

#include "lib/constants.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/sweep_machine.hpp"
#include "tools/output/sweep_output.hpp"
#include "tools/output/sweep_theory.hpp"
#include "tools/output/sweep_words.hpp"
#include "tools/output/text.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

// The axis as the head of a narrow column: "rpm", "AB.J [mm^4]".
std::string axis_column(const SweepScene& scene) {
  if (scene.axis().kind == Axis::Kind::rpm) return "rpm";
  if (scene.axis().kind == Axis::Kind::omega) return "omega [rad/" + scene.scene().units.time + "]";
  return axis_label(scene);
}

std::string kind_words(BoundaryKind kind, bool linkage) {
  switch (kind) {
    case BoundaryKind::plus_one:
      return linkage ? "repeating with every turn (+1)" : "repeating with every period (+1)";
    case BoundaryKind::minus_one:
      return "period doubling (-1)";
    case BoundaryKind::complex:
      break;
  }
  return "at a frequency of its own (complex pair)";
}

std::string growth_digits(const Stability& stability) {
  if (stability.growth_rate == -HUGE_VAL) return "not found";
  if (stability.growth_rate == HUGE_VAL) return "no bound";
  if (stability.method == StabilityMethod::bound) return fmt::format("<= {:.4g}", stability.growth_high + 0.0);
  return fmt::format("{:.{}g}", stability.growth_rate + 0.0,
                     std::min(6, trusted_digits(stability.growth_rate, stability.growth_error)));
}

bool is_doubtful(const RodPoint& point) { return beyond_theory(point.theory_error) || beyond_limits(point); }

// "to boundary [rpm]"
std::string boundary_column(const SweepScene& scene) { return "to boundary" + bracketed(axis_unit(scene)); }

void add_point(Text& text, const SweepScene& scene, const SweepResult& result, std::size_t r, const SweepPoint& point,
               bool distances) {
  const OutputUnits units = output_units(scene.scene());
  add(text, "  {:>14.8g}", point.x);
  if (!point.problem.empty()) {
    add(text, "  no answer\n");
    return;
  }
  const RodPoint& here = point.rods[r];
  if (result.computed.steady && here.max_abs.empty()) add(text, "  {:>14}", "unbounded");
  if (result.computed.steady && !here.max_abs.empty()) add(text, "  {:>14.6g}", here.max_abs.front());
  if (result.computed.shape && here.steady == SteadyStatus::singular)
    add(text, "  {:>15}  {:>14}", "unbounded", "unbounded");
  else if (result.computed.shape)
    add(text, "  {:>15.6g}  {:>14.6g}", here.deflection.value_or(nan),
        here.bending_moment.value_or(nan) * units.moment);
  if (has_theory(scene, result))
    add(text, "  {:>12}",
        (here.theory_error ? fmt::format("{:.1e}", *here.theory_error) : "no value") +
            (is_doubtful(here) ? " !" : "  "));
  if (result.computed.stability) {
    const Stability& stability = here.stability->stability;
    add(text, "  {:>16}", growth_digits(stability));
    if (distances) {
      const std::optional<double> distance = distance_to_boundary(result.rods[r], point.x);
      add(text, "  {:>{}}", distance ? fmt::format("{:.6g}", *distance) : "",
          std::max<std::size_t>(14, boundary_column(scene).size()));
    }
    add(text, "  {}", stability.verdict == Verdict::unstable ? "UNSTABLE" : to_string(stability.verdict));
  }
  add(text, "\n");
}

// The widest places; all of them where they are few.
void add_not_excluded(Text& text, const SweepRod& rod, const std::string& unit) {
  constexpr std::size_t most = 6;
  std::vector<std::array<double, 2>> places = rod.not_excluded;
  if (places.empty()) return;
  add(text, "  bands or gaps not excluded\n");
  double left_out = 0;
  const std::size_t more = places.size() > most ? places.size() - most : 0;
  if (more > 0) {
    const auto width = [](const std::array<double, 2>& place) { return place[1] - place[0]; };
    std::ranges::stable_sort(places, std::ranges::greater(), width);
    for (std::size_t k = most; k < places.size(); ++k) left_out += width(places[k]);
    places.resize(most);
    std::ranges::sort(places);
  }
  for (const auto& [from, to] : places)
    add(text, "    {} .. {}{}, width {:.2g}\n", located(from, 0.1 * (to - from)), located(to, 0.1 * (to - from)), unit,
        to - from);
  if (more > 0)
    add(text, "    and {} narrower places, together {:.2g}{} wide (--json and --out have all)\n", more, left_out, unit);
}

void add_bands(Text& text, const SweepScene& scene, const SweepRod& rod) {
  const OutputUnits units = output_units(scene.scene());
  const bool linkage = scene.first().linkage() != nullptr;
  const std::string unit = axis_unit(scene).empty() ? "" : " " + axis_unit(scene);
  add(text, "  {}\n", rod.bands.empty() ? "no unstable band" : "unstable bands");
  for (const UnstableBand& band : rod.bands) {
    add(text, "    {} .. {}{} (+/- {:.1e})  fastest growth of its points {:.4g} {} at {:.6g}{}; begins {}, ends {}\n",
        located(band.from, band.error_from), located(band.to, band.error_to), unit,
        std::max(band.error_from, band.error_to), band.fastest, units.rate, band.fastest_x, unit,
        band.open_from ? "before the sweep" : kind_words(band.kind_from, linkage),
        band.open_to ? "beyond the sweep" : kind_words(band.kind_to, linkage));
  }
  add_not_excluded(text, rod, unit);
}

void add_peaks(Text& text, const SweepScene& scene, const SweepResult& result, std::size_t r) {
  const OutputUnits units = output_units(scene.scene());
  const FrequencyUnit frequency = frequency_unit(scene.scene());
  const std::string unit = axis_unit(scene).empty() ? "" : " " + axis_unit(scene);
  const auto found = std::count_if(result.critical.begin(), result.critical.end(),
                                   [&](const CriticalPoint& point) { return point.rod == r; });
  add(text, "  {}\n", found == 0 ? "no resonance peak" : "resonance peaks");
  for (const CriticalPoint& point : result.critical) {
    if (point.rod != r) continue;
    const SweepPoint* there = refined_point(result, point.peak.x);
    const bool unbounded = std::isinf(point.peak.value);
    add(text, "    {}{} (+/- {:.1e})  ", located(point.peak.x, point.peak.error), unit, point.peak.error);
    if (unbounded)
      add(text, "|q_{}| unbounded in the linear theory: a multiplier passes +1", point.component + 1);
    else
      add(text, "max |q_{}| = {:.5g}{}", point.component + 1, point.peak.value,
          units.response.empty() ? "" : " " + units.response);
    if (point.mode >= 0)
      add(text, ", mode {} at {:.4g} {} = {}Omega", point.mode + 1, point.frequency * frequency.factor, frequency.name,
          point.order == 1 ? "" : fmt::format("{} ", point.order));
    if (has_theory(scene, result) && (unbounded || (there && (beyond_theory(there->rods[r].theory_error)))))
      add(text, "; beyond the linear theory");
    add(text, "\n");
  }
}

}  // namespace

std::string sweep_table(const SweepScene& scene, const SweepResult& result) {
  const OutputUnits units = output_units(scene.scene());
  const std::vector<double>& values = scene.axis().values;
  const std::string verdict = sweep_verdict(scene, result);
  Text text;
  add(text, "{}{}{}\n{} = {:.10g} to {:.10g}{}, {} points", scene_name(scene.scene()), verdict.empty() ? "" : ": ",
      verdict, scene.axis().path, values.front(), values.back(),
      axis_unit(scene).empty() || axis_unit(scene) == scene.axis().path ? "" : " " + axis_unit(scene), values.size());
  if (!is_speed(scene)) add(text, " at {}", speed_text(result.points.front().speed, scene.scene()));
  add(text, "\n");
  const std::vector<std::size_t> rows = shown_rows(values.size());
  for (std::size_t r = 0; r < result.rods.size(); ++r) {
    const SweepRod& rod = result.rods[r];
    if (!rod.reported) continue;
    add(text, "\n{}: {} {}\n", rod.name, rod.num_modes,
        scene.first().linkage() ? (rod.num_modes == 1 ? "mode" : "modes")
                                : (rod.num_modes == 1 ? "unknown" : "unknowns"));
    const bool distances = distance_to_boundary(rod, values.front()).has_value();
    add(text, "  {:>14}", axis_column(scene));
    if (result.computed.steady) add(text, "  {:>14}", "max |q_1|" + bracketed(units.response));
    if (result.computed.shape) add(text, "  {:>15}  {:>14}", "deflection" + bracketed(units.length), "moment [N m]");
    if (has_theory(scene, result)) add(text, "  {:>12}", "theory error");
    if (result.computed.stability) {
      add(text, "  {:>16}", "growth" + bracketed(units.rate));
      if (distances) add(text, "  {:>14}", boundary_column(scene));
      add(text, "  verdict");
    }
    add(text, "\n");
    for (const std::size_t k : rows) add_point(text, scene, result, r, result.points[k], distances);
    if (has_theory(scene, result) && std::ranges::any_of(rows, [&](std::size_t k) {
          const SweepPoint& point = result.points[k];
          return point.problem.empty() && is_doubtful(point.rods[r]);
        }))
      add(text, "  !: beyond the linear theory or beyond small deflections, as the warnings below say\n");
    if (rows.size() < values.size())
      add(text, "  ({} of {} points; --json and --out have all)\n", rows.size(), values.size());
    if (result.computed.shape) add(text, "{}", stress_rows(scene, result, r));
    if (result.searched_bands)
      add_bands(text, scene, rod);
    else if (result.computed.stability)
      add(text, "  unstable bands between the points were not looked for\n");
    if (result.searched_peaks)
      add_peaks(text, scene, result, r);
    else if (result.computed.steady)
      add(text, "  resonance peaks between the points were not looked for\n");
  }
  if (result.computed.reactions) add(text, "{}", machine_rows(scene, result));
  add(text, "{}", theory_rows(scene, result));
  const auto closed = static_cast<std::size_t>(std::count_if(
      result.points.begin(), result.points.end(), [](const SweepPoint& point) { return point.problem.empty(); }));
  if (closed < result.points.size()) {
    const auto first = std::find_if(result.points.begin(), result.points.end(),
                                    [](const SweepPoint& point) { return !point.problem.empty(); });
    add(text, "\n{} of {} points have no answer; the first: {}\n", result.points.size() - closed, result.points.size(),
        first->problem);
  }
  add(text, "\n");
  for (const std::string& sentence : result.shortfalls) add(text, "NOT REACHED: {}\n", sentence);
  for (const std::string& sentence : result.notes) add(text, "NOTE: {}\n", sentence);
  for (const std::string& warning : sweep_warnings(scene, result))
    if (!warning.ends_with(not_judged)) add(text, "WARNING: {}\n", warning);
  if (!verdict.empty()) add(text, "Verdict: {}\n", verdict);
  return fmt::to_string(text);
}

}  // namespace hb::tools
