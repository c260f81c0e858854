// Exponents, their errors and verdicts of random systems against a reference in 113 bits.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "hb/engine/exponents/stability.hpp"
#include "lib/stopwatch.hpp"
#include "tools/attack/case_flags.hpp"
#include "tools/attack/families.hpp"
#include "tools/attack/kept_references.hpp"

namespace hb::attack {
namespace {

using Clock = std::chrono::steady_clock;
struct Tally {
  int cases = 0, exponents = 0, uncovered = 0, missing = 0, infinite = 0, undecided = 0, wrong = 0,
      without_reference = 0;
  std::vector<double> ratios;  // bar over error, of what was asked for
  double slowest = 0;

  void add(const Tally& other) {
    cases += other.cases;
    exponents += other.exponents;
    uncovered += other.uncovered;
    missing += other.missing;
    infinite += other.infinite;
    undecided += other.undecided;
    wrong += other.wrong;
    without_reference += other.without_reference;
    ratios.insert(ratios.end(), other.ratios.begin(), other.ratios.end());
    slowest = std::max(slowest, other.slowest);
  }
};

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  const auto place = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

struct Options {
  int cases = 20, first = 0;
  double seconds = HUGE_VAL;
  std::uint64_t seed = 1;
  std::string family, method = "automatic", references;
  bool leading_only = false, beside = false, verbose = false;
  double tolerance = 1e-9;
};

const std::vector<std::pair<std::string, StabilityMethod>> methods = {{"automatic", StabilityMethod::automatic},
                                                                      {"slaving", StabilityMethod::slaving},
                                                                      {"propagation", StabilityMethod::propagation},
                                                                      {"hill", StabilityMethod::hill},
                                                                      {"determinant", StabilityMethod::determinant}};

// One case: every listed exponent has one of the reference within its bar, and every one of the reference that is
// neither listed nor below the growth rate's interval is missing.
void compare(const Stability& result, const std::vector<ReferenceExponent>& exact, double Omega, const Options& options,
             const std::string& name, Tally& tally) {
  std::vector<Exponent> listed = result.exponents;
  listed.insert(listed.end(), result.uncertain.begin(), result.uncertain.end());
  if (!options.leading_only && options.method != "determinant")
    tally.missing += std::max(0, int(exact.size()) - int(listed.size()));
  for (const Exponent& e : listed) {
    ++tally.exponents;
    if (!std::isfinite(e.error)) {
      ++tally.infinite;
      continue;
    }
    const QuadComplex s{Quad(e.value.real()) / Omega, Quad(e.value.imag()) / Omega};
    double nearest = HUGE_VAL, known = 0;
    for (const ReferenceExponent& x : exact) {
      const double d = distance(s, x.s);
      if (d < nearest) {
        nearest = d;
        known = x.error;
      }
    }
    const double bar = e.error / Omega;
    if (!(known <= 0.1 * bar || known <= 1e-18)) {
      ++tally.without_reference;
      continue;
    }
    const bool leading = e.value.real() + e.error >= result.growth_low;
    if (leading || !options.leading_only) tally.ratios.push_back(bar / std::max(nearest, 1e-18));
    if (nearest <= bar + known) continue;
    ++tally.uncovered;
    fmt::print("  UNCOVERED {}: ({:.17g}, {:.17g}) off by {:.2e}, bar {:.2e}; {}\n", name, e.value.real() / Omega,
               e.value.imag() / Omega, nearest, bar, result.evidence);
  }
  const double growth = double(exact.front().s.re) * Omega, known = exact.front().error * Omega;
  const bool wrong = (result.verdict == Verdict::stable && growth > known) ||
                     (result.verdict == Verdict::unstable && growth < -known) ||
                     (result.verdict == Verdict::bounded && std::abs(growth) > 1e-13 * Omega + known) ||
                     !(growth >= result.growth_low - known && growth <= result.growth_high + known);
  if (wrong) {
    ++tally.wrong;
    fmt::print("  WRONG {}: {}, growth {:.17g} in [{:.17g}, {:.17g}], is {:.17g}; {}\n", name,
               to_string(result.verdict), result.growth_rate, result.growth_low, result.growth_high, growth,
               result.evidence);
  }
  tally.undecided += result.verdict == Verdict::undecided;
}

// A speed higher by a hundred-thousandth to a tenth, about evenly by magnitude.
double beside(double speed, std::uint64_t number) {
  constexpr double golden = 0.6180339887498949;
  return speed * (1 + std::pow(10, -5 + 4 * std::fmod(golden * double(number % 1000000), 1)));
}

Tally run_case(Family family, std::uint64_t number, const Options& options, KeptReferences& references) {
  Tally tally;
  const Case c = random_case(family, number);
  const std::string name = fmt::format("{} {}", names[std::size_t(family)], number);
  const std::vector<ReferenceExponent> exact = references.of(family, number, c);
  if (exact.empty()) {
    ++tally.without_reference;
    return tally;
  }
  const auto method =
      std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.first == options.method; });
  std::vector<SlavingStart> starts;
  if (options.beside) starts = analyse_stability(c.system, beside(c.speed, number), {.keeps_solved = true}).solved;
  const Clock::time_point start = Clock::now();
  const Stability result = analyse_stability(c.system, c.speed,
                                             {.tolerance = options.tolerance,
                                              .method = method->second,
                                              .leading_only = options.leading_only,
                                              .starts = starts});
  tally.slowest = seconds_since(start);
  ++tally.cases;
  compare(result, exact, c.speed, options, name, tally);
  if (options.verbose) {
    fmt::print("{}: {} {:.6g} [{:.3e} {:.3e}]; {}\n", name, to_string(result.verdict), result.growth_rate / c.speed,
               result.growth_low / c.speed, result.growth_high / c.speed, result.evidence);
    for (const auto* list : {&result.exponents, &result.uncertain})
      for (const Exponent& e : *list) {
        const QuadComplex s{Quad(e.value.real()) / c.speed, Quad(e.value.imag()) / c.speed};
        double nearest = HUGE_VAL;
        for (const ReferenceExponent& x : exact) nearest = std::min(nearest, distance(s, x.s));
        fmt::print("    ({:.16g}, {:.16g}) error {:.1e} bar {:.1e}\n", double(s.re), double(s.im), nearest,
                   e.error / c.speed);
      }
  }
  return tally;
}

