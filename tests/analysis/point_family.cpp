// Points of a sweep that share work: what they come to, whoever asks in which order.
#include "hb/analysis/sweep/point_family.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "hb/analysis/sweep_analysis.hpp"

namespace hb {
namespace {

SweepScene scene_along(const std::string& file, double from, double to, std::size_t points) {
  Settings settings;
  settings.only = {.steady = false, .stability = true, .reactions = false, .shape = false};
  Axis axis;
  for (std::size_t k = 0; k < points; ++k)
    axis.values.push_back(from + (to - from) * static_cast<double>(k) / static_cast<double>(points - 1));
  return {SceneSource(std::string(HB_SOURCE_DIR "/") + file), {}, settings, axis, 0, 0};
}

std::vector<double> numbers(const SweepPoint& point) {
  std::vector<double> all;
  for (const RodPoint& rod : point.rods)
    for (const Exponent& e : rod.stability->stability.exponents)
      all.insert(all.end(), {e.value.real(), e.value.imag(), e.error});
  return all;
}

// The last points first, all at once by threads, each a second time in a family of its own: the same bits.
TEST(PointFamily, DoesNotDependOnOrderThreadsOrCompany) {
  const SweepScene scene = scene_along("tests/scenes/six_link.toml", 400, 900, 41);
  const Only& only = scene.settings().only;
  const std::size_t count = scene.axis().values.size();
  std::vector<std::vector<double>> forwards(count), backwards(count), threaded(count);
  PointFamily first(scene, only), second(scene, only), third(scene, only);
  for (std::size_t k = 0; k < count; ++k) forwards[k] = numbers(first.at(k));
  for (std::size_t k = count; k-- > 0;) backwards[k] = numbers(second.at(k));
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (std::size_t k = t; k < count; k += 4) threaded[k] = numbers(third.at(k));
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(forwards, backwards);
  EXPECT_EQ(forwards, threaded);
  for (const std::size_t k : {0, 7, 19, 40}) EXPECT_EQ(numbers(PointFamily(scene, only).at(k)), forwards[k]);
}

// Begun from neighbours or not: what the errors allow apart, and errors alike.
TEST(PointFamily, ExponentsAreThoseOfEachPlaceAlone) {
  for (const auto& [file, from, to] : {std::tuple("tests/scenes/six_link.toml", 300.0, 580.0),
                                       std::tuple("tests/scenes/six_link.toml", 1000.0, 3000.0),
                                       std::tuple("results/four_bar/scene.toml", 1000.0, 1560.0),
                                       std::tuple("results/slider_crank/scene.toml", 2000.0, 3400.0)}) {
    const SweepScene scene = scene_along(file, from, to, 29);
    PointFamily family(scene, scene.settings().only);
    for (std::size_t k = 0; k < 29; ++k) {
      const SweepPoint point = family.at(k), alone = analyse_point(scene, point.x, scene.settings().only);
      for (std::size_t r = 0; r < point.rods.size(); ++r) {
        const Stability &found = point.rods[r].stability->stability, &other = alone.rods[r].stability->stability;
        ASSERT_EQ(found.exponents.size(), other.exponents.size());
        EXPECT_EQ(found.verdict, other.verdict);
        // Begun from neighbours, corrections stop at 1e-13 of alpha; alone the last one goes far below what is asked.
        EXPECT_LE(found.growth_error, 10 * other.growth_error + 3e-13 * point.speed);
        for (const Exponent& e : found.exponents) {
          double nearest = HUGE_VAL;
          for (const Exponent& x : other.exponents) {
            const double turn = std::remainder(e.value.imag() - x.value.imag(), point.speed);
            nearest = std::min(nearest, std::hypot(e.value.real() - x.value.real(), turn) - x.error);
          }
          EXPECT_LE(nearest, e.error) << file << " " << point.x << " " << e.value;
        }
      }
    }
  }
}

// A range of few roundings has points that coincide, some with the last node: none was read beyond it.
TEST(PointFamily, PointsThatCoincideAreAnsweredAlike) {
  const SweepScene scene = scene_along("tests/scenes/six_link.toml", 400, 400 * (1 + 4e-16), 29);
  PointFamily family(scene, scene.settings().only);
  const SweepPoint first = family.at(0);
  for (std::size_t k = 1; k < 29; ++k) {
    const SweepPoint point = family.at(k);
    for (std::size_t r = 0; r < point.rods.size(); ++r) {
      const Stability &a = first.rods[r].stability->stability, &b = point.rods[r].stability->stability;
      EXPECT_EQ(a.verdict, b.verdict);
      EXPECT_LE(std::abs(a.growth_rate - b.growth_rate), a.growth_error + b.growth_error);
    }
  }
}

// Where a band of AB ends, the sign of its growth rate is not pursued; that of CD is.
TEST(SweepPoint, AtTheEndOfABandTheRodThatEndsItHasOneMethod) {
  const SweepScene scene = scene_along("tests/scenes/six_link.toml", 1600, 1700, 2);
  constexpr double end = 1683.8460206305933;
  const auto at = [&](std::vector<bool> rods) {
    return analyse_point(scene, end, scene.settings().only, {.at_boundary = std::move(rods)}).rods;
  };
  const auto second = [](const RodPoint& rod) {
    return rod.stability->stability.evidence.find("(second") != std::string::npos;
  };
  const std::vector<RodPoint> pursued = at({}), ended = at({true, false});
  EXPECT_TRUE(second(pursued[0]));
  EXPECT_FALSE(second(ended[0]));
  const Stability &a = pursued[0].stability->stability, &b = ended[0].stability->stability;
  EXPECT_LE(std::abs(a.growth_rate - b.growth_rate), a.growth_error + b.growth_error);
  EXPECT_LE(b.growth_error, 1e-7);
  EXPECT_EQ(pursued[1].stability->stability.evidence, ended[1].stability->stability.evidence);
  EXPECT_EQ(pursued[1].stability->stability.growth_rate, ended[1].stability->stability.growth_rate);
}

// The response of AB has no bound where a multiplier passes +1: what is told there has none either, and nothing else
// changes.
TEST(SweepPoint, AtAPoleTheResponseIsToldWithoutABound) {
  const SweepScene scene = scene_along("tests/scenes/six_link.toml", 2600, 2700, 2);
  constexpr double pole = 2682.134939869993;
  const auto at = [&](std::vector<bool> rods) {
    const Only steady{.steady = true, .stability = false, .reactions = false, .shape = false};
    return analyse_point(scene, pole, steady, {.at_pole = std::move(rods)}).rods;
  };
  const std::vector<RodPoint> pursued = at({}), told = at({true, false});
  EXPECT_FALSE(pursued[0].error_bound <= 1);
  EXPECT_EQ(told[0].steady, SteadyStatus::not_reached);
  EXPECT_EQ(told[0].error_bound, HUGE_VAL);
  EXPECT_GT(told[0].max_abs.front(), 1e6);
  EXPECT_EQ(told[1].error_bound, pursued[1].error_bound);
  EXPECT_EQ(told[1].max_abs, pursued[1].max_abs);
}

// Poles are those ends of bands that a peak without bound was located at; at all other places errors have bounds.
TEST(SweepPoint, PolesAreFoundBetweenThePointsOfASweep) {
  Settings settings;
  settings.only = {.steady = true, .stability = true, .reactions = false, .shape = false};
  Axis axis;
  for (double x = 2640; x <= 2720; x += 20) axis.values.push_back(x);
  const SweepScene scene(SceneSource(HB_SOURCE_DIR "/tests/scenes/six_link.toml"), {}, settings, axis, 0, 0);
  Work work;
  const SweepResult result = run_sweep(scene, work);
  const auto is_pole = [&](std::size_t r, double x) {
    return std::ranges::any_of(result.rods[r].boundaries, [x](const StabilityBoundary& boundary) {
      return boundary.x == x && boundary.kind == BoundaryKind::plus_one;
    });
  };
  int poles = 0;
  for (const SweepPoint& point : result.refined)
    for (std::size_t r = 0; r < point.rods.size(); ++r) {
      const bool pole = is_pole(r, point.x);
      poles += pole;
      EXPECT_EQ(point.rods[r].error_bound == HUGE_VAL, pole) << point.x;
      EXPECT_EQ(point.rods[r].resonance_distance == 0, pole) << point.x;
    }
  EXPECT_EQ(poles, 1);
  // The peak there is the boundary, with the boundary's error, and named by what is refined there.
  int unbounded = 0;
  for (const CriticalPoint& point : result.critical) {
    if (std::isfinite(point.peak.value)) continue;
    ++unbounded;
    EXPECT_TRUE(is_pole(point.rod, point.peak.x));
    EXPECT_TRUE(point.peak.converged);
    EXPECT_LE(point.peak.error, 1e-7);
    EXPECT_GT(point.peak.error, 0);
    EXPECT_EQ(point.mode, 0);
    EXPECT_EQ(point.order, 2);
  }
  EXPECT_EQ(unbounded, 1);
}

}  // namespace
}  // namespace hb
