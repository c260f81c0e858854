// Stability maps: Strutt's chart against Mathieu's characteristic values, boundaries against the sign of the growth
// rate by another method, the quadtree against the full grid, curves put together from crossings.
#include "hb/engine/boundaries/stability_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <thread>

#include "lib/constants.hpp"

namespace {

using namespace hb;

FourierSeries harmonics(std::initializer_list<Eigen::MatrixXd> cosines) {
  const Eigen::Index n = cosines.begin()->size();
  FourierSeries series(n, static_cast<Eigen::Index>(cosines.size()) - 1);
  Eigen::Index k = 0;
  for (const Eigen::MatrixXd& c : cosines) {
    series.c.col(k) = c.reshaped() * (k == 0 ? 1.0 : 0.5);
    ++k;
  }
  return series;
}

// x'' + damping x' + (mean + swing cos Omega t) x = 0.
HillSystem oscillator(double damping, double mean, double swing) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, damping);
  system.stiffness[0] = harmonics({Eigen::MatrixXd::Constant(1, 1, mean), Eigen::MatrixXd::Constant(1, 1, swing)});
  return system;
}

// Two oscillators of frequencies 1 and sqrt(3), coupled by the swing: combination resonances beside their own.
HillSystem coupled(double damping, double swing) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(2, 2);
  system.damping = damping * Eigen::MatrixXd::Identity(2, 2);
  Eigen::MatrixXd mean(2, 2), moving(2, 2);
  mean << 1, 0.05, 0.05, 3;
  moving << 0.6, 0.9, 0.9, -0.4;
  system.stiffness[0] = harmonics({mean, swing * moving});
  return system;
}

std::vector<double> spaced(double from, double to, int n) {
  std::vector<double> values;
  for (int k = 0; k < n; ++k) values.push_back(from + (to - from) * k / (n - 1));
  return values;
}

MapSystemAt speed_and_swing(double damping) {
  return [damping](double Omega, double swing) { return scale_system(oscillator(damping, 1.2, swing), Omega); };
}

MapSystemAt coupled_map(double damping) {
  return [damping](double Omega, double swing) { return scale_system(coupled(damping, swing), Omega); };
}

Stability stability_at(const MapSystemAt& at, double x, double y) { return analyse_stability(*at(x, y)); }

struct Characteristic {
  std::string name;
  double q, a;
};

std::vector<Characteristic> characteristic_values() {
  std::ifstream file(HB_SOURCE_DIR "/tests/reference/mathieu_characteristic.csv");
  std::vector<Characteristic> values;
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#' || line[0] == 'f') continue;
    std::istringstream text(line);
    std::string function, m, q, scipy, value;
    std::getline(text, function, ',');
    std::getline(text, m, ',');
    std::getline(text, q, ',');
    std::getline(text, scipy, ',');
    std::getline(text, value, ',');
    values.push_back({function + m, std::stod(q), std::stod(value)});
  }
  return values;
}

TEST(StabilityMap, StruttsChartPassesThroughMathieusCharacteristicValues) {
  const std::vector<Characteristic> table = characteristic_values();
  ASSERT_EQ(table.size(), 225u);
  std::vector<double> q = {0};
  for (const Characteristic& c : table) {
    if (c.name == "a0") q.push_back(c.q);
  }
  // x'' + (a - 2 q cos 2t) x = 0.
  const MapSystemAt at = [](double a, double q) { return scale_system(oscillator(0, a, -2 * q), 2); };
  const std::vector<double> a = spaced(-3, 20, 47);
  MapOptions options;
  options.sag = 0.05;
  const StabilityMap map = stability_map(at, a, q, options);
  const auto width_of_tongue = [&](const Characteristic& c) {
    for (const Characteristic& d : table) {
      if (d.q == c.q && d.name[0] != c.name[0] && d.name[1] == c.name[1]) return std::abs(c.a - d.a);
    }
    return HUGE_VAL;  // a_0 has no partner
  };
  double worst = 0;
  int compared = 0;
  for (const Characteristic& c : table) {
    if (c.a <= a.front() || c.a >= a.back()) continue;
    ++compared;
    double nearest = HUGE_VAL;
    BoundaryKind kind = BoundaryKind::complex;
    for (const BoundaryCurve& curve : map.boundaries) {
      for (const BoundaryPoint& p : curve.points) {
        if (p.along_x && p.y == c.q && std::abs(p.x - c.a) < nearest) {
          nearest = std::abs(p.x - c.a);
          kind = curve.kind;
        }
      }
    }
    // Inside a tongue of width w at distance d from its end the growth is g = sqrt(w d/a)/2 at most; it is told from
    // zero when it exceeds the root of the discriminant's rounding, 1e-7.
    const double rounding = 4 * 1e-14 * std::abs(c.a) / width_of_tongue(c);
    EXPECT_LE(nearest, 1e-10 * std::max(1.0, std::abs(c.a)) + 10 * rounding)
        << c.name << " at q = " << c.q << ", a = " << c.a;
    EXPECT_EQ(kind, (c.name[1] - '0') % 2 == 0 ? BoundaryKind::plus_one : BoundaryKind::minus_one) << c.name;
    worst = std::max(worst, nearest);
  }
  EXPECT_GT(compared, 150);
  RecordProperty("largest_distance", std::to_string(worst * 1e12) + "e-12");
}

