#include "tools/output/check_report.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "hb/analysis/accuracy.hpp"
#include "tools/output/output_units.hpp"
#include "tools/output/table_output.hpp"
#include "tools/output/text.hpp"
#include "tools/output/theory_words.hpp"
#include "tools/output/verdict_words.hpp"
#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

// Exponents are the only comparison that is not relative.
std::string with_unit(const Comparison& c, const OutputUnits& units) {
  return c.what == "exponents" ? c.what + bracketed(units.rate) : c.what;
}

void add_comparison(Text& text, const Comparison& c, const OutputUnits& units) {
  add(text, "  {:<24} {:>10.2e}  {:>10.2e}  {}\n", with_unit(c, units), c.difference, c.allowed,
      c.agrees() ? "agrees" : "DISAGREES");
}

std::string differs(const Comparison& c, const OutputUnits& units) {
  const bool exponents = c.what == "exponents";
  return fmt::format("{} {} by {:.2e}, allowed {:.2e}{}", c.what, exponents ? "differ" : "differs", c.difference,
                     c.allowed, exponents ? " " + units.rate : "");
}

void add_rod(Text& text, const RodCheck& rod, const Settings& settings, bool stats, const OutputUnits& units) {
  const ShootingResult& shooting = rod.shooting;
  add(text, "\n{}\n", rod.name);
  if (rod.steady.status == SteadyStatus::singular)
    add(text, "  harmonic balance         {}\n", status_text(rod.steady.status));
  else
    add(text, "  harmonic balance         asked {:.1e}, bound {:.1e}, {} harmonics\n", settings.tolerance,
        rod.steady.error_bound, rod.steady.num_harmonics);
  if (shooting.orbit.q.size() == 0)
    add(text, "  shooting                 {}: {}\n", to_string(shooting.status), shooting.message);
  else
    add(text, "  shooting                 asked {:.1e}, reached {:.1e}; {}, {} steps, {} segment{} a turn, {:.3g} s\n",
        integration_tolerance(settings), shooting.q_error, to_string(shooting.integrator), shooting.steps,
        shooting.num_segments, shooting.num_segments == 1 ? "" : "s", shooting.seconds);
  if (rod.theory_error)
    add(text, "  linear theory            off by {:.2g} of the largest |q|: what both paths leave out\n",
        *rod.theory_error);
  if (stats)
    add(text, "  work                     {} evaluations, predicted {:.3g} s; {} {:.1e}\n", shooting.evaluations,
        shooting.predicted_seconds,
        shooting.integrator == Integrator::collocation ? "finest cell [rad]" : "finest local tolerance",
        shooting.integrator_tolerance);
  if (rod.marching)
    add(text, "  marching from rest       {}: {}{} turns, {} steps, {:.3g} s\n", to_string(rod.marching->status),
        rod.marching->message.empty() ? "" : rod.marching->message + "; ", rod.marching->turns, rod.marching->steps,
        rod.marching->seconds);
  if (!rod.compared()) {
    const bool said = shooting.orbit.q.size() == 0 && !rod.both_singular;
    add(text, "  not compared{}\n", said ? "" : "             " + rod.not_compared);
    return;
  }
  add(text, "  {:<24} {:>10}  {:>10}\n", "", "difference", "allowed");
  for (const Comparison& comparison : rod.comparisons()) add_comparison(text, comparison, units);
  if (!rod.stability) return;
  add(text, "  growth rate{:<13} {} and {}\n", bracketed(units.rate),
      with_error(rod.stability->growth_rate, rod.stability->growth_error),
      with_error(shooting.growth_rate, shooting.growth_error));
  add(text, "  exponents listed         {} and {}{}\n", rod.stability->exponents.size(), shooting.exponents.size(),
      shooting.some_below ? "; the others decay below what the integration resolves" : "");
  add(text, "  verdict                  {} and {}\n", to_string(rod.stability->verdict), to_string(shooting.verdict));
}

struct Agreement {
  const char *brief, *sentence;
};

