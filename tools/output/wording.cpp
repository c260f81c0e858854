#include "tools/output/wording.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace hb::tools {
namespace {

// How the leading exponent's disturbance returns: after one turn the same, reversed, or at a frequency of its own.
std::string kind_of(const Stability& stability, double speed) {
  if (stability.exponents.empty()) return "";
  const double frequency = std::abs(stability.exponents.front().value.imag());
  const double slack = std::max(stability.exponents.front().error, 1e-9 * speed);
  if (frequency <= slack) return ", with the period of the crank";
  if (std::abs(frequency - speed / 2) <= slack) return ", at half the crank's speed (period doubling)";
  return "";
}

}  // namespace

std::string scene_name(const Scene& scene) {
  return scene.title.empty() ? scene.file.filename().string() : scene.title;
}

double rpm_of(double speed, const Units& units) {
  const double rpm = rpm_from_speed(speed, units);
  const double rounded = std::stod(fmt::format("{:.15g}", rpm));
  return speed_from_rpm(rounded, units) == speed ? rounded : rpm;
}

std::string speed_text(double speed, const Scene& scene) {
  if (std::holds_alternative<Linkage>(scene.model))
    return fmt::format("{:.10g} rpm", rpm_from_speed(speed, scene.units));
  return fmt::format("omega = {:.10g} rad/{}", speed, scene.units.time);
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

std::string growth_text(const Stability& stability) {
  const double above = stability.growth_high - stability.growth_rate;
  const double below = stability.growth_rate - stability.growth_low;
  // Twice as large on one side: said apart.
  if (!(std::max(above, below) > 2 * std::min(above, below)))
    return with_error(stability.growth_rate, stability.growth_error);
  return fmt::format("{:.{}g} +{:.1e} -{:.1e}", stability.growth_rate + 0.0,
                     trusted_digits(stability.growth_rate, std::min(above, below)), above, below);
}

std::string verdict_sentence(const Stability& stability, double speed, const Units& units) {
  const double growth = stability.growth_rate + 0.0;  // no -0
  const double turn = 2 * std::numbers::pi / speed;
  switch (stability.verdict) {
    case Verdict::stable: {
      const double slowest = stability.growth_high, halving = std::numbers::ln2 / -slowest;
      return fmt::format(
          "stable: every disturbance dies out, in the long run at least as fast as exp({:.4g} t): halved in "
          "{:.3g} {} ({:.3g} turns)",
          slowest, halving, units.time, halving / turn);
    }
    case Verdict::unstable: {
      // Where little is known of how fast, the least that is certain.
      const bool certain = stability.growth_error <= 0.1 * growth;
      const double rate = certain ? growth : stability.growth_low, tenfold = std::numbers::ln10 / rate;
      return fmt::format(
          "UNSTABLE: disturbances grow {} exp({:.4g} t){}: tenfold in {}{:.3g} {} ({:.3g} turns). The periodic "
          "state exists but would not be seen in a machine",
          certain ? "as" : "at least as fast as", rate, kind_of(stability, speed), certain ? "" : "at most ", tenfold,
          units.time, tenfold / turn);
    }
    case Verdict::bounded:
      return "bounded: without damping disturbances neither grow nor die out";
    case Verdict::undecided:
      break;
  }
  return fmt::format("undecided: the growth rate {:.3g} +/- {:.1e} per {} may be of either sign", growth,
                     stability.growth_error, units.time);
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

}  // namespace hb::tools
