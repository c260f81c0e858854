#include "tools/output/verdict_words.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "tools/output/output_units.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

constexpr std::size_t max_exponents_shown = 4;

bool is_linkage(const Scene& scene) { return std::holds_alternative<Linkage>(scene.model); }

// "5/2", "3", or "2.47" where the frequency is no multiple of half the speed.
std::string order_text(double order, double slack) {
  const double halves = std::round(2 * order);
  if (!(std::abs(2 * order - halves) <= 2 * slack)) return fmt::format("{:.4g}", order);
  const auto n = static_cast<long long>(halves);
  return n % 2 == 0 ? fmt::format("{}", n / 2) : fmt::format("{}/2", n);
}

// "strongest at 25, 75 and 125 Hz = 1/2, 3/2 and 5/2 of the speed"
std::string lines_text(const std::vector<DisturbanceLine>& lines, double speed, const Scene& scene, double slack) {
  constexpr std::size_t most = 4;
  const FrequencyUnit unit = frequency_unit(scene);
  std::vector<std::string> frequencies, orders;
  for (std::size_t k = 0; k < std::min(most, lines.size()); ++k) {
    frequencies.push_back(fmt::format("{:.4g}", lines[k].frequency * unit.factor));
    orders.push_back(order_text(lines[k].frequency / speed, slack / speed));
  }
  return fmt::format(", strongest at {} {} = {} of the speed", fmt::join(frequencies, ", "), unit.name,
                     fmt::join(orders, ", "));
}

// How the leading exponent's disturbance returns: after one turn the same, reversed, or at frequencies of its own.
std::string kind_of(const Stability& stability, double speed, const Scene& scene,
                    const std::vector<DisturbanceLine>& lines) {
  if (stability.exponents.empty()) return "";
  const Exponent& leading = stability.exponents.front();
  const double folded = std::abs(leading.value.imag());
  const double slack = std::max(leading.error, 1e-9 * speed);
  const std::string strongest = lines.empty() ? "" : lines_text(lines, speed, scene, slack);
  if (folded <= slack)
    return fmt::format(", repeating with every {}{}", is_linkage(scene) ? "turn of the crank" : "period", strongest);
  if (std::abs(folded - speed / 2) <= slack)
    return fmt::format(", repeating after two {} (period doubling){}",
                       is_linkage(scene) ? "turns of the crank" : "periods", strongest);
  return strongest;
}

// Leaves out the second of conjugate pairs.
std::vector<const Exponent*> one_of_each_pair(const std::vector<Exponent>& exponents) {
  std::vector<const Exponent*> shown;
  std::vector<bool> done(exponents.size(), false);
  for (std::size_t k = 0; k < exponents.size(); ++k) {
    if (done[k]) continue;
    shown.push_back(&exponents[k]);
    if (exponents[k].value.imag() == 0) continue;
    for (std::size_t other = k + 1; other < exponents.size(); ++other) {
      if (done[other] || exponents[other].value != std::conj(exponents[k].value)) continue;
      done[other] = true;
      break;
    }
  }
  return shown;
}

