// Maps of one mode by the surface of its discriminant: against single answers at places of the grid and beside
// boundaries, against Mathieu's characteristic values, tongues and islands narrower than the grid, the same bits in
// whatever order the work is done.
#include "hb/engine/boundaries/discriminant_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <thread>

#include "hb/engine/boundaries/stability_map.hpp"
#include "lib/constants.hpp"
#include "lib/rod/rod.hpp"
#include "tests/support/mathieu_boundaries.hpp"
#include "tests/support/six_link.hpp"

namespace {

using namespace hb;

// x'' + damping x' + (mean + sum_k Re(swing_k e^{i k Omega t})) x = 0.
HillSystem one_mode(double damping, double mean, const std::vector<std::complex<double>>& swing) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, damping);
  system.stiffness[0] = FourierSeries(1, static_cast<Eigen::Index>(swing.size()));
  system.stiffness[0].c(0, 0) = mean;
  for (std::size_t k = 0; k < swing.size(); ++k)
    system.stiffness[0].c(0, static_cast<Eigen::Index>(k) + 1) = swing[k] / 2.0;
  return system;
}

std::vector<double> even_values(double from, double to, int n) {
  std::vector<double> values;
  for (int k = 0; k < n; ++k) values.push_back(from + (to - from) * k / (n - 1));
  return values;
}

MapSystemAt mathieu_over_speed(double damping) {
  return [damping](double Omega, double swing) { return scale_system(one_mode(damping, 1.2, {swing}), Omega); };
}

// Undamped in the notation x'' + (a - 2 q cos 2t) x = 0.
std::optional<ScaledSystem> strutt(double a, double q) { return scale_system(one_mode(0, a, {-2 * q}), 2); }

MapSystemAt four_harmonics(double damping) {
  return [damping](double Omega, double swing) {
    return scale_system(one_mode(damping, 1.2, {swing, {0.2 * swing, 0.1 * swing}, 0.0, {0.0, 0.15 * swing}}), Omega);
  };
}

// The harmonics 2 and 4 alone: half a turn is the shortest period.
std::optional<ScaledSystem> even_harmonics(double Omega, double swing) {
  return scale_system(one_mode(0.02, 1.2, {0.0, swing, 0.0, 0.3 * swing}), Omega);
}

// Rod AB with one mode, over the speed and the internal damping.
MapSystemAt six_link_rod() {
  return [](double rpm, double damping) {
    const Linkage linkage = six_link::linkage({.J = 45, .internal_damping = damping});
    static const LinkageCoefficients coefficients = linkage_coefficients(linkage);
    return scale_system(ritz_system(*body_at(linkage, coefficients.links[0]), coefficients.rods[0], 1), rpm * pi / 30);
  };
}

// Verdicts and growth rates at `count` random places of the grid and beside its boundaries; verdicts on both sides of
// more than `beside` points of the curves.
void expect_as_single_answers(const MapSystemAt& at, const StabilityMap& map, int count, std::size_t beside = 10) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::size_t> column(0, map.x.size() - 1), row(0, map.y.size() - 1);
  std::vector<std::array<std::size_t, 2>> places;
  for (int k = 0; k < count; ++k) places.push_back({column(random), row(random)});
  for (std::size_t i = 0; i + 1 < map.x.size(); ++i)
    for (std::size_t j = 0; j < map.y.size(); j += 1 + map.y.size() / 8)
      if (map.at(i, j).verdict != map.at(i + 1, j).verdict) places.push_back({i, j}), places.push_back({i + 1, j});
  std::set<Verdict> seen;
  for (const auto& [i, j] : places) {
    const MapPoint& point = map.at(i, j);
    const Stability single = analyse_stability(*at(map.x[i], map.y[j]));
    seen.insert(single.verdict);
    EXPECT_EQ(point.verdict, single.verdict) << map.x[i] << ", " << map.y[j];
    EXPECT_LE(std::abs(point.growth_rate - single.growth_rate), point.growth_error + single.growth_error)
        << map.x[i] << ", " << map.y[j];
    EXPECT_NEAR(point.speed, at(map.x[i], map.y[j])->speed, 1e-12 * point.speed);
    if (point.source != MapSource::interpolated) continue;
    EXPECT_LE(point.growth_error, 2e-8 * std::max(point.speed, std::abs(point.growth_rate)));
    if (single.verdict == Verdict::unstable) {
      EXPECT_EQ(point.kind, boundary_kind(single, point.speed)) << map.x[i] << ", " << map.y[j];
    }
  }
  EXPECT_TRUE(seen.contains(Verdict::unstable));
  EXPECT_GE(seen.size(), 2u);
  std::size_t compared = 0;
  for (const BoundaryCurve& curve : map.boundaries)
    for (std::size_t k = 0; k < curve.points.size(); k += 5) {
      const BoundaryPoint& p = curve.points[k];
      const double size = std::abs(p.along_x ? p.x : p.y), step = 10 * p.error + 1e-9 * size;
      const auto verdict = [&](double by) {
        const auto system = p.along_x ? at(p.x + by, p.y) : at(p.x, p.y + by);
        return system ? analyse_stability(*system).verdict : Verdict::undecided;
      };
      const Verdict below = verdict(-step), above = verdict(step);
      if (below == Verdict::undecided || above == Verdict::undecided) continue;
      ++compared;
      EXPECT_NE(below == Verdict::unstable, above == Verdict::unstable) << p.x << ", " << p.y;
    }
  EXPECT_GT(compared, beside);
}