int run(const Options& options) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // what was found is not lost with the rest
  const Clock::time_point start = Clock::now();
  KeptReferences references(options.references);
  std::vector<Tally> tallies(num_families);
  for (int k = options.first; k < options.first + options.cases && seconds_since(start) < options.seconds; ++k)
    for (int f = 0; f < num_families && seconds_since(start) < options.seconds; ++f)
      if (options.family.empty() || options.family == names[std::size_t(f)])
        tallies[std::size_t(f)].add(
            run_case(Family(f), options.seed * 1000000 + std::uint64_t(k), options, references));
  fmt::print("{}{}{}, seed {}\n", options.method,
             options.leading_only ? ", leading exponents (medians: of the leading ones alone)" : "",
             options.beside ? ", begun beside" : "", options.seed);
  fmt::print("  {:<12} {:>6} {:>9} {:>9} {:>7} {:>8} {:>9} {:>5}  {:>8} {:>8} {:>9}  {:>9}\n", "family", "cases",
             "exponents", "uncovered", "missing", "infinite", "undecided", "wrong", "median", "90 %", "allowed",
             "slowest");
  Tally all;
  bool held = true;
  for (int f = 0; f < num_families; ++f) {
    const Tally& t = tallies[std::size_t(f)];
    if (t.cases == 0) continue;
    const double median = quantile(t.ratios, 0.5), allowed = allowed_median(Family(f));
    fmt::print("  {:<12} {:>6} {:>9} {:>9} {:>7} {:>8} {:>9} {:>5}  {:>8.2g} {:>8.2g} {:>9.4g}  {:>7.1f} ms\n",
               names[std::size_t(f)], t.cases, t.exponents, t.uncovered, t.missing, t.infinite, t.undecided, t.wrong,
               median, quantile(t.ratios, 0.9), allowed, 1e3 * t.slowest);
    held = held && t.uncovered == 0 && t.wrong == 0;
    all.add(t);
  }
  fmt::print("  {:<12} {:>6} {:>9} {:>9} {:>7} {:>8} {:>9} {:>5}  {} beyond the reference\n", "all", all.cases,
             all.exponents, all.uncovered, all.missing, all.infinite, all.undecided, all.wrong, all.without_reference);
  return held ? 0 : 1;
}

}  // namespace
}  // namespace hb::attack

int main(int argc, char** argv) {
  using namespace hb::attack;
  CLI::App app{"Exponents of random systems against a reference in 113 bits"};
  Options options;
  std::vector<std::string> known;
  for (const auto& [name, method] : methods) known.push_back(name);
  add_case_flags(app, options, "of each family", "every exponent");
  app.add_option("--family", options.family, "this one only")
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  app.add_option("--method", options.method)->check(CLI::IsMember(known));
  app.add_option("--tolerance", options.tolerance);
  app.add_option("--references", options.references, "file that keeps the references for the next time");
  app.add_flag("--beside", options.beside, "slaving begins with what it came to at a neighbouring speed");
  app.add_flag("--leading", options.leading_only, "leading exponents only");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
