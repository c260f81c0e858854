// Undamped systems: where exponents are no mirror images there is no gap, and where a lock lasts there is none either.
#include "hb/engine/boundaries/mirror_images.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/undamped_locks.hpp"
#include "lib/constants.hpp"

namespace {

using namespace hb;

// Frequencies 1 and 2, each modulated; mode 2 pushes mode 1 back `back` times as much as it is pushed.
HillSystem two_modes(double back, double damping = 0, double modulation = 0.4) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(2, 2);
  system.damping = damping * Eigen::MatrixXd::Identity(2, 2);
  system.stiffness[0] = FourierSeries(4, 2);
  system.stiffness[0].c.col(0) << 1, 0.2, 0.2 * back, 4;
  system.stiffness[0].c.col(1) << 0.5 * modulation, std::complex(0.1, -0.05), std::complex(0.1, -0.05) * back,
      1.5 * modulation;
  system.stiffness[0].c.col(2) << 0.1 * modulation, std::complex(0.05, 0.1), std::complex(0.05, 0.02) * back,
      std::complex(0.0, 0.3) * modulation;
  return system;
}

StabilitySample sample_of(const HillSystem& system, double speed) {
  return stability_sample(scale_system(system, speed), speed, {.tolerance = 1e-11});
}

TEST(MirrorImages, AreMissingWhereOneModeGrowsAsTheOtherDecays) {
  const HillSystem circulatory = two_modes(-0.6);
  const StabilitySample grows = sample_of(circulatory, 1.37);
  ASSERT_TRUE(is_unstable(grows));
  double sum = 0;
  for (const Exponent& e : grows.stability.exponents) sum += e.value.real();
  EXPECT_NEAR(sum, 0, 1e-10);  // Liouville
  EXPECT_TRUE(lacks_an_image(grows));
  StabilitySample partial = grows;
  partial.stability.exponents.pop_back();
  EXPECT_FALSE(lacks_an_image(partial));
  // A lock of a symmetric system: s and -s.
  HillSystem symmetric = two_modes(1);
  symmetric.stiffness[0].c(2, 2) = symmetric.stiffness[0].c(1, 2);
  bool unstable = false;
  for (double speed = 1.9; speed < 2.1; speed += 0.02) {
    const StabilitySample sample = sample_of(symmetric, speed);
    EXPECT_FALSE(lacks_an_image(sample)) << speed;
    unstable = unstable || is_unstable(sample);
  }
  EXPECT_TRUE(unstable);
}

TEST(MirrorImages, ExcludeGapsWithoutDampingOnly) {
  const auto excluded = [](const HillSystem& system) {
    return excludes_gaps([&](double x) { return scale_system(system, x); }, sample_of(system, 1.37),
                         sample_of(system, 1.43));
  };
  EXPECT_TRUE(excluded(two_modes(-0.6)));
  EXPECT_FALSE(excluded(two_modes(-0.6, 1e-9)));
}

// Places between which 21 systems were asked for are settled by three, and those between agree.
TEST(MirrorImages, SettleAnIntervalByThreeSystems) {
  const HillSystem system = two_modes(-0.6);
  int asked = 0;
  const SystemAt at = [&](double x) {
    ++asked;
    return scale_system(system, x);
  };
  for (double from = 0.5; from < 1.5; from += 0.1) {
    const StabilitySample a = sample_of(system, from), b = sample_of(system, from + 0.1);
    if (!is_unstable(a) || !is_unstable(b)) continue;
    asked = 0;
    const SearchedInterval found = search_interval(at, a, b, nullptr, nullptr);
    EXPECT_EQ(asked, 3);
    EXPECT_TRUE(found.boundaries.empty() && found.not_excluded.empty());
    for (double x = from; x < from + 0.1; x += 0.005) EXPECT_TRUE(is_unstable(sample_of(system, x))) << x;
  }
  EXPECT_GT(asked, 0);
}

// Wherever a lock is said to last from place to place, it does on a fine grid.
TEST(UndampedLocks, LastOnlyWhereNoGapIs) {
  int lasting = 0, unstable = 0;
  for (const double modulation : {0.4, 0.9, 1.6, 2.5}) {
    HillSystem system = two_modes(1, 0, modulation);
    system.stiffness[0].c(2, 2) = system.stiffness[0].c(1, 2);
    const SystemAt at = [&](double x) { return scale_system(system, x); };
    for (const int intervals : {40, 130}) {
      Places places;
      for (int k = 0; k <= intervals; ++k) {
        const double speed = 0.4 + 2.2 * k / intervals;
        places.emplace(speed, place_of(sample_of(system, speed), at));
      }
      for (auto p = places.begin(), q = std::next(p); q != places.end(); ++p, ++q) {
        unstable += p->second.unstable && q->second.unstable;
        const std::optional<double> doubtful = doubtful_while_locked(places, p->second, q->second);
        if (!doubtful || !std::isnan(*doubtful)) continue;
        ++lasting;
        constexpr int fine = 16;
        for (int k = 0; k <= fine; ++k) {
          const double x = p->first + (q->first - p->first) * k / fine;
          EXPECT_TRUE(is_unstable(sample_of(system, x))) << modulation << " " << x;
        }
      }
    }
  }
  EXPECT_GT(lasting, unstable / 4);
}

TEST(UndampedLocks, AreNotToldOfWithDamping) {
  HillSystem system = two_modes(1, 1e-6);
  system.stiffness[0].c(2, 2) = system.stiffness[0].c(1, 2);
  const SystemAt at = [&](double x) { return scale_system(system, x); };
  Places places;
  for (const double speed : {1.97, 1.98, 1.99, 2.0, 2.01, 2.02})
    places.emplace(speed, place_of(sample_of(system, speed), at));
  EXPECT_TRUE(places.at(1.99).unstable && places.at(2.0).unstable);
  EXPECT_FALSE(doubtful_while_locked(places, places.at(1.99), places.at(2.0)));
}

}  // namespace
