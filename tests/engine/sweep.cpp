// Unstable bands, resonance peaks and tracked modes against closed forms and root searches of the test's own.
#include "hb/engine/boundaries/sweep.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <tuple>

#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/boundaries/mode_tracks.hpp"
#include "hb/engine/boundaries/part.hpp"
#include "hb/engine/steady/response_peak.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/rod/rod.hpp"
#include "tests/support/six_link.hpp"

namespace {

using namespace hb;

HillSystem oscillator(double damping, double stiffness, double modulation) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Ones(1, 1);
  system.damping = Eigen::MatrixXd::Constant(1, 1, damping);
  system.stiffness[0] = FourierSeries(1, 1);
  system.stiffness[0].c(0, 0) = stiffness;
  system.stiffness[0].c(0, 1) = modulation / 2;
  system.load[0] = FourierSeries(1, 1);
  system.load[0].c(0, 1) = 0.5;
  return system;
}

// Frequencies 1 and 2, coupled by `coupling` cos(Omega t) in both rows (symmetric) or with opposite signs.
HillSystem two_oscillators(double damping, double coupling, double sign = 1) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(2, 2);
  system.damping = damping * Eigen::MatrixXd::Identity(2, 2);
  system.stiffness[0] = FourierSeries(4, 1);
  system.stiffness[0].c.col(0) << 1, 0, 0, 4;
  system.stiffness[0].c.col(1) << 0, 0.5 * coupling, 0.5 * sign * coupling, 0;
  return system;
}

struct Sweep {
  std::vector<StabilitySample> samples;
  std::vector<StabilityBoundary> boundaries;
  std::vector<UnstableBand> bands;
  std::vector<std::array<double, 2>> not_excluded;
  std::vector<std::vector<ModeState>> modes;
};

SystemAt along_speed(const HillSystem& system) {
  return [&system](double x) { return scale_system(system, x); };
}

// As `hb sweep` does it: a grid, what lies between its points, bands.
Sweep sweep(const HillSystem& system, double from, double to, int intervals) {
  Sweep result;
  const SystemAt at = along_speed(system);
  SweepOptions options;
  options.stability.tolerance = 1e-11;
  std::vector<StabilitySample> grid;
  for (int k = 0; k <= intervals; ++k)
    grid.push_back(*stability_sample(at, from + (to - from) * k / intervals, options.stability));
  std::vector<TrackedPlace> places;
  for (const StabilitySample& sample : grid) places.push_back({sample.x, sample.speed, &sample.stability});
  result.modes = track_modes(places, static_cast<int>(system.num_modes()));
  for (std::size_t k = 0; k < grid.size(); ++k) {
    result.samples.push_back(grid[k]);
    if (k + 1 == grid.size()) break;
    const SearchedInterval found = search_interval(at, grid[k], grid[k + 1], k > 0 ? &grid[k - 1] : nullptr,
                                                   k + 2 < grid.size() ? &grid[k + 2] : nullptr, options);
    result.samples.insert(result.samples.end(), found.samples.begin(), found.samples.end());
    result.boundaries.insert(result.boundaries.end(), found.boundaries.begin(), found.boundaries.end());
    result.not_excluded.insert(result.not_excluded.end(), found.not_excluded.begin(), found.not_excluded.end());
  }
  std::vector<const StabilitySample*> pointers;
  for (const StabilitySample& sample : result.samples) pointers.push_back(&sample);
  result.bands = unstable_bands(pointers, result.boundaries);
  return result;
}

