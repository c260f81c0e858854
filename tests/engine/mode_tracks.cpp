// Which exponent belongs to which mode along a parameter.
#include "hb/engine/boundaries/mode_tracks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace hb;

constexpr double Omega = 10;

double folded(double x) { return x - Omega * std::round(x / Omega); }

// Exponents -damping +- i frequency, folded, each mode named by its rank in frequency as the solvers do.
Stability made(std::vector<double> frequencies, double damping = 0.1) {
  Stability s;
  std::ranges::sort(frequencies);
  for (std::size_t m = 0; m < frequencies.size(); ++m)
    for (const double sign : {1.0, -1.0})
      s.exponents.push_back({.value = {-damping, folded(sign * frequencies[m])},
                             .error = 1e-12,
                             .mode = static_cast<int>(m),
                             .frequency = frequencies[m]});
  return s;
}

TEST(ModeTracks, NamesComeFromWhatIsExpectedUnfolded) {
  const std::vector<ModeState> found =
      modes_by_continuity(made({23.1, 4.2}), Omega, {{4, -0.1, -0.1}, {23, -0.1, -0.1}});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].frequency, 4.2, 1e-12);
  EXPECT_NEAR(found[1].frequency, 23.1, 1e-12);
  EXPECT_NEAR(found[0].damping(), 0.1, 1e-15);
}

TEST(ModeTracks, CrossingsStayCrossings) {
  // Two lines that cross at x = 5: 3 + x and 13 - x, modulo Omega apart all the while.
  std::vector<Stability> along;
  std::vector<TrackedPlace> places;
  constexpr int n = 21;
  for (int k = 0; k < n; ++k) along.push_back(made({3 + 0.5 * k, 13 - 0.5 * k}));
  for (int k = 0; k < n; ++k) places.push_back({0.5 * k, Omega, &along[static_cast<std::size_t>(k)]});
  const auto tracks = track_modes(places, 2);
  ASSERT_EQ(tracks.size(), static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    EXPECT_NEAR(tracks[static_cast<std::size_t>(k)][0].frequency, 3 + 0.5 * k, 1e-9) << k;
    EXPECT_NEAR(tracks[static_cast<std::size_t>(k)][1].frequency, 13 - 0.5 * k, 1e-9) << k;
  }
}

TEST(ModeTracks, PlacesWithoutAnswerAreGapsThatTracksGoOnBeyond) {
  const std::vector<Stability> along = {made({3}), made({3.4}), made({3.8})};
  const auto tracks = track_modes({{0, Omega, &along[0]}, {1, Omega, nullptr}, {2, Omega, &along[2]}}, 1);
  EXPECT_NEAR(tracks[0][0].frequency, 3, 1e-12);
  EXPECT_TRUE(std::isnan(tracks[1][0].frequency));
  EXPECT_NEAR(tracks[2][0].frequency, 3.8, 1e-12);
}

// Mode 1 is locked to an order line of the speed, which rises; its two real multipliers are named after different
// modes, as are the conjugates of mode 2. What belongs together is told by the mean growth, which stays.
TEST(ModeTracks, ALockedModeFollowsItsOrderLineWhateverItsExponentsAreNamed) {
  constexpr int n = 12;
  std::vector<Stability> along(n);
  std::vector<TrackedPlace> places;
  for (int k = 0; k < n; ++k) {
    const double speed = 10 + 0.2 * k, split = 0.3 * k;
    const auto fold = [&](double x) { return x - speed * std::round(x / speed); };
    const bool wrong_names = k >= 4;
    std::vector<Exponent>& all = along[static_cast<std::size_t>(k)].exponents;
    all.push_back({.value = {-0.1 + split, 0}, .error = 1e-12, .mode = 0, .frequency = 3 * speed});
    all.push_back({.value = {-0.1 - split, 0},
                   .error = 1e-12,
                   .mode = wrong_names ? 1 : 0,
                   .frequency = (wrong_names ? 7 : 3) * speed});
    for (const double sign : {1.0, -1.0})
      all.push_back({.value = {-2, fold(sign * 71.3)},
                     .error = 1e-12,
                     .mode = wrong_names && sign < 0 ? 0 : 1,
                     .frequency = wrong_names && sign < 0 ? std::abs(71.3 - 4 * speed) : 71.3});
    places.push_back({speed, speed, &along[static_cast<std::size_t>(k)]});
  }
  const auto tracks = track_modes(places, 2);
  for (int k = 0; k < n; ++k) {
    const ModeState &locked = tracks[static_cast<std::size_t>(k)][0], &free = tracks[static_cast<std::size_t>(k)][1];
    EXPECT_NEAR(locked.frequency, 3 * places[static_cast<std::size_t>(k)].speed, 1e-9) << k;
    EXPECT_NEAR(locked.damping(), 0.1, 1e-12) << k;
    EXPECT_TRUE(locked.locked) << k;
    EXPECT_NEAR(free.frequency, 71.3, 1e-9) << k;
    EXPECT_NEAR(free.growth, -2, 1e-12) << k;
    EXPECT_FALSE(free.locked) << k;
  }
}

}  // namespace