std::size_t interpolated(const StabilityMap& map) {
  return static_cast<std::size_t>(
      std::ranges::count(map.points, MapSource::interpolated, [](const MapPoint& p) { return p.source; }));
}

void expect_surface(const MapSystemAt& at, std::array<double, 2> x, std::array<double, 2> y, std::size_t most) {
  const StabilityMap map = stability_map(at, even_values(x[0], x[1], 301), even_values(y[0], y[1], 201));
  expect_as_single_answers(at, map, 300);
  EXPECT_GT(interpolated(map), map.points.size() * 99 / 100);
  EXPECT_LT(map.samples, most);
  EXPECT_TRUE(map.not_excluded.empty());
}

TEST(DiscriminantSurface, MathieusEquationIsWhatSingleAnswersSay) { expect_surface(strutt, {-4, 12}, {0.1, 8}, 12000); }

TEST(DiscriminantSurface, MathieusDampedEquationIsWhatSingleAnswersSay) {
  expect_surface(mathieu_over_speed(0.05), {0.6, 3}, {0, 1}, 8000);
}

TEST(DiscriminantSurface, SeveralHarmonicsAreWhatSingleAnswersSay) {
  expect_surface(four_harmonics(0.02), {0.7, 3}, {0, 1}, 12000);
}

TEST(DiscriminantSurface, ShorterPeriodsAreWhatSingleAnswersSay) {
  expect_surface(even_harmonics, {0.4, 1.8}, {0, 0.9}, 12000);
}

TEST(DiscriminantSurface, ARodOfTheSixLinkMechanismIsWhatSingleAnswersSay) {
  expect_surface(six_link_rod(), {600, 3000}, {2e-5, 2e-4}, 12000);
}

// Beside single answers of small grids, whose boundaries it locates.
TEST(DiscriminantSurface, NodesOfSmallGridsAreSingleAnswers) {
  const MapSystemAt at = four_harmonics(0.02);
  const StabilityMap map = stability_map(at, even_values(0.7, 3, 25), even_values(0, 1, 20));
  EXPECT_EQ(interpolated(map), 0u);
  expect_as_single_answers(at, map, 100);
}

TEST(DiscriminantSurface, ItsErrorHoldsAtPlacesThatItWasNotBuiltFrom) {
  for (const double damping : {0.0, 0.03}) {
    const MapSystemAt at = four_harmonics(damping);
    const auto surface = DiscriminantSurface::over(
        at, {.box = {{0.5, 0}, {3, 1.2}}, .varies = {true, true}, .most_evaluations = 20000, .parts = {}});
    ASSERT_TRUE(surface);
    EXPECT_EQ(surface->undamped(), damping == 0);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> x(0.5, 3), y(0, 1.2);
    for (int k = 0; k < 400; ++k) {
      const double u = x(random), v = y(random);
      const DiscriminantValue told = surface->at(u, v);
      const auto truth = discriminant(*at(u, v), 1, 1e-12);
      ASSERT_TRUE(truth);
      EXPECT_LE(std::abs((told.value - told.limit) - (truth->value - truth->limit())), told.error + truth->error);
      EXPECT_LE(std::abs(told.damping - truth->damping), told.damping_error);
      EXPECT_LT(told.error, 1e-8 * std::max(1.0, std::abs(told.value)));
    }
  }
}

// The tongue of order 5 at q = 0.9 is 1e-4 wide, the grid's lines are 0.05 apart.
TEST(DiscriminantSurface, TonguesBetweenTheLinesOfALargeGridAreFound) {
  const StabilityMap map = stability_map(strutt, even_values(0.5, 20.5, 401), even_values(0.4, 0.9, 201));
  for (const double q : {0.4, 0.9})
    for (int order = 1; order <= 4; ++order)
      for (const double truth : {double(reference::mathieu_a(order, q)), double(reference::mathieu_b(order, q))}) {
        if (truth < 0.5) continue;
        double nearest = HUGE_VAL;
        for (const BoundaryCurve& curve : map.boundaries)
          for (const BoundaryPoint& p : curve.points)
            if (p.y == q && p.along_x) nearest = std::min(nearest, std::abs(p.x - truth) - p.error);
        EXPECT_LE(nearest, 1e-10) << "order " << order << ", q = " << q << ", a = " << truth;
      }
}