// The growth rate by propagation of the whole system, a method that the map does not use on these systems.
double growth_by_propagation(const HillSystem& system, double Omega) {
  StabilityOptions options;
  options.method = StabilityMethod::propagation;
  options.tolerance = 1e-12;
  return analyse_stability(system, Omega, options).growth_rate;
}

TEST(StabilityMap, GrowthByPropagationChangesSignWithin1e10OfEveryBoundaryPoint) {
  constexpr double damping = 0.02;
  MapOptions options;
  options.sag = 0.01;
  options.search.stability.tolerance = 1e-12;
  const StabilityMap map = stability_map(coupled_map(damping), spaced(1.6, 4, 9), spaced(0.05, 0.4, 4), options);
  std::size_t points = 0, claimed = 0, compared = 0;
  for (const BoundaryCurve& curve : map.boundaries) {
    for (const BoundaryPoint& p : curve.points) {
      // Where an edge nearly touches the curve the growth rate's error moves the crossing further: it is said.
      const double promised = 1e-10 * (p.along_x ? p.x : p.y), h = std::max(promised, p.error);
      claimed += p.error <= promised;
      if (points++ % 7 != 0 && h == promised) continue;
      ++compared;
      const auto growth = [&](double step) {
        return p.along_x ? growth_by_propagation(coupled(damping, p.y), p.x + step)
                         : growth_by_propagation(coupled(damping, p.y + step), p.x);
      };
      const double after = growth(h), before = growth(-h);
      // Only where the growth rate hardly changes over what was promised.
      if (p.error > promised) {
        const double bar = stability_at(coupled_map(damping), p.x, p.y).growth_error;
        EXPECT_LE(std::abs(after - before) / (2 * h) * promised, 4 * bar) << p.x << ", " << p.y;
      }
      EXPECT_LT(after * before, 0) << p.x << ", " << p.y << (p.along_x ? " along x: " : " along y: ") << before << ", "
                                   << after << ", error " << p.error;
    }
  }
  EXPECT_GT(compared, 20u);
  EXPECT_GT(claimed, points / 2);
}

TEST(StabilityMap, KindsOfTheCoupledOscillatorsAreAllThere) {
  MapOptions options;
  options.sag = 0.01;
  const StabilityMap map = stability_map(coupled_map(0.02), spaced(0.8, 4, 13), spaced(0.05, 0.4, 4), options);
  const auto near = [&](BoundaryKind kind, double Omega) {
    double nearest = HUGE_VAL;
    for (const BoundaryCurve& curve : map.boundaries) {
      if (curve.kind != kind) continue;
      for (const BoundaryPoint& p : curve.points) nearest = std::min(nearest, std::abs(p.x - Omega));
    }
    return nearest;
  };
  EXPECT_LT(near(BoundaryKind::minus_one, 2), 0.05);  // 2 omega_1
  EXPECT_LT(near(BoundaryKind::minus_one, 2 * std::sqrt(3)), 0.1);  // 2 omega_2
  EXPECT_LT(near(BoundaryKind::complex, 1 + std::sqrt(3)), 0.1);  // omega_1 + omega_2
  EXPECT_LT(near(BoundaryKind::plus_one, 1), 0.1);  // 2 omega_1/2
}