// Where the growth rate passes zero, by bisection on its sign.
double bisected(const HillSystem& system, double low, double high) {
  const auto unstable = [&](double x) { return analyse_stability(system, x).growth_rate > 0; };
  const bool above = unstable(high);
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (unstable(middle) == above ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

TEST(Sweep, LocatesBothEndsOfMathieusTongue) {
  // x'' + 0.1 x' + (1.2 + 0.4 cos Omega t) x: ends known to eleven digits.
  for (const int intervals : {369, 40, 7, 2}) {
    const Sweep found = sweep(oscillator(0.1, 1.2, 0.4), 1.5, 2.6, intervals);
    ASSERT_EQ(found.bands.size(), 1u) << intervals;
    EXPECT_NEAR(found.bands[0].from, 2.0325246720, 1e-10 * 2);
    EXPECT_NEAR(found.bands[0].to, 2.3373680000, 1e-10 * 2.4);
    EXPECT_EQ(found.bands[0].kind_from, BoundaryKind::minus_one);
    EXPECT_EQ(found.bands[0].kind_to, BoundaryKind::minus_one);
    EXPECT_FALSE(found.bands[0].open_from || found.bands[0].open_to);
    for (const StabilityBoundary& boundary : found.boundaries) EXPECT_TRUE(boundary.converged);
  }
}

TEST(Sweep, BoundariesAgreeWithBisectionFarFromWhereTheSearchBegan) {
  const HillSystem system = oscillator(0.03, 1, 0.9);
  const Sweep found = sweep(system, 0.6, 3, 97);
  ASSERT_GE(found.bands.size(), 2u);
  for (const StabilityBoundary& boundary : found.boundaries) {
    const double reference = bisected(system, boundary.x - 0.003, boundary.x + 0.004);
    EXPECT_NEAR(boundary.x, reference, 1e-10 * reference);
  }
}

TEST(Sweep, FindsABandFarNarrowerThanTheGrid) {
  // Width of the principal tongue by averaging: Omega = 2 +- sqrt((a/2)^2 - (2 c)^2 ...)/..., here some 1e-5.
  const double c = 1e-5, a = 4.2e-5;
  const HillSystem system = oscillator(c, 1, a);
  const Sweep found = sweep(system, 1.03, 2.97, 10);
  ASSERT_EQ(found.bands.size(), 1u);
  // x = u cos(Omega t/2) + v sin(Omega t/2): half width of the detuning of Omega/2 is sqrt((a/4)^2 - (c/2)^2).
  const double half_width = 2 * std::sqrt(a * a / 16 - c * c / 4);
  EXPECT_NEAR(found.bands[0].to - found.bands[0].from, 2 * half_width, 1e-3 * half_width);
  EXPECT_NEAR(0.5 * (found.bands[0].from + found.bands[0].to), 2, 1e-8);
}

TEST(Sweep, FindsNoBandWhereDampingWins) {
  const double c = 1e-5;
  EXPECT_TRUE(sweep(oscillator(c, 1, 1.9 * c), 1.03, 2.97, 10).bands.empty());
}

TEST(Sweep, FindsTheSumResonanceOfTwoOscillators) {
  const Sweep found = sweep(two_oscillators(0.002, 0.02), 2.4, 3.5, 4);
  ASSERT_EQ(found.bands.size(), 1u);
  EXPECT_EQ(found.bands[0].kind_from, BoundaryKind::complex);
  EXPECT_LT(found.bands[0].from, 3);
  EXPECT_GT(found.bands[0].to, 3);
  const double reference = bisected(two_oscillators(0.002, 0.02), 2.99, 3);
  EXPECT_NEAR(found.bands[0].from, reference, 1e-10 * reference);
}

TEST(Sweep, FindsTheDifferenceResonanceOfOscillatorsThatFeedEachOther) {
  const Sweep found = sweep(two_oscillators(0.002, 0.02, -1), 0.72, 1.45, 4);
  ASSERT_GE(found.bands.size(), 1u);
  EXPECT_LT(found.bands[0].from, 1);
  EXPECT_GT(found.bands[0].to, 1);
}

// Bands were looked for along tracked frequencies, which continuity over coarse steps unfolds by a wrong order: whether
// a band was found depended on where the range began.
TEST(Sweep, BandsDoNotDependOnWhereTheRangeBeginsNorOnTheStep) {
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(2, 2);
  system.damping = Eigen::Vector2d(0.0006907509677922141, 0.0007469844861333518).asDiagonal();
  system.stiffness[0] = FourierSeries(4, 1);
  system.stiffness[0].c.col(0) << 1.8579582395656333, 0, 0, 5.429150249451666;
  using cplx = std::complex<double>;
  const double off = -0.4279480856181529;
  system.stiffness[0].c.col(1) << cplx(-0.0639570349496675, -0.014458361655203575), off, off,
      cplx(0.9857699107816944, 0.007156608197201);
  system.stiffness[0].c.col(1) /= 2;
  // By a grid of 0.0005 and bisection.
  const std::vector<std::array<double, 2>> known = {{1.1529, 1.1537}, {1.2270, 1.2285}, {1.3649, 1.3710},
                                                    {1.5432, 1.5465}, {1.8365, 1.8453}, {2.3040, 2.3337},
                                                    {2.6962, 2.7431}, {3.5601, 3.7988}, {4.4534, 4.8742}};
  for (const double from : {0.35, 1.0, 1.1})
    for (const int intervals : {5, 12, 77, 400}) {
      const Sweep found = sweep(system, from, 8, intervals);
      ASSERT_EQ(found.bands.size(), known.size()) << from << " " << intervals;
      for (std::size_t k = 0; k < known.size(); ++k) {
        EXPECT_NEAR(found.bands[k].from, known[k][0], 1e-4);
        EXPECT_NEAR(found.bands[k].to, known[k][1], 1e-4);
      }
      EXPECT_TRUE(found.not_excluded.empty());
    }
}

// Stable gaps inside bands, narrower than the step, were missed.
TEST(Sweep, FindsTheGapsBetweenTheBandsOfTheSixLinkMechanismAtAnyStep) {
  const Linkage linkage = six_link::linkage({.J = 45});
  const LinkageCoefficients coefficients = linkage_coefficients(linkage);
  const HillSystem system = ritz_system(*body_at(linkage, coefficients.links[0]), coefficients.rods[0], 5);
  constexpr double rpm = std::numbers::pi / 30;
  for (const int intervals : {1, 3, 8}) {
    const Sweep found = sweep(system, 1500 * rpm, 3500 * rpm, intervals);
    ASSERT_EQ(found.bands.size(), 3u) << intervals;
    EXPECT_NEAR(found.bands[0].to / rpm, 1895.07, 0.01);
    EXPECT_EQ(found.bands[0].kind_to, BoundaryKind::minus_one);
    EXPECT_NEAR(found.bands[1].from / rpm, 1909.98, 0.01);
    EXPECT_EQ(found.bands[1].kind_from, BoundaryKind::plus_one);
    EXPECT_NEAR(found.bands[1].to, 280.872514, 1e-5);
    EXPECT_NEAR(found.bands[2].from, 281.036195, 1e-5);
  }
}

// Coupled one way: the second mode alone has tongues, where the two frequencies meet nothing grows.
TEST(Sweep, ExponentsThatMeetWithoutExcitingEachOtherMakeNoBand) {
  HillSystem system = two_oscillators(0.002, 0.3);
  system.stiffness[0].c(2, 1) = 0;
  const Sweep found = sweep(system, 0.7, 3.6, 9);
  EXPECT_TRUE(found.bands.empty());
  EXPECT_TRUE(found.not_excluded.empty());
}

// A gap was settled as none because two modes on one side of the axis do not excite each other: they share their
// damping where they meet, w2 - w1 = Omega, and one that grows by itself is quenched there by the other.
TEST(Sweep, FindsTheGapWhereAGrowingModeMeetsADampedOne) {
  HillSystem system = two_oscillators(0, 0.05);
  system.damping.diagonal() << -1e-4, 4e-4;
  ASSERT_EQ(analyse_stability(system, 1).verdict, Verdict::stable);
  ASSERT_EQ(analyse_stability(system, 0.9).verdict, Verdict::unstable);
  ASSERT_EQ(analyse_stability(system, 1.1).verdict, Verdict::unstable);
  for (const int intervals : {2, 3, 7, 20}) {
    const Sweep found = sweep(system, 0.8317, 1.2113, intervals);
    // Two thin bands stand in the gap, where both lock to their conjugates.
    ASSERT_EQ(found.bands.size(), 4u) << intervals;
    EXPECT_NEAR(found.bands[0].to, 0.986820965, 1e-8) << intervals;
    EXPECT_TRUE(found.bands[1].to < 1 && found.bands[2].from > 1) << intervals;
    EXPECT_NEAR(found.bands[3].from, 1.01333527, 1e-8) << intervals;
  }
}

// A band was settled as none because two modes were taken for each other: a stiffness without symmetry exchanges their
// decays (4.0e-4 and 9.3e-4 for 9.0e-4 and 4.2e-4 of the mean stiffness), which looked like none that had moved.
TEST(Sweep, FindsABandWhereAnUnsymmetricStiffnessExchangesDecays) {
  HillSystem system;
  system.mass = Eigen::Matrix2d{{1.0474749623943538, -0.12552078004576}, {-0.12552078004576, 1.435893686093542}};
  system.damping = Eigen::Vector2d(0.0018797006307694477, 0.001208781171200574).asDiagonal();
  system.stiffness[0] = FourierSeries(4, 4);
  system.stiffness[0].c.col(0) << 11.99457957527957, 0, 0, 4.524855594461176;
  const Eigen::Vector4d cosine(-0.07228911479692783, -0.21530283826632646, 0.13939056329008626, -0.4305272326845575),
      sine(0.04975855183136788, 0.046425983257660876, -0.5950044921688663, -0.1338160266406884);
  system.stiffness[0].c.col(4) = 0.5 * (cosine - std::complex<double>(0, 1) * sine);
  const double from = bisected(system, 1.7, 1.704), to = bisected(system, 1.704, 1.71);
  ASSERT_NEAR(from, 1.701035, 1e-6);
  for (const auto& [low, high, intervals] :
       {std::tuple{1.65, 1.75, 2}, std::tuple{1.69, 1.72, 3}, std::tuple{1.6, 1.8, 8}}) {
    const Sweep found = sweep(system, low, high, intervals);
    ASSERT_EQ(found.bands.size(), 1u) << intervals;
    EXPECT_NEAR(found.bands[0].from, from, 1e-9) << intervals;
    EXPECT_NEAR(found.bands[0].to, to, 1e-9) << intervals;
    EXPECT_TRUE(found.not_excluded.empty()) << intervals;
  }
}

// A single exponent crosses by itself: damping that changes its sign along the parameter, twice within one step.
TEST(Sweep, FindsABandThatASingleExponentMakesByItself) {
  HillSystem system = oscillator(0.01, 1, 0.01);
  const SystemAt at = [&](double x) {
    system.damping(0, 0) = 0.01 * ((x - 0.43) * (x - 0.43) / 0.01 - 1);
    return scale_system(system, 0.77);
  };
  const StabilityOptions options;
  const StabilitySample a = *stability_sample(at, 0.0, options), b = *stability_sample(at, 1.0, options);
  const SearchedInterval found = search_interval(at, a, b, nullptr, nullptr);
  ASSERT_EQ(found.boundaries.size(), 2u);
  EXPECT_NEAR(found.boundaries[0].x, 0.33, 1e-9);
  EXPECT_NEAR(found.boundaries[1].x, 0.53, 1e-9);
}

// Kinds differed between runs that kept their parts and runs that did not: exponents that are not resolved were lost.
TEST(Sweep, AKeptSampleTellsTheSameKind) {
  StabilitySample sample;
  sample.speed = 2;
  sample.stability.growth_rate = 0.5;
  sample.stability.growth_error = 1e-4;
  sample.stability.uncertain = {{{0.5, 1}, 1e-4, 0, 1}, {{-0.6, 1}, 1e-4, 0, 1}};
  sample.mean = {{{-0.1, 1.5}, 0.2}};
  ASSERT_EQ(boundary_kind(sample.stability, sample.speed), BoundaryKind::minus_one);
  PartWriter writer;
  visit_sample(writer, sample);
  PartReader reader(writer.numbers);
  StabilitySample kept;
  visit_sample(reader, kept);
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(boundary_kind(kept.stability, kept.speed), BoundaryKind::minus_one);
  ASSERT_EQ(kept.mean.size(), 1u);
  EXPECT_EQ(kept.mean[0].coupling, 0.2);
}

TEST(Sweep, AModeOfConstantCoefficientsStaysAStraightLine) {
  HillSystem system = two_oscillators(0.05, 0);
  system.stiffness[0].c.col(1).setZero();
  // Through the speeds where the frequencies fold: 2 omega_i/k and omega_i - omega_j = k Omega.
  const Sweep found = sweep(system, 0.1, 5, 400);
  for (const std::vector<ModeState>& modes : found.modes) {
    ASSERT_EQ(modes.size(), 2u);
    const double first = std::sqrt(1 - 0.025 * 0.025), second = std::sqrt(4 - 0.025 * 0.025);
    EXPECT_NEAR(modes[0].frequency, first, 1e-12);
    EXPECT_NEAR(modes[1].frequency, second, 1e-12);
    EXPECT_NEAR(modes[0].growth, -0.025, 1e-13);
  }
}

TEST(Sweep, TrackedFrequenciesRunThroughACrossingWithoutChangingPlaces) {
  // Frequencies cross along x where stiffness, not speed, is swept: omega_1 = x, omega_2 = 2.
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(2, 2);
  system.damping = 0.01 * Eigen::MatrixXd::Identity(2, 2);
  std::vector<Stability> all;
  std::vector<double> x;
  for (int k = 0; k <= 200; ++k) {
    x.push_back(1.5 + 0.0051 * k);
    system.stiffness[0] = FourierSeries(4, 1);
    system.stiffness[0].c.col(0) << x.back() * x.back(), 0, 0, 4;
    system.stiffness[0].c.col(1) << 0.01, 0, 0, 0.01;
    all.push_back(analyse_stability(system, 0.83));
  }
  std::vector<TrackedPlace> places;
  for (std::size_t k = 0; k < x.size(); ++k) places.push_back({x[k], 0.83, &all[k]});
  const auto modes = track_modes(places, 2);
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(modes[k][0].frequency, x[k], 1e-3) << x[k];
    EXPECT_NEAR(modes[k][1].frequency, 2, 1e-3) << x[k];
  }
}

TEST(Sweep, BandsThatReachTheSweepsEndsAreOpen) {
  const Sweep found = sweep(oscillator(0.1, 1.2, 0.4), 2.1, 2.3, 4);
  ASSERT_EQ(found.bands.size(), 1u);
  EXPECT_TRUE(found.bands[0].open_from && found.bands[0].open_to);
  EXPECT_EQ(found.bands[0].from, 2.1);
  EXPECT_EQ(found.bands[0].to, 2.3);
}

// A response that is the same at all angles.
template <class Height>
ResponseAt constant_response(const Height& height) {
  return [height](double x) -> std::optional<FourierSeries> {
    const std::optional<double> f = height(x);
    if (!f) return std::nullopt;
    return FourierSeries(Eigen::MatrixXcd::Constant(1, 1, *f));
  };
}

TEST(ResponsePeak, OfADampedOscillatorIsTheClosedFormToTenDigits) {
  // |x| = 1/sqrt((k - W^2)^2 + b^2 W^2) is largest at W^2 = k - b^2/2.
  for (const double b : {1e-4, 0.01, 0.2, 1.0}) {
    const double k = 1.3;
    const HillSystem system = oscillator(b, k, 0);
    const double expected = std::sqrt(k - b * b / 2);
    const auto value = [&](double W) -> std::optional<FourierSeries> {
      SteadyOptions options;
      options.tolerance = 1e-12;
      return solve_steady_state(system, W, options).q;
    };
    const double reach = std::min(0.3, 20 * b);
    const std::optional<ResponsePeak> peak =
        locate_peak({value, value, value}, expected - 0.7 * reach, expected + 0.1 * reach, expected + reach);
    ASSERT_TRUE(peak);
    EXPECT_TRUE(peak->converged) << b << " " << peak->error;
    EXPECT_NEAR(peak->x, expected, 1e-10 * expected) << b;
    EXPECT_NEAR(peak->value, 1 / (b * std::sqrt(k - b * b / 4)), 1e-10 * peak->value) << b;
  }
}

TEST(ResponsePeak, IsToldFromAPole) {
  // 1/|x - x0| with a background that leans.
  const double x0 = 1.2345678901;
  const ResponseAt value = constant_response([&](double x) { return std::optional(1e-3 / (x - x0) + 0.7 * x); });
  const std::optional<ResponsePeak> pole = locate_peak({value, value, value}, 1.1, 1.2345, 1.4);
  ASSERT_TRUE(pole);
  EXPECT_TRUE(std::isinf(pole->value));
  EXPECT_NEAR(pole->x, x0, 1e-10 * x0);
  EXPECT_LE(pole->error, 1e-10 * x0);
}

// Near a pole the rough values are off by tenths: its place was told to a hundredth of the last step all the same.
TEST(ResponsePeak, APoleIsLocatedByTheFineValues) {
  const double x0 = 0.92899074664;
  const auto height = [&](double x) { return std::optional(1.0 + 0.016 / (x - x0)); };
  const ResponseAt value = constant_response(height),
                   rough =
                       constant_response([&](double x) { return std::optional(*height(x) * (x > x0 ? 1.2 : 0.9)); });
  const std::optional<ResponsePeak> peak = locate_peak({rough, value, value}, 0.9, 0.93, 1);
  ASSERT_TRUE(peak);
  EXPECT_EQ(peak->value, HUGE_VAL);
  EXPECT_LE(std::abs(peak->x - x0), peak->error);
  EXPECT_LT(peak->error, 1e-10);
  EXPECT_TRUE(peak->converged);
}

// Two of them, nearer to each other than a pole has to show from.
TEST(ResponsePeak, OneOfTwoPolesSideBySideIsLocated) {
  const double x0 = 3.1, x1 = x0 + 1.2e-7;
  const ResponseAt value =
      constant_response([&](double x) { return std::optional(1e-4 / (x - x0) + 3e-4 / (x - x1) + 2); });
  const std::optional<ResponsePeak> pole = locate_peak({value, value, value}, 3.0, 3.1001, 3.3);
  ASSERT_TRUE(pole);
  EXPECT_TRUE(std::isinf(pole->value));
  EXPECT_LE(std::min(std::abs(pole->x - x0), std::abs(pole->x - x1)), pole->error);
}

// Two angles that are as high as each other: max |q| = 1 + max(x - x0, -2 (x - x0)) turned over.
TEST(ResponsePeak, WhereAnotherAngleTakesTheLeadIsLocated) {
  const double x0 = 0.7654321;
  const ResponseAt value = [&](double x) -> std::optional<FourierSeries> {
    // q = m + a cos tau: largest at 0, m + a, or at pi, a - m.
    const double rising = 1 + (x - x0), falling = 1 - 2 * (x - x0);
    Eigen::MatrixXcd c(1, 2);
    c << 0.5 * (rising - falling), 0.25 * (rising + falling);
    return FourierSeries(c);
  };
  // Of the two the larger one is least at x0; its inverse is largest.
  const ResponseAt inverse = [&](double x) -> std::optional<FourierSeries> {
    return FourierSeries(Eigen::MatrixXcd(value(x)->c / std::pow(fourier::max_abs(*value(x), 0).value, 2)));
  };
  const std::optional<ResponsePeak> peak = locate_peak({inverse, inverse, inverse}, 0.6, 0.75, 0.9);
  ASSERT_TRUE(peak);
  EXPECT_LE(std::abs(peak->x - x0), peak->error);
  EXPECT_LT(peak->error, 1e-4);
}

// A flat top, whose slope rounding hides near by: narrow intervals there seem to turn anywhere.
TEST(ResponsePeak, WhatRoundingHidesIsNotTakenForTheTop) {
  const double x0 = 325.0891729;
  const auto noise = [](double x, unsigned seed) {
    std::minstd_rand generator(static_cast<unsigned>(std::hash<double>()(x)) ^ (977 * seed));
    generator.discard(10);
    return std::uniform_real_distribution<double>(-1, 1)(generator);
  };
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const auto off = [&](double relative) {
      return constant_response([=](double x) {
        return std::optional(3.5 * (1 - 1e-5 * (x - x0) * (x - x0)) * (1 + relative * noise(x, seed)));
      });
    };
    const ResponseAt rough = off(1e-7), fine = off(1e-14);
    const std::optional<ResponsePeak> peak = locate_peak({rough, fine, fine, 1e-7, 1e-14}, 322.5, 325, 327.5, 5e-14);
    ASSERT_TRUE(peak);
    EXPECT_LE(std::abs(peak->x - x0), peak->error) << seed;
    EXPECT_LT(peak->error, 1e-4) << seed;
  }
}