// The swing has a hill at (1.03, 0.47) that is unstable on a disc of radius 0.005 alone, inside one cell of the grid of
// 16 x 16 that the search begins with.
TEST(DiscriminantSurface, AnIslandInsideACellIsFound) {
  const double damping = 0.1, least = 2 * damping * std::sqrt(1.2);
  const MapSystemAt at = [&](double x, double y) {
    const double r2 = (x - 1.03) * (x - 1.03) + (y - 0.47) * (y - 0.47);
    return scale_system(one_mode(damping, 1.2, {least * 1.02 / (1 + 900 * r2)}), 2 * std::sqrt(1.2));
  };
  const StabilityMap map = stability_map(at, even_values(1, 1.1, 301), even_values(0.4, 0.5, 201));
  ASSERT_EQ(map.boundaries.size(), 1u);
  EXPECT_TRUE(map.boundaries[0].closed);
  for (const BoundaryPoint& p : map.boundaries[0].points) EXPECT_LT(std::hypot(p.x - 1.03, p.y - 0.47), 0.01);
  expect_as_single_answers(at, map, 20, 5);
}

TEST(DiscriminantSurface, SameBitsInWhateverOrderAndThreadTheWorkIsDone) {
  const std::vector<double> x = even_values(0.6, 3, 251), y = even_values(0, 1, 181);
  const StabilityMap plain = stability_map(four_harmonics(0.01), x, y);
  MapOptions options;
  options.parts = [](const Parts& parts) {
    const auto part = [&](std::size_t k) {
      parts.compute(k);
      if (k % 3 == 0) parts.take(k, parts.numbers(k));
    };
    std::jthread even([&] {
      for (std::size_t k = 0; k < parts.count; k += 2) part(k);
    });
    for (std::size_t k = parts.count; k-- > 0;)
      if (k % 2 == 1) part(k);
  };
  const StabilityMap other = stability_map(four_harmonics(0.01), x, y, options);
  ASSERT_EQ(plain.points.size(), other.points.size());
  for (std::size_t p = 0; p < plain.points.size(); ++p) {
    ASSERT_EQ(plain.points[p].growth_rate, other.points[p].growth_rate);
    ASSERT_EQ(plain.points[p].growth_error, other.points[p].growth_error);
    ASSERT_EQ(plain.points[p].verdict, other.points[p].verdict);
  }
  EXPECT_EQ(plain.samples, other.samples);
  ASSERT_EQ(plain.boundaries.size(), other.boundaries.size());
  for (std::size_t c = 0; c < plain.boundaries.size(); ++c) {
    ASSERT_EQ(plain.boundaries[c].points.size(), other.boundaries[c].points.size());
    for (std::size_t k = 0; k < plain.boundaries[c].points.size(); ++k) {
      EXPECT_EQ(plain.boundaries[c].points[k].x, other.boundaries[c].points[k].x);
      EXPECT_EQ(plain.boundaries[c].points[k].y, other.boundaries[c].points[k].y);
    }
  }
}

// Where it cannot be: maps go on without it.
TEST(DiscriminantSurface, IsNotThereForSeveralModesHolesOrNegativeDamping) {
  const auto over = [](const MapSystemAt& at) {
    return DiscriminantSurface::over(
        at, {.box = {{0.5, 0}, {3, 1}}, .varies = {true, true}, .most_evaluations = 20000, .parts = {}});
  };
  EXPECT_TRUE(over(mathieu_over_speed(0.1)));
  EXPECT_FALSE(over(mathieu_over_speed(-0.1)));
  EXPECT_FALSE(over([](double Omega, double swing) -> std::optional<ScaledSystem> {
    if (Omega > 1 && Omega < 1.2) return std::nullopt;
    return mathieu_over_speed(0.1)(Omega, swing);
  }));
  EXPECT_FALSE(over([](double Omega, double swing) {
    HillSystem system = one_mode(0.1, 1.2, {swing});
    system.mass = system.damping = Eigen::MatrixXd::Identity(2, 2);
    const FourierSeries one = system.stiffness[0];
    system.stiffness[0] = FourierSeries(4, 1);
    for (const Eigen::Index k : {0, 3}) system.stiffness[0].c.row(k) = one.c.row(0);
    return scale_system(system, Omega);
  }));
}

}  // namespace