void expect_no_wrong_cell(const MapSystemAt& at, const std::vector<double>& x, const std::vector<double>& y) {
  MapOptions options;
  options.evaluate_all = 0;
  const StabilityMap quick = stability_map(at, x, y, options);
  std::size_t wrong = 0, interpolated = 0, unstable = 0;
  for (std::size_t j = 0; j < y.size(); ++j) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Stability expected = stability_at(at, x[i], y[j]);
      wrong += quick.at(i, j).verdict != expected.verdict;
      unstable += expected.verdict == Verdict::unstable;
      if (quick.at(i, j).source == MapSource::interpolated) {
        ++interpolated;
      } else {
        EXPECT_EQ(quick.at(i, j).growth_rate, expected.growth_rate);
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(unstable, 50u);
  EXPECT_GT(interpolated, x.size() * y.size() / 20);
}

TEST(StabilityMap, QuadtreeHasNoWrongCellForOneOscillator) {
  expect_no_wrong_cell(speed_and_swing(0.02), spaced(0.6, 2.6, 193), spaced(0, 0.9, 129));
}

TEST(StabilityMap, QuadtreeHasNoWrongCellForCoupledOscillators) {
  expect_no_wrong_cell(coupled_map(0.1), spaced(1.5, 4, 97), spaced(0, 0.5, 65));
}

TEST(StabilityMap, GridsOfSeveralModesAloneAreComputedAtEveryPoint) {
  MapOptions options;
  options.evaluate_all = 20;
  options.evaluate_all_alone = 2000;
  const std::vector<double> x = spaced(1.5, 4, 49), y = spaced(0, 0.5, 33);
  const StabilityMap with_curves = stability_map(coupled_map(0.1), x, y, options);
  options.boundaries = false;
  const StabilityMap alone = stability_map(coupled_map(0.1), x, y, options);
  const auto interpolated = [](const StabilityMap& map) {
    return std::ranges::count_if(map.points, [](const MapPoint& p) { return p.source == MapSource::interpolated; });
  };
  EXPECT_GT(interpolated(with_curves), 0);
  EXPECT_EQ(interpolated(alone), 0);
  for (std::size_t p = 0; p < alone.points.size(); ++p)
    ASSERT_EQ(alone.points[p].verdict, with_curves.points[p].verdict) << p;
  options.evaluate_all_alone = 1000;
  EXPECT_GT(interpolated(stability_map(coupled_map(0.1), x, y, options)), 0);
}

// Places where a scan of one row sees the verdict change.
std::vector<double> changes_by_scan(const MapSystemAt& at, double from, double to, double y, int n) {
  std::vector<double> places;
  bool last = false;
  for (int k = 0; k <= n; ++k) {
    const double x = from + (to - from) * k / n;
    const bool now = stability_at(at, x, y).verdict == Verdict::unstable;
    if (k > 0 && now != last) places.push_back(x);
    last = now;
  }
  return places;
}

TEST(StabilityMap, TonguesThinnerThanTheGridAreFound) {
  // Orders 1 to 4 of 2 omega/k; at swing 0.3 the third is 2e-3 wide and the grid's lines are 0.1 apart.
  const MapSystemAt at = speed_and_swing(1e-4);
  const std::vector<double> x = spaced(0.5, 2.5, 21), y = {0.1, 0.3};
  MapOptions options;
  options.sag = 0.05;
  const StabilityMap map = stability_map(at, x, y, options);
  constexpr int n = 2500;
  const double step = (x.back() - x.front()) / n;
  for (const double row : y) {
    std::vector<double> found;
    for (const BoundaryCurve& curve : map.boundaries) {
      for (const BoundaryPoint& p : curve.points) {
        if (p.along_x && p.y == row) found.push_back(p.x);
      }
    }
    const std::vector<double> seen = changes_by_scan(at, x.front(), x.back(), row, n);
    EXPECT_GE(seen.size(), 4u);
    for (const double place : seen) {
      EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                              [&](double f) { return f <= place + 1e-9 && f >= place - step - 1e-9; }))
          << "row " << row << ", " << place;
    }
    for (const double f : found) {
      const Verdict before = stability_at(at, f - 1e-9, row).verdict, after = stability_at(at, f + 1e-9, row).verdict;
      EXPECT_TRUE((before == Verdict::stable && after == Verdict::unstable) ||
                  (before == Verdict::unstable && after == Verdict::stable))
          << "row " << row << ", " << f;
    }
  }
}

