// Bands and gaps along the speed, of random systems of many kinds and of linkages: sweeps of different steps against
// each other and against the verdicts of a fine grid.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/sweep.hpp"
#include "lib/rod/rod.hpp"
#include "tests/support/band_systems.hpp"
#include "tests/support/random_linkage.hpp"

namespace hb {
namespace {

struct Sweep {
  std::vector<UnstableBand> bands;
  std::vector<std::array<double, 2>> not_excluded;
  int points = 0, evaluations = 0;

  bool open(double x) const {
    return std::ranges::any_of(not_excluded, [&](const auto& piece) { return x >= piece[0] && x <= piece[1]; });
  }
  double open_share(double from, double to) const {
    double width = 0;
    for (const auto& piece : not_excluded) width += piece[1] - piece[0];
    return width / (to - from);
  }
};

Sweep sweep(const HillSystem& system, double from, double to, int intervals) {
  const SystemAt at = [&](double speed) { return scale_system(system, speed); };
  SweepOptions options;
  options.stability.tolerance = 1e-10;
  std::vector<StabilitySample> grid;
  for (int k = 0; k <= intervals; ++k) grid.push_back(*stability_sample(at, from + (to - from) * k / intervals, {}));
  std::vector<SearchedInterval> found;
  for (std::size_t k = 0; k + 1 < grid.size(); ++k)
    found.push_back(search_interval(at, grid[k], grid[k + 1], k > 0 ? &grid[k - 1] : nullptr,
                                    k + 2 < grid.size() ? &grid[k + 2] : nullptr, options));
  Sweep result;
  result.points = intervals + 1;
  std::vector<const StabilitySample*> samples;
  std::vector<StabilityBoundary> boundaries;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    samples.push_back(&grid[k]);
    if (k == found.size()) break;
    for (const StabilitySample& sample : found[k].samples) samples.push_back(&sample);
    boundaries.insert(boundaries.end(), found[k].boundaries.begin(), found[k].boundaries.end());
    result.not_excluded.insert(result.not_excluded.end(), found[k].not_excluded.begin(), found[k].not_excluded.end());
    result.evaluations += found[k].evaluations;
  }
  result.bands = unstable_bands(samples, boundaries);
  return result;
}

// Narrower ones and those whose growth is not above its error are not counted.
constexpr double least_width = 1e-8, least_growth = 4e-9, digits = 1e-9;

struct Counts {
  int sweeps = 0, bands = 0, missed_bands = 0, missed_gaps = 0, points = 0, evaluations = 0;
  double open_share = 0;
};

void compare(const HillSystem& system, double from, double to, const std::vector<int>& steps, int fine,
             const std::string& what, Counts& counts) {
  std::vector<Sweep> sweeps;
  for (const int intervals : steps) sweeps.push_back(sweep(system, from, to, intervals));
  for (const Sweep& s : sweeps) {
    ++counts.sweeps;
    counts.bands += static_cast<int>(s.bands.size());
    counts.points += s.points;
    counts.evaluations += s.evaluations;
    counts.open_share += s.open_share(from, to);
    // Bands, and gaps between two of them, that another step found.
    for (const Sweep& other : sweeps) {
      for (std::size_t k = 0; k < other.bands.size(); ++k) {
        const UnstableBand& band = other.bands[k];
        if (band.to - band.from > least_width * band.to && band.fastest > least_growth * from &&
            std::ranges::none_of(s.bands,
                                 [&](const UnstableBand& b) {
                                   return b.from <= band.to * (1 + digits) && b.to >= band.from * (1 - digits);
                                 }) &&
            !s.open(band.fastest_x)) {
          ++counts.missed_bands;
          ADD_FAILURE() << what << ", " << s.points << " points: no band " << band.from << " .. " << band.to
                        << ", growth " << band.fastest << ", which " << other.points << " points find";
        }
        if (k == 0) continue;
        const double left = other.bands[k - 1].to, right = band.from;
        if (right - left > least_width * right &&
            std::ranges::any_of(
                s.bands,
                [&](const UnstableBand& b) { return b.from < left * (1 - digits) && b.to > right * (1 + digits); }) &&
            !s.open(0.5 * (left + right))) {
          ++counts.missed_gaps;
          ADD_FAILURE() << what << ", " << s.points << " points: no gap " << left << " .. " << right << ", which "
                        << other.points << " points find";
        }
      }
    }
  }
  for (int k = 0; k < fine; ++k) {
    const double x = from + (to - from) * (k + 0.37) / fine;
    const Verdict verdict = analyse_stability(system, x).verdict;
    for (const Sweep& s : sweeps) {
      if (s.open(x)) continue;
      const auto inside = [&](double slack) {
        return std::ranges::any_of(
            s.bands, [&](const UnstableBand& b) { return x > b.from * (1 - slack) && x < b.to * (1 + slack); });
      };
      if (verdict == Verdict::unstable && !inside(digits)) {
        ++counts.missed_bands;
        ADD_FAILURE() << what << ", " << s.points << " points: stable at " << x;
      }
      if (verdict == Verdict::stable && inside(-digits)) {
        ++counts.missed_gaps;
        ADD_FAILURE() << what << ", " << s.points << " points: unstable at " << x;
      }
    }
  }
}

void report(const char* family, const Counts& counts) {
  std::printf(
      "%-18s %4d sweeps, %6d points and %6d between, %5d bands, missed: %d bands, %d gaps; not excluded %.2g %%\n",
      family, counts.sweeps, counts.points, counts.evaluations, counts.bands, counts.missed_bands, counts.missed_gaps,
      100 * counts.open_share / std::max(counts.sweeps, 1));
}

using Kind = stress::BandKind;

class Bands : public testing::TestWithParam<std::pair<Kind, const char*>> {};

TEST_P(Bands, AreTheSameAtAnyStepAndOnAFineGrid) {
  const auto [kind, name] = GetParam();
  Counts counts;
  for (int trial = 0; trial < stress::multiplied(2); ++trial) {
    stress::Random random(1000 * stress::seed() + 17 * static_cast<std::uint64_t>(trial) + std::uint64_t(kind));
    const HillSystem system = band_system(kind, random);
    const double from = random(0.4, 1.5), to = from * random(1.3, 4);
    compare(system, from, to, {2, 40}, 200, std::string(name) + " " + std::to_string(trial), counts);
  }
  report(name, counts);
  EXPECT_LE(counts.open_share, 0.01 * counts.sweeps);
}

INSTANTIATE_TEST_SUITE_P(Random, Bands,
                         testing::Values(std::pair{Kind::nearly_conservative, "NearlyConservative"},
                                         std::pair{Kind::undamped, "Undamped"}, std::pair{Kind::one_way, "OneWay"},
                                         std::pair{Kind::gyroscopic, "Gyroscopic"},
                                         std::pair{Kind::partly_driven, "PartlyDriven"},
                                         std::pair{Kind::circulatory, "Circulatory"}),
                         [](const auto& info) { return info.param.second; });

TEST(Bands, OfTheFamiliesOfExponentsAreTheSameAtAnyStep) {
  using enum stress::Family;
  for (const auto& [family, name] :
       {std::pair{plain, "plain"}, std::pair{full_matrices, "full"}, std::pair{undamped, "undamped"},
        std::pair{tongue, "tongue"}, std::pair{combination, "combination"}, std::pair{unsymmetric, "unsymmetric"},
        std::pair{strong, "strong"}, std::pair{alike, "alike"}, std::pair{sparse, "sparse"}}) {
    Counts counts;
    for (int trial = 0; trial < stress::multiplied(1); ++trial) {
      stress::Random random(1000 * stress::seed() + 31 * static_cast<std::uint64_t>(trial) + std::uint64_t(family));
      const stress::Trial t = stress::random_trial(family, random, 3);
      const double from = t.speed * random(0.4, 0.9), to = from * random(1.3, 3);
      compare(t.system, from, to, {5, 40}, 100, std::string(name) + " " + std::to_string(trial), counts);
    }
    report(name, counts);
    EXPECT_LE(counts.open_share, 0.01 * counts.sweeps) << name;
  }
}

TEST(Bands, OfLinkagesAreTheSameAtAnyStep) {
  Counts counts;
  for (const RandomLinkage& linkage : random_linkages(stress::multiplied(1), stress::seed() + 3, {0.3, 1})) {
    const LinkageCoefficients coefficients = linkage_coefficients(linkage.linkage);
    for (std::size_t r = 0; r < coefficients.links.size(); ++r) {
      const HillSystem system = ritz_system(*body_at(linkage.linkage, coefficients.links[r]), coefficients.rods[r], 3);
      compare(system, 0.7 * linkage.speed, 2 * linkage.speed, {4, 40}, 100, linkage.kind, counts);
    }
  }
  report("linkages", counts);
  EXPECT_LE(counts.open_share, 0.01 * counts.sweeps);
}

}  // namespace
}  // namespace hb