Agreement agreement(const std::vector<SpeedCheck>& checks) {
  bool agree = true, complete = true, any = false;
  for (const SpeedCheck& check : checks) {
    agree = agree && check.agrees();
    any = any || check.joints;
    for (const RodCheck& rod : check.rods) {
      const bool known = rod.compared() || rod.both_singular;
      complete = complete && known;
      any = any || known;
    }
  }
  if (!agree) return {"DISAGREE", "The paths DISAGREE."};
  if (!any) return {"could not be compared", "Nothing could be compared."};
  if (complete) return {"agree", "The paths agree within the sum of their error bars."};
  return {"agree where they could be compared",
          "Not everything could be compared; what could agrees within the sum of the error bars."};
}

void add_times(Text& text, const std::vector<SpeedCheck>& checks) {
  double series = 0, shooting = 0, marching = 0;
  for (const SpeedCheck& check : checks) {
    series += check.seconds_harmonic_balance;
    shooting += check.seconds_shooting;
    marching += check.seconds_marching;
  }
  add(text, "time: harmonic balance {:.3g} s, shooting {:.3g} s", series, shooting);
  if (marching > 0) add(text, ", marching {:.3g} s", marching);
  add(text, "\n");
}

// "Six-link mechanism, 1500 rpm: stable (AB, CD); harmonic balance and time integration agree"
std::string verdict_line(const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  const std::string verdict = check_verdict(checks);
  return fmt::format("{}{}: {}{}harmonic balance and time integration {}\n", scene_name(model.scene),
                     checks.size() == 1 ? ", " + speed_text(checks.front().speed, model.scene) : "", verdict,
                     verdict.empty() ? "" : "; ", agreement(checks).brief);
}

// What both paths leave out of what belongs to the whole mechanism.
void add_theory_errors(Text& text, const TheoryErrors& theory, const OutputUnits& units) {
  std::vector<std::string> parts;
  if (theory.force) parts.push_back(fmt::format("joint forces {:.2g} of the largest", *theory.force));
  if (theory.torque) parts.push_back(fmt::format("torque {:.2g}", *theory.torque));
  if (theory.growth) parts.push_back(fmt::format("growth rate {:.2g} {}", *theory.growth, units.rate));
  if (!parts.empty()) add(text, "\nlinear theory off by: {}\n", fmt::join(parts, ", "));
}

void add_single(Text& text, const SceneModel& model, const SpeedCheck& check, const Settings& settings, bool stats) {
  const OutputUnits units = output_units(model.scene);
  for (const RodCheck& rod : check.rods) add_rod(text, rod, settings, stats, units);
  if (check.joints) {
    add(text, "\njoints\n  {:<24} {:>10}  {:>10}\n", "", "difference", "allowed");
    add_comparison(text, check.joints->forces, units);
    add_comparison(text, check.joints->torque, units);
    add(text, "  nearest to its allowance {}\n", check.joints->worst);
  }
  if (check.theory) add_theory_errors(text, *check.theory, units);
  add(text, "\n");
}

void add_range(Text& text, const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  const OutputUnits units = output_units(model.scene);
  const auto speed_column = [&](double speed) {
    return model.linkage() != nullptr ? rpm_from_speed(speed, model.scene.units) : speed;
  };
  add(text, "\n{:>10}  {:<12} {:>10} {:>10} {:>10} {:>10}  {:<10} {:<18} {}\n",
      model.linkage() != nullptr ? "rpm" : "omega", "rod", "q diff.", "allowed", "exp. diff.", "allowed", "verdict",
      "integrator", "agrees");
  const auto cells = [](const std::optional<Comparison>& c) {
    return c ? fmt::format("{:>10.2e} {:>10.2e}", c->difference, c->allowed) : fmt::format("{:>21}", "");
  };
  const std::vector<std::size_t> some = shown_rows(checks.size());
  std::size_t shown = 0;
  for (std::size_t k = 0; k < checks.size(); ++k) {
    const SpeedCheck& check = checks[k];
    const bool compared = std::ranges::all_of(check.rods, &RodCheck::compared);
    if (compared && check.agrees() && !std::ranges::binary_search(some, k)) continue;
    ++shown;
    const double speed = speed_column(check.speed);
    for (const RodCheck& rod : check.rods) {
      if (!rod.compared()) {
        add(text, "{:>10.6g}  {:<12} {}\n", speed, rod.name, rod.not_compared);
        continue;
      }
      add(text, "{:>10.6g}  {:<12} {} {}  {:<10} {:<18} {}\n", speed, rod.name, cells(rod.q), cells(rod.exponents),
          to_string(rod.shooting.verdict), to_string(rod.shooting.integrator), rod.agrees() ? "yes" : "NO");
    }
    if (check.joints)
      for (const auto& [name, c] : {std::pair<const char*, const Comparison&>{"joint forces", check.joints->forces},
                                    {"torque", check.joints->torque}})
        add(text, "{:>10}  {:<12} {} {:>53}{}\n", "", name, cells(c), "", c.agrees() ? "yes" : "NO");
  }
  if (shown < checks.size())
    add(text, "  ({} of {} speeds, the others agree; --json and --out have all)\n", shown, checks.size());
  if (const std::optional<WorstComparison> worst = worst_comparison(checks))
    add(text, "\nworst case: {} at {}, {}\n", worst->where, speed_text(worst->speed, model.scene),
        differs(worst->comparison, units));
}