TEST(StabilityMap, BoundaryOfAPrincipalTongueIsTheKnownOne) {
  const StabilityMap map = stability_map(speed_and_swing(0.1), spaced(1.5, 3, 16), {0.3, 0.4, 0.5});
  std::vector<double> ends;
  for (const BoundaryCurve& curve : map.boundaries) {
    for (const BoundaryPoint& p : curve.points) {
      if (p.along_x && p.y == 0.4) ends.push_back(p.x);
    }
  }
  std::sort(ends.begin(), ends.end());
  ASSERT_EQ(ends.size(), 2u);
  // By Taylor series with 30 digits.
  EXPECT_NEAR(ends[0], 2.03252467198976858, 1e-10 * ends[0]);
  EXPECT_NEAR(ends[1], 2.33736800003823030, 1e-10 * ends[1]);
}

TEST(StabilityMap, SameBitsInWhateverOrderAndThreadTheWorkIsDone) {
  const std::vector<double> x = spaced(1.8, 3.8, 7), y = spaced(0, 0.4, 5);
  MapOptions options;
  options.sag = 0.01;
  const StabilityMap plain = stability_map(coupled_map(0.06), x, y, options);
  // As numbers from another process, too.
  options.parts = [](const Parts& parts) {
    const auto part = [&](std::size_t k) {
      parts.compute(k);
      if (k % 3 == 0) parts.take(k, parts.numbers(k));
    };
    std::jthread even([&] {
      for (std::size_t k = 0; k < parts.count; k += 2) part(k);
    });
    for (std::size_t k = parts.count; k-- > 0;) {
      if (k % 2 == 1) part(k);
    }
  };
  const StabilityMap other = stability_map(coupled_map(0.06), x, y, options);
  ASSERT_EQ(plain.points.size(), other.points.size());
  for (std::size_t p = 0; p < plain.points.size(); ++p) {
    EXPECT_EQ(plain.points[p].growth_rate, other.points[p].growth_rate);
    EXPECT_EQ(plain.points[p].verdict, other.points[p].verdict);
  }
  EXPECT_EQ(plain.samples, other.samples);
  ASSERT_EQ(plain.boundaries.size(), other.boundaries.size());
  for (std::size_t c = 0; c < plain.boundaries.size(); ++c) {
    EXPECT_EQ(plain.boundaries[c].kind, other.boundaries[c].kind);
    ASSERT_EQ(plain.boundaries[c].points.size(), other.boundaries[c].points.size());
    for (std::size_t k = 0; k < plain.boundaries[c].points.size(); ++k) {
      EXPECT_EQ(plain.boundaries[c].points[k].x, other.boundaries[c].points[k].x);
      EXPECT_EQ(plain.boundaries[c].points[k].y, other.boundaries[c].points[k].y);
    }
  }
}

