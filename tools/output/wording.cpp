#include "tools/output/wording.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace hb::tools {
std::string scene_name(const Scene& scene) {
  return scene.title.empty() ? scene.file.filename().string() : scene.title;
}

double rpm_of(double speed, const Units& units) {
  const double rpm = rpm_from_speed(speed, units);
  const double rounded = std::stod(fmt::format("{:.15g}", rpm));
  return speed_from_rpm(rounded, units) == speed ? rounded : rpm;
}

std::string speed_text(double speed, const Scene& scene, int digits) {
  if (std::holds_alternative<Linkage>(scene.model))
    return fmt::format("{:.{}g} rpm", rpm_from_speed(speed, scene.units), digits);
  return fmt::format("omega = {:.{}g} rad/{}", speed, digits, scene.units.time);
}

std::string located(double x, double error) {
  constexpr int most = 9, fewest = 3;
  const double known = error > 0 && x != 0 ? std::log10(std::abs(x) / error) : most;
  return fmt::format("{:.{}g}", x, std::clamp(static_cast<int>(known) + 1, fewest, most));
}

int trusted_digits(double value, double error) {
  constexpr int fewest = 3, most = 10;
  if (value == 0 || !(error < std::abs(value))) return fewest;
  if (error == 0) return most;
  return std::clamp(static_cast<int>(std::floor(std::log10(std::abs(value) / error))) + 1, fewest, most);
}

std::string with_error(double value, double error) {
  return fmt::format("{:.{}g} +/- {:.1e}", value + 0.0, trusted_digits(value, error), error);
}

int verdict_number(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return -1;
    case Verdict::bounded:
      return -2;
    case Verdict::undecided:
      break;
    case Verdict::unstable:
      return 1;
  }
  return 0;
}

std::string growth_text(const Stability& stability, const std::string& unit) {
  const double rate = stability.growth_rate + 0.0, low = stability.growth_low + 0.0;
  if (rate == -HUGE_VAL) return "not found";
  if (rate == HUGE_VAL) return fmt::format("no upper bound, at least {:.4g} {}", low, unit);
  if (stability.method == StabilityMethod::bound) return fmt::format("between {:.4g} and {:.4g} {}", low, rate, unit);
  const double above = stability.growth_high - stability.growth_rate;
  const double below = stability.growth_rate - stability.growth_low;
  // Twice as large on one side: said apart.
  if (!(std::max(above, below) > 2 * std::min(above, below)))
    return with_error(rate, stability.growth_error) + " " + unit;
  return fmt::format("{:.{}g} +{:.1e} -{:.1e} {}", rate, trusted_digits(rate, std::min(above, below)), above, below,
                     unit);
}

std::vector<std::string> elastic_rockers(const Linkage& linkage) {
  std::vector<std::string> names;
  for (const Dyad& dyad : linkage.dyads) {
    const auto* rocker = std::get_if<Rocker>(&dyad.closing);
    if (rocker && rocker->body.elastic) names.push_back(rocker->body.name);
  }
  return names;
}

std::string force_frames(const std::vector<std::string>& elastic_rockers) {
  std::string text = "x along, y across the coupler of the joint's dyad";
  for (const std::string& name : elastic_rockers) text += fmt::format("; {0}.0 and {0}.1 along and across {0}", name);
  return text;
}

const char* status_text(SteadyStatus status) {
  switch (status) {
    case SteadyStatus::converged:
      return "converged";
    case SteadyStatus::not_reached:
      return "tolerance not reached";
    case SteadyStatus::singular:
      break;
  }
  return "singular";
}

std::vector<std::size_t> shown_rows(std::size_t count) {
  constexpr std::size_t most = 16;
  const std::size_t every = (count + most - 1) / most;
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < count; k += every) rows.push_back(k);
  if (rows.back() != count - 1) rows.push_back(count - 1);
  return rows;
}

std::string ordinal(std::size_t number) {
  const std::size_t last = number % 10, before = number / 10 % 10;
  const char* ending = before == 1 ? "th" : last == 1 ? "st" : last == 2 ? "nd" : last == 3 ? "rd" : "th";
  return fmt::format("{}{}", number, ending);
}

}  // namespace hb::tools