void add_verdict(Text& text, const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  const OutputUnits units = output_units(model.scene);
  for (const SpeedCheck& check : checks) {
    const std::string at = checks.size() > 1 ? speed_text(check.speed, model.scene) + ": " : "";
    for (const RodCheck& rod : check.rods) {
      for (const Comparison& c : rod.comparisons())
        if (!c.agrees()) add(text, "DISAGREES: {}{}: {}\n", at, rod.name, differs(c, units));
      if (rod.opposite_verdicts())
        add(text, "DISAGREES: {}{}: harmonic balance says {}, time integration {}\n", at, rod.name,
            to_string(rod.stability->verdict), to_string(rod.shooting.verdict));
    }
    if (check.joints && !check.joints->forces.agrees())
      add(text, "DISAGREES: {}{}: {}\n", at, check.joints->worst, differs(check.joints->forces, units));
    if (check.joints && !check.joints->torque.agrees())
      add(text, "DISAGREES: {}{}\n", at, differs(check.joints->torque, units));
    for (const std::string& sentence : check.shortfalls) add(text, "NOT REACHED: {}{}\n", at, sentence);
  }
  for (const std::string& sentence : check_warnings(model, checks)) add(text, "WARNING: {}\n", sentence);
  add(text, "{}\n", agreement(checks).sentence);
}

}  // namespace

std::string check_verdict(const std::vector<SpeedCheck>& checks) {
  std::vector<NamedVerdicts> points;
  for (const SpeedCheck& check : checks) points.push_back(check.verdicts);
  return checks.size() == 1 ? mechanism_verdict(points.front()) : verdict_at_points(points, "speeds");
}

std::vector<std::string> check_warnings(const SceneModel& model, const std::vector<SpeedCheck>& checks) {
  std::vector<std::string> sentences = model.scene.warnings;
  if (!model.linkage()) return sentences;
  const std::vector<std::string>& rods = checks.front().theory_rods;
  if (checks.size() == 1 ||
      std::ranges::none_of(checks, [](const SpeedCheck& check) { return check.theory.has_value(); })) {
    for (std::string& sentence : theory_warnings(rods, checks.front().theory)) sentences.push_back(std::move(sentence));
    return sentences;
  }
  for (std::size_t r = 0; r < rods.size(); ++r) {
    std::vector<TheoryAlong> places;
    for (const SpeedCheck& check : checks)
      places.push_back({rpm_from_speed(check.speed, model.scene.units), check.theory.has_value(),
                        check.theory ? check.theory->rods[r].q : std::nullopt,
                        check.theory ? check.theory->reason : ""});
    if (std::string sentence = theory_warning(rods[r], "rpm", places); !sentence.empty())
      sentences.push_back(std::move(sentence));
  }
  return sentences;
}

std::string check_report(const Check& found, bool stats) {
  const SceneModel& model = *found.model;
  const std::vector<SpeedCheck>& checks = found.speeds;
  Text text;
  add(text, "{}", verdict_line(model, checks));
  if (found.over_range)
    add_range(text, model, checks);
  else
    add_single(text, model, checks.front(), found.settings, stats);
  add_times(text, checks);
  add_verdict(text, model, checks);
  if (stats) add(text, "\n{}", accuracy_table(found.settings));
  return fmt::to_string(text);
}

}  // namespace hb::tools
