// Bands and gaps that sweeps of random steps find on random lines, against single verdicts.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "hb/hb.hpp"
#include "lib/stopwatch.hpp"
#include "tests/support/random_hill_system.hpp"
#include "tools/attack/case_flags.hpp"
#include "tools/attack/lines.hpp"
#include "tools/attack/true_bands.hpp"

namespace hb::attack {
namespace {

// Narrower ones, and those that grow less, relative to the speed, are not counted: four times what a sweep looks for.
constexpr double least_width = 1e-8, least_growth = 4e-9;

struct Tally {
  int lines = 0, sweeps = 0, bands = 0, gaps = 0, missed_bands = 0, missed_gaps = 0, listed = 0, false_bands = 0,
      false_gaps = 0, ends = 0, uncovered_ends = 0, undecided = 0, evaluations = 0;
  double open_share = 0, slowest = 0;

  void add(const Tally& t) {
    lines += t.lines;
    sweeps += t.sweeps;
    bands += t.bands;
    gaps += t.gaps;
    missed_bands += t.missed_bands;
    missed_gaps += t.missed_gaps;
    listed += t.listed;
    false_bands += t.false_bands;
    false_gaps += t.false_gaps;
    ends += t.ends;
    uncovered_ends += t.uncovered_ends;
    undecided += t.undecided;
    evaluations += t.evaluations;
    open_share += t.open_share;
    slowest = std::max(slowest, t.slowest);
  }
};

struct Options {
  int cases = 2, first = 0;
  double seconds = HUGE_VAL;
  std::uint64_t seed = 1;
  std::string family;
  int grid = 120;
  bool verbose = false;
};

bool counts(const TrueBand& band, double speed) {
  return band.to - band.from > least_width * band.to && band.fastest > least_growth * speed;
}

bool within(double x, const std::vector<std::array<double, 2>>& pieces) {
  return std::ranges::any_of(pieces, [x](const auto& p) { return x >= p[0] && x <= p[1]; });
}

struct Asked {
  SweepRequest request;
  std::string words;
};

// Any number of points from 3 to 100, from and to a little beyond the line's ends.
Asked random_sweep(const Line& line, stress::Random& random) {
  Asked asked;
  const double length = line.to - line.from, from = line.from - random(0, 0.1) * std::min(length, line.from),
               to = line.to + random(0, 0.1) * length;
  const auto points = std::size_t(random.power(std::log10(3.0), 2));
  asked.request.x = along(line.path, from, to, points);
  if (line.path != "omega") asked.request.omega = line.speed;
  if (line.num_modes > 0) asked.request.modes = line.num_modes;
  asked.request.only = {.steady = false, .stability = true, .reactions = false, .shape = false};
  asked.words = fmt::format("{} points from {:.6g} to {:.6g}", points, from, to);
  return asked;
}

struct Truth {
  SingleVerdicts verdicts;
  std::vector<TrueBand> bands;
};

// What one sweep says of one rod against the truth.
void compare(const SweepRod& rod, Truth& truth, const Line& line, const std::string& what, Tally& tally) {
  const auto inside = [&](double x) { return x > line.from && x < line.to; };
  const auto speed = [&](double x) { return truth.verdicts.speed(x); };
  const std::vector<UnstableBand>& found = rod.bands;
  const auto overlaps = [](const auto& a, const auto& b, double slack) {
    return a.from <= b.to + slack && a.to >= b.from - slack;
  };
  for (std::size_t k = 0; k < truth.bands.size(); ++k) {
    const TrueBand& band = truth.bands[k];
    const double slack = 1e-9 * band.to;
    if (counts(band, speed(band.to)) &&
        std::ranges::none_of(found, [&](const UnstableBand& b) { return overlaps(b, band, slack); })) {
      if (within(band.fastest_x, rod.not_excluded)) {
        ++tally.listed;
      } else {
        ++tally.missed_bands;
        fmt::print("  MISSED BAND {}: {:.12g} .. {:.12g}, growth {:.3g}\n", what, band.from, band.to, band.fastest);
      }
    }
    if (k == 0) continue;
    const double left = truth.bands[k - 1].to, right = band.from;
    if (right - left > least_width * right && std::ranges::any_of(found, [&](const UnstableBand& b) {
          return b.from < left - slack && b.to > right + slack;
        })) {
      if (within(0.5 * (left + right), rod.not_excluded)) {
        ++tally.listed;
      } else {
        ++tally.missed_gaps;
        fmt::print("  MISSED GAP {}: {:.12g} .. {:.12g}\n", what, left, right);
      }
    }
  }
  for (std::size_t k = 0; k < found.size(); ++k) {
    const UnstableBand& band = found[k];
    if (inside(band.fastest_x) && (truth.verdicts.at(band.fastest_x).verdict == Verdict::stable ||
                                   truth.verdicts.at(band.fastest_x).verdict == Verdict::bounded)) {
      ++tally.false_bands;
      fmt::print("  FALSE BAND {}: {:.12g} .. {:.12g}, stable at {:.12g}\n", what, band.from, band.to, band.fastest_x);
    }
    const double middle = k > 0 ? 0.5 * (found[k - 1].to + band.from) : 0;
    if (k > 0 && inside(middle) && band.from - found[k - 1].to > least_width * middle &&
        truth.verdicts.at(middle).verdict == Verdict::unstable && !within(middle, rod.not_excluded)) {
      ++tally.false_gaps;
      fmt::print("  FALSE GAP {}: {:.12g} .. {:.12g}, unstable at {:.12g}\n", what, found[k - 1].to, band.from, middle);
    }
    // Ends of a band that is one in both lists.
    const TrueBand* same = nullptr;
    int partners = 0;
    for (const TrueBand& t : truth.bands)
      if (overlaps(band, t, 1e-9 * t.to)) {
        same = &t;
        ++partners;
      }
    if (partners != 1 ||
        std::ranges::count_if(found, [&](const UnstableBand& b) { return overlaps(b, *same, 1e-9 * same->to); }) != 1)
      continue;
    const auto end = [&](double here, double error, bool open, double there, double rest, bool there_open) {
      if (open || there_open || !inside(here)) return;
      ++tally.ends;
      if (std::abs(here - there) <= error + rest + 1e-11 * there) return;
      ++tally.uncovered_ends;
      fmt::print("  END {}: {:.15g} +/- {:.2g}, is {:.15g} +/- {:.2g}\n", what, here, error, there, rest);
    };
    end(band.from, band.error_from, band.open_from, same->from, same->error_from, same->open_from);
    end(band.to, band.error_to, band.open_to, same->to, same->error_to, same->open_to);
  }
}

Tally run_line(int family, std::uint64_t number, const Options& options) {
  constexpr int sweeps_each = 3;
  constexpr double slow = 10;  // seconds
  Tally tally;
  const Line line = random_line(family, number);
  stress::Random random(number * 9176 + 5);
  std::vector<Sweep> sweeps;
  std::vector<std::string> words;
  for (int k = 0; k < sweeps_each; ++k) {
    const Asked asked = random_sweep(line, random);
    const Stopwatch watch;
    sweeps.push_back(sweep(line.family, asked.request));
    tally.slowest = std::max(tally.slowest, watch.seconds());
    if (watch.seconds() > slow) fmt::print("  SLOW {}, {}: {:.0f} s\n", line.name, asked.words, watch.seconds());
    words.push_back(asked.words);
  }
  ++tally.lines;
  for (std::size_t r = 0; r < line.rods.size(); ++r) {
    Truth truth{SingleVerdicts(line.rods[r], line.from, line.to), {}};
    truth.verdicts.grid(options.grid);
    // Whatever a sweep says is looked at: where growth is largest, and between all ends that any of them has.
    std::vector<double> places, ends;
    for (const Sweep& s : sweeps)
      for (const UnstableBand& band : s.rods[r].bands) {
        places.push_back(band.fastest_x);
        ends.insert(ends.end(), {band.from, band.to});
      }
    std::ranges::sort(ends);
    for (std::size_t k = 1; k < ends.size(); ++k)
      if (ends[k] - ends[k - 1] > 1e-11 * ends[k]) places.push_back(0.5 * (ends[k - 1] + ends[k]));
    for (const double x : places)
      if (x > line.from && x < line.to) (void)truth.verdicts.at(x);
    truth.bands = truth.verdicts.bands();
    for (std::size_t k = 0; k < truth.bands.size(); ++k) {
      tally.bands += counts(truth.bands[k], truth.verdicts.speed(truth.bands[k].to));
      if (k > 0) tally.gaps += truth.bands[k].from - truth.bands[k - 1].to > least_width * truth.bands[k].from;
    }
    for (std::size_t k = 0; k < sweeps.size(); ++k) {
      const SweepRod& rod = sweeps[k].rods[r];
      ++tally.sweeps;
      double open = 0;
      for (const auto& piece : rod.not_excluded) open += piece[1] - piece[0];
      tally.open_share += open / (1.1 * (line.to - line.from));
      compare(rod, truth, line, fmt::format("{} rod {}, {}", line.name, r, words[k]), tally);
      if (options.verbose)
        for (const UnstableBand& b : rod.bands)
          fmt::print("    {}: {:.12g} .. {:.12g}, growth {:.3g}\n", words[k], b.from, b.to, b.fastest);
    }
    if (options.verbose)
      for (const TrueBand& b : truth.bands)
        fmt::print("    single verdicts: {:.12g} .. {:.12g}, growth {:.3g}\n", b.from, b.to, b.fastest);
    tally.evaluations += int(truth.verdicts.evaluations());
  }
  return tally;
}

int run(const Options& options) {
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // what was found is not lost with the rest
  const Stopwatch watch;
  std::vector<Tally> tallies(num_line_families);
  for (int k = options.first; k < options.first + options.cases && watch.seconds() < options.seconds; ++k)
    for (int f = 0; f < num_line_families && watch.seconds() < options.seconds; ++f)
      if (options.family.empty() || options.family == line_family(f))
        tallies[std::size_t(f)].add(run_line(f, options.seed * 1000000 + std::uint64_t(k), options));
  fmt::print("sweeps, seed {}\n", options.seed);
  fmt::print("  {:<20} {:>5} {:>6} {:>6} {:>5} {:>6} {:>6} {:>6} {:>5} {:>6} {:>9} {:>12} {:>9}\n", "family", "lines",
             "sweeps", "bands", "gaps", "missed", "listed", "false", "ends", "beyond", "verdicts", "not excluded",
             "slowest");
  Tally all;
  const auto print = [](const char* name, const Tally& t) {
    fmt::print("  {:<20} {:>5} {:>6} {:>6} {:>5} {:>6} {:>6} {:>6} {:>5} {:>6} {:>9} {:>10.2g} % {:>7.2f} s\n", name,
               t.lines, t.sweeps, t.bands, t.gaps, t.missed_bands + t.missed_gaps, t.listed,
               t.false_bands + t.false_gaps, t.ends, t.uncovered_ends, t.evaluations,
               100 * t.open_share / std::max(t.sweeps, 1), t.slowest);
  };
  for (int f = 0; f < num_line_families; ++f) {
    if (tallies[std::size_t(f)].lines == 0) continue;
    print(line_family(f), tallies[std::size_t(f)]);
    all.add(tallies[std::size_t(f)]);
  }
  print("all", all);
  return all.missed_bands + all.missed_gaps + all.false_bands + all.false_gaps + all.uncovered_ends == 0 ? 0 : 1;
}

}  // namespace
}  // namespace hb::attack

int main(int argc, char** argv) {
  using namespace hb::attack;
  CLI::App app{"Bands and gaps of sweeps at random steps against single verdicts"};
  Options options;
  std::vector<std::string> families;
  for (int f = 0; f < num_line_families; ++f) families.emplace_back(line_family(f));
  add_case_flags(app, options, "of each family", "every band");
  app.add_option("--grid", options.grid, "single verdicts on each line, before the search between them");
  app.add_option("--family", options.family, "this one only")->check(CLI::IsMember(families));
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