TEST(ResponsePeak, LiesBetweenTwoPlacesThatAreAsHigh) {
  for (const double w : {1e-2, 1e-3, 1e-5}) {
    const ResponseAt value = constant_response([w](double x) { return std::optional(1 / std::hypot(x - 2, w)); });
    for (const double off : {0.0, 1e-9}) {
      const std::optional<ResponsePeak> peak = locate_peak({value, value, value}, 1.5 + off, 2.5, 3.5);
      ASSERT_TRUE(peak) << w;
      EXPECT_LE(std::abs(peak->x - 2), peak->error) << w;
      EXPECT_LT(peak->error, 1e-9) << w;
    }
  }
}

TEST(ResponsePeak, IsNotToldWhereFineValuesDenyIt) {
  const auto climbing = [](double x) { return std::optional(1 + 1e-6 * x); };
  const ResponseAt fine = constant_response(climbing);
  const ResponseAt rough =
      constant_response([&](double x) { return std::optional(*climbing(x) * (x == 2.5 ? 1 + 5e-6 : 1)); });
  EXPECT_FALSE(locate_peak({rough, fine, fine}, 2, 2.5, 3));
}

TEST(ResponsePeak, SaysWhenTheFunctionDoesNotExist) {
  const ResponseAt value = constant_response([](double x) -> std::optional<double> {
    if (x > 1.1) return std::nullopt;
    return 2 - x * x;
  });
  EXPECT_FALSE(locate_peak({value, value, value}, -1, 0.5, 1.2));
  EXPECT_TRUE(locate_peak({value, value, value}, -1, 0.5, 1));
}

}  // namespace