// A few edges before all others tell how long the rest takes, and are not computed again.
TEST(StabilityMap, IsTheSameAfterASample) {
  const std::vector<double> x = spaced(1.8, 3.8, 9), y = spaced(0, 0.4, 7);
  MapOptions options;
  options.sag = 0.01;
  const StabilityMap plain = stability_map(coupled_map(0.06), x, y, options);
  std::vector<std::string> kinds;
  double edges = 0;
  options.parts = [&](const Parts& parts) {
    kinds.push_back(parts.kind);
    if (parts.kind == "edge") edges += static_cast<double>(parts.count);
    for (std::size_t k = 0; k < parts.count; ++k) parts.compute(k);
  };
  const StabilityMapSearch search = stability_map_search(coupled_map(0.06), x, y, options);
  const auto left = [&](const char* kind) {
    for (const auto& [name, count] : search.left())
      if (name == kind) return count;
    return -1.0;
  };
  const double first = left("edge");
  search.sample();
  ASSERT_EQ(kinds.size(), 2u);
  EXPECT_EQ(kinds[1], "edge");
  EXPECT_LT(edges, first / 4);
  EXPECT_GT(left("edge"), first);  // what its crossings will take is in it
  search.begin();
  search.finish();
  for (const auto& [kind, count] : search.left()) EXPECT_EQ(count, 0) << kind;
  const StabilityMap sampled = search.result();
  EXPECT_EQ(sampled.samples, plain.samples);
  ASSERT_EQ(sampled.boundaries.size(), plain.boundaries.size());
  for (std::size_t c = 0; c < plain.boundaries.size(); ++c) {
    ASSERT_EQ(sampled.boundaries[c].points.size(), plain.boundaries[c].points.size());
    for (std::size_t k = 0; k < plain.boundaries[c].points.size(); ++k) {
      EXPECT_EQ(sampled.boundaries[c].points[k].x, plain.boundaries[c].points[k].x);
      EXPECT_EQ(sampled.boundaries[c].points[k].y, plain.boundaries[c].points[k].y);
    }
  }
  for (std::size_t p = 0; p < plain.points.size(); ++p)
    EXPECT_EQ(sampled.points[p].growth_rate, plain.points[p].growth_rate);
}

// The same map, from an eighth of the places.
TEST(StabilityMap, OneLineServesAllAlongAnAxisOnWhichTheSystemDoesNotDepend) {
  const std::vector<double> speeds = spaced(0.8, 3.8, 15), others = spaced(0, 1, 10);
  for (const bool along_x : {true, false}) {
    const MapSystemAt at = [&](double x, double y) { return scale_system(coupled(0.06, 0.3), along_x ? x : y); };
    const std::vector<double>&x = along_x ? speeds : others, &y = along_x ? others : speeds;
    MapOptions options;
    const StabilityMap whole = stability_map(at, x, y, options);
    options.varies = {along_x, !along_x};
    const StabilityMap shared = stability_map(at, x, y, options);
    EXPECT_LT(8 * shared.samples, whole.samples);
    ASSERT_EQ(whole.points.size(), shared.points.size());
    for (std::size_t p = 0; p < whole.points.size(); ++p) {
      EXPECT_EQ(whole.points[p].source, shared.points[p].source);
      EXPECT_EQ(whole.points[p].speed, shared.points[p].speed);
      EXPECT_EQ(whole.points[p].growth_rate, shared.points[p].growth_rate);
      EXPECT_EQ(whole.points[p].verdict, shared.points[p].verdict);
    }
    ASSERT_GE(shared.boundaries.size(), 4u);
    ASSERT_EQ(whole.boundaries.size(), shared.boundaries.size());
    for (std::size_t c = 0; c < shared.boundaries.size(); ++c) {
      const BoundaryCurve &full = whole.boundaries[c], &curve = shared.boundaries[c];
      EXPECT_EQ(full.kind, curve.kind);
      for (const BoundaryPoint& p : curve.points)
        EXPECT_NEAR(along_x ? p.x : p.y, along_x ? full.points[0].x : full.points[0].y, 1e-9);
      // From one side of the map to the other.
      EXPECT_EQ(std::abs(along_x ? curve.points.front().y - curve.points.back().y
                                 : curve.points.front().x - curve.points.back().x),
                1);
    }
  }
}

TEST(StabilityMap, PlacesWithoutASystemAreMarkedAndTheRestIsAsWithoutThem) {
  const MapSystemAt whole = speed_and_swing(0.05);
  const MapSystemAt cut = [&](double x, double y) { return x + y > 2.6 ? std::optional<ScaledSystem>() : whole(x, y); };
  const std::vector<double> x = spaced(1.5, 2.8, 27), y = spaced(0.1, 0.5, 9);
  const StabilityMap a = stability_map(whole, x, y), b = stability_map(cut, x, y);
  for (std::size_t j = 0; j < y.size(); ++j) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (x[i] + y[j] > 2.6) {
        EXPECT_EQ(b.at(i, j).source, MapSource::missing);
      } else {
        EXPECT_EQ(b.at(i, j).source, MapSource::evaluated);
        EXPECT_EQ(b.at(i, j).growth_rate, a.at(i, j).growth_rate);
      }
    }
  }
  EXPECT_FALSE(b.boundaries.empty());
  for (const BoundaryCurve& curve : b.boundaries) {
    for (const BoundaryPoint& p : curve.points) EXPECT_LE(p.x + p.y, 2.6 * (1 + 4 * eps));
  }
}