std::string join_names(const NamedVerdicts& verdicts, std::optional<Verdict> which) {
  std::vector<std::string> names;
  for (const auto& [name, verdict] : verdicts)
    if (verdict == which) names.push_back(name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

FrequencyUnit frequency_unit(const Scene& scene) {
  if (!is_linkage(scene)) return {1, "rad/" + scene.units.time};
  return {1 / (2 * std::numbers::pi * scene.units.time_in_s), "Hz"};
}

std::string verdict_sentence(const Stability& stability, double speed, const Scene& scene,
                             const std::vector<DisturbanceLine>& lines) {
  const double growth = stability.growth_rate + 0.0;  // no -0
  const double turn = 2 * std::numbers::pi / speed;
  const std::string& time = scene.units.time;
  const char* turns = is_linkage(scene) ? "turns" : "periods";
  switch (stability.verdict) {
    case Verdict::stable: {
      const double slowest = stability.growth_high, halving = std::numbers::ln2 / -slowest;
      return fmt::format(
          "stable: every disturbance dies out, in the long run at least as fast as exp({:.4g} t): halved in "
          "{:.3g} {} ({:.3g} {})",
          slowest, halving, time, halving / turn, turns);
    }
    case Verdict::unstable: {
      // Where little is known of how fast, the least that is certain.
      const bool certain = stability.growth_error <= 0.1 * growth;
      const double rate = certain ? growth : stability.growth_low, tenfold = std::numbers::ln10 / rate;
      return fmt::format(
          "UNSTABLE: disturbances grow {} exp({:.4g} t){}: tenfold in {}{:.3g} {} ({:.3g} {}). The periodic "
          "state exists but would not be seen in {}",
          certain ? "as" : "at least as fast as", rate, kind_of(stability, speed, scene, lines),
          certain ? "" : "at most ", tenfold, time, tenfold / turn, turns,
          is_linkage(scene) ? "a machine" : "an experiment");
    }
    case Verdict::bounded:
      return "bounded: without damping disturbances neither grow nor die out";
    case Verdict::undecided:
      break;
  }
  if (!std::isfinite(stability.growth_high) && std::isfinite(stability.growth_low))
    return fmt::format("undecided: the growth rate is at least {:.3g} 1/{}, and nothing bounds it from above",
                       stability.growth_low, time);
  if (!std::isfinite(stability.growth_error) && !std::isfinite(growth))
    return fmt::format("undecided: no growth rate was found ({})", stability.evidence);
  return fmt::format("undecided: the growth rate {:.3g} +/- {:.1e} 1/{} may be of either sign", growth,
                     stability.growth_error, time);
}

std::optional<Verdict> worst_of(const NamedVerdicts& verdicts) {
  std::optional<Verdict> result;
  for (const auto& [name, verdict] : verdicts)
    if (verdict) result = result ? worst(*result, *verdict) : *verdict;
  return result;
}

NamedVerdicts worst_of_each(const std::vector<NamedVerdicts>& points) {
  NamedVerdicts all;
  for (const NamedVerdicts& point : points)
    for (const auto& [name, verdict] : point) {
      const auto same = [&](const auto& entry) { return entry.first == name; };
      const auto known = std::find_if(all.begin(), all.end(), same);
      if (known == all.end())
        all.emplace_back(name, verdict);
      else if (verdict)
        known->second = known->second ? worst(*known->second, *verdict) : *verdict;
    }
  return all;
}

std::string verdict_at_points(const std::vector<NamedVerdicts>& points, const std::string& what) {
  const NamedVerdicts each = worst_of_each(points);
  const std::optional<Verdict> verdict = worst_of(each);
  if (!verdict) return "";
  const auto count = std::count_if(points.begin(), points.end(),
                                   [&](const NamedVerdicts& point) { return worst_of(point) == verdict; });
  const auto total = static_cast<std::ptrdiff_t>(points.size());
  return fmt::format("{} at {} {}", mechanism_verdict(each),
                     count == total ? fmt::format("all {}", total) : fmt::format("{} of {}", count, total), what);
}

NamedVerdicts named_verdicts(const std::vector<RodResult>& rods) {
  NamedVerdicts verdicts;
  for (const RodResult& rod : rods)
    verdicts.emplace_back(rod.name, rod.stability ? std::optional(rod.stability->verdict) : std::nullopt);
  return verdicts;
}

std::string mechanism_verdict(const NamedVerdicts& verdicts) {
  const std::optional<Verdict> verdict = worst_of(verdicts);
  if (!verdict) return "";
  const bool good = *verdict == Verdict::stable || *verdict == Verdict::bounded;
  // A [hill] scene is one system.
  if (!good && verdicts.size() == 1 && verdicts.front().first == "system")
    return *verdict == Verdict::unstable ? "UNSTABLE" : to_string(*verdict);
  const std::string names = join_names(verdicts, verdict), others = join_names(verdicts, std::nullopt);
  return fmt::format("{} {}{}{}{}", *verdict == Verdict::unstable ? "UNSTABLE" : to_string(*verdict),
                     good ? "(" : "because of ", names, good ? ")" : "",
                     others.empty() ? "" : "; not looked at: " + others);
}

std::string title_verdict(const NamedVerdicts& verdicts) {
  const std::optional<Verdict> verdict = worst_of(verdicts);
  if (!verdict) return "";
  const bool one = verdicts.size() == 1;
  const std::string names = join_names(verdicts, verdict);
  switch (*verdict) {
    case Verdict::unstable:
      return one ? "UNSTABLE" : "UNSTABLE because of " + names;
    case Verdict::undecided:
      return one ? "stability undecided" : "stability undecided because of " + names;
    case Verdict::stable:
    case Verdict::bounded:
      break;
  }
  return to_string(*verdict);
}

// Damping ratio -Re lambda/|Re lambda + i nu| with nu the frequency shown.
std::string exponents_rows(const Stability& stability, Eigen::Index unresolved, double speed, const Scene& scene) {
  if (stability.exponents.empty() && stability.uncertain.empty()) return "";
  const OutputUnits units = output_units(scene);
  const FrequencyUnit unit = frequency_unit(scene);
  std::string text =
      fmt::format("  {:<12}  {:>18}  {:>16}  {:>12}  {:>13}  {:>12}\n", "disturbances", "growth [" + units.rate + "]",
                  "frequency [" + unit.name + "]", is_linkage(scene) ? "per turn" : "per period", "damping ratio",
                  "error [" + units.rate + "]");
  const auto add = [&](const std::vector<Exponent>& exponents, const char* mark) {
    const std::vector<const Exponent*> shown = one_of_each_pair(exponents);
    for (std::size_t k = 0; k < std::min(shown.size(), max_exponents_shown); ++k) {
      const Exponent& e = *shown[k];
      const double re = e.value.real() + 0.0, size = std::hypot(re, e.frequency);
      const double slack = std::max(e.error, 1e-9 * speed) / speed;
      text += fmt::format(
          "  {:>12}  {:>18}  {:>16}  {:>12}  {:>13}  {:>12.1e}\n", mark,
          fmt::format("{:.{}g}", re, trusted_digits(re, e.error)),
          fmt::format("{:.{}g}", e.frequency * unit.factor, std::min(7, trusted_digits(e.frequency, e.error))),
          order_text(e.frequency / speed, slack), size > 0 ? fmt::format("{:.3g}", -re / size + 0.0) : "", e.error);
    }
    if (shown.size() > max_exponents_shown)
      text += fmt::format("    ... {} more (--json has all)\n", shown.size() - max_exponents_shown);
  };
  add(stability.exponents, "");
  if (unresolved > 0) {
    text +=
        fmt::format("    {} not resolved to a part in 10^6{}\n", unresolved, stability.uncertain.empty() ? "" : ":");
    add(stability.uncertain, "?");
  }
  return text;
}

std::string multipliers_rows(const Stability& stability, double speed, const Scene& scene) {
  if (stability.exponents.empty()) return "";
  std::string text = fmt::format("  {:<12}  {:>18}  {:>16}  {:>12}   what a {} makes of a disturbance\n", "multipliers",
                                 "real part", "imaginary part", "modulus", is_linkage(scene) ? "turn" : "period");
  for (const Exponent* e : one_of_each_pair(stability.exponents)) {
    const std::complex<double> mu = e->multiplier(speed);
    const double error = e->error * 2 * std::numbers::pi / speed * std::abs(mu);
    const double im = std::abs(mu.imag());
    const auto shown = [&](double value) { return fmt::format("{:.{}g}", value + 0.0, trusted_digits(value, error)); };
    text += fmt::format("  {:>12}  {:>18}  {:>16}  {:>12}\n", "", shown(mu.real()),
                        e->value.imag() == 0 || im <= error ? "0" : "+-" + shown(im), shown(std::abs(mu)));
  }
  return text;
}

}  // namespace hb::tools