TEST(StabilityMap, CurvesAreRefinedUntilTheirChordsAreStraight) {
  const StabilityMap map = stability_map(speed_and_swing(0.1), spaced(1.5, 3, 4), spaced(0.05, 0.6, 3));
  ASSERT_EQ(map.boundaries.size(), 1u);
  const std::vector<BoundaryPoint>& p = map.boundaries[0].points;
  EXPECT_GT(p.size(), 20u);
  // The tip: least swing that is unstable, 2 c sqrt(1.2) to first order of the damping c.
  const auto tip = std::min_element(p.begin(), p.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  EXPECT_NEAR(tip->y, 2 * 0.1 * std::sqrt(1.2), 0.01);
}

TEST(StabilityMap, TongueTipsAreLocatedToASmallPartOfACell) {
  // Least swing that a tongue of the damped equation reaches, by Hill's determinant at half-integer or integer
  // harmonics (continued fraction), least over Omega.
  struct Tip {
    double Omega, swing;
  };
  constexpr std::array<Tip, 3> tips = {{{0.717225405545, 0.57930516576495},
                                        {1.088738627121, 0.32397728120212643},
                                        {2.190753312683, 0.04381757653589144}}};
  const std::vector<double> swing = spaced(0, 0.9, 10);
  const StabilityMap map = stability_map(speed_and_swing(0.02), spaced(0.6, 2.6, 21), swing);
  ASSERT_EQ(map.boundaries.size(), tips.size());
  for (const Tip& tip : tips) {
    double nearest = HUGE_VAL, lowest = 0;
    for (const BoundaryCurve& curve : map.boundaries) {
      const auto low = std::ranges::min_element(curve.points, {}, &BoundaryPoint::y);
      if (std::abs(low->x - tip.Omega) >= nearest) continue;
      nearest = std::abs(low->x - tip.Omega);
      lowest = low->y;
    }
    const double cell = swing[1] - swing[0];
    EXPECT_GE(lowest, tip.swing - 1e-10) << tip.Omega;
    EXPECT_LE(lowest, tip.swing + cell / 400) << tip.Omega;
    EXPECT_LE(nearest, 5e-3) << tip.Omega;
  }
}

TEST(StabilityMap, AThinGapTakesNoMorePointsThanItsCurvesNeed) {
  // x'' + (a + 2 q cos 2t) x = 0: between a_0 and b_1 stable, 7e-7 wide at q = 25.
  const MapSystemAt at = [](double a, double swing) { return scale_system(oscillator(0, a, swing), 2); };
  const std::vector<double> a = spaced(-45, -22, 14), swing = spaced(30, 50, 6);
  const StabilityMap map = stability_map(at, a, swing);
  ASSERT_EQ(map.boundaries.size(), 2u);
  EXPECT_NE(map.boundaries[0].kind, map.boundaries[1].kind);
  for (const BoundaryCurve& curve : map.boundaries) {
    EXPECT_GT(curve.points.size(), 10u);
    EXPECT_LT(curve.points.size(), 150u);  // lines of the first mesh cross it 60 times
    EXPECT_NEAR(std::ranges::min_element(curve.points, {}, &BoundaryPoint::y)->y, 30, 1e-9);
    EXPECT_NEAR(std::ranges::max_element(curve.points, {}, &BoundaryPoint::y)->y, 50, 1e-9);
  }
}

TEST(StabilityMap, RefusesAxesThatDoNotAscend) {
  const MapSystemAt at = speed_and_swing(0.1);
  EXPECT_THROW((void)stability_map(at, {1, 1}, {0, 1}), std::invalid_argument);
  EXPECT_THROW((void)stability_map(at, {2, 1}, {0, 1}), std::invalid_argument);
  EXPECT_THROW((void)stability_map(at, {1}, {0, 1}), std::invalid_argument);
  EXPECT_THROW((void)stability_map(at, {1, 2}, {0, NAN}), std::invalid_argument);
  EXPECT_THROW((void)stability_map(at, {1, 2}, {}), std::invalid_argument);
}

TEST(StabilityMap, PointsBetweenCrossingsLieOnTheTongueInOrder) {
  const StabilityMap map = stability_map(speed_and_swing(0.1), spaced(1.5, 3, 4), spaced(0.05, 0.6, 3));
  ASSERT_EQ(map.boundaries.size(), 1u);
  const std::vector<BoundaryPoint>& p = map.boundaries[0].points;
  int between = 0;
  const auto of_grid = [](double v, double from, double step) {
    const double k = 32 * (v - from) / step;  // places of the mesh that the grid begins with
    return std::abs(k - std::round(k)) < 1e-9;
  };
  for (std::size_t k = 0; k < p.size(); ++k) {
    between += p[k].along_x ? !of_grid(p[k].y, 0.05, 0.275) : !of_grid(p[k].x, 1.5, 0.5);
    const double growth = analyse_stability(oscillator(0.1, 1.2, p[k].y), p[k].x).growth_rate;
    EXPECT_NEAR(growth, 0, 1e-8) << p[k].x << ", " << p[k].y;
    if (k == 0 || k + 1 == p.size()) continue;
    const double ux = (p[k].x - p[k - 1].x) / 1.5, uy = (p[k].y - p[k - 1].y) / 0.55;
    const double vx = (p[k + 1].x - p[k].x) / 1.5, vy = (p[k + 1].y - p[k].y) / 0.55;
    EXPECT_GT(ux * vx + uy * vy, 0.5 * std::hypot(ux, uy) * std::hypot(vx, vy)) << k;
  }
  EXPECT_GT(between, 5);
}

TEST(BoundaryCurve, AChordIsCoarseWhereTheCurveTurnsAlongIt) {
  std::vector<BoundaryPoint> circle;
  for (int k = 0; k <= 12; ++k)
    circle.push_back({std::cos(k * std::numbers::pi / 6), std::sin(k * std::numbers::pi / 6), 0, true});
  // An arc of 30 degrees of the unit circle leaves its chord by 1 - cos 15 degrees = 0.034.
  EXPECT_EQ(coarse_chords(circle, true, 0.030), std::vector<bool>(12, true));
  EXPECT_EQ(coarse_chords(circle, true, 0.037), std::vector<bool>(12, false));
  EXPECT_EQ(coarse_chords({{0, 0, 0, true}, {1, 0, 0, true}, {1.1, 0.1, 0, true}, {1.2, 0.2, 0, true}}, false, 0.05),
            (std::vector<bool>{true, false, false}));
}

TEST(BoundaryCurve, LinksBecomeChainsThatPassEachOnce) {
  // 0 - 1 - 2 open, 3 - 4 - 5 - 3 closed.
  const std::vector<CurveLink> links = {{{4, 3}, 10}, {{1, 2}, 11}, {{4, 5}, 12}, {{1, 0}, 13}, {{5, 3}, 14}};
  const std::vector<CurveChain> result = chains(6, links);
  ASSERT_EQ(result.size(), 2u);
  EXPECT_EQ(result[0].points, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(result[0].cells, (std::vector<std::size_t>{13, 11}));
  EXPECT_FALSE(result[0].closed);
  EXPECT_EQ(result[1].points, (std::vector<std::size_t>{3, 4, 5, 3}));
  EXPECT_EQ(result[1].cells, (std::vector<std::size_t>{10, 12, 14}));
  EXPECT_TRUE(result[1].closed);
}

TEST(BoundaryCurve, ASaddleIsJoinedByWhatItsCentreIs) {
  using Pairs = std::vector<std::array<std::size_t, 2>>;
  EXPECT_EQ(joined_in_cell(2, false, false), (Pairs{{0, 1}}));
  EXPECT_EQ(joined_in_cell(2, false, true), (Pairs{{1, 0}}));
  EXPECT_EQ(joined_in_cell(4, false, true), (Pairs{{3, 0}, {1, 2}}));  // stable corners cut off
  EXPECT_EQ(joined_in_cell(4, false, false), (Pairs{{0, 1}, {2, 3}}));  // unstable sides cut off
}

}  // namespace
