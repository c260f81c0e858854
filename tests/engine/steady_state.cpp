#include "hb/engine/steady/steady_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "lib/rod/rod.hpp"
#include "tests/support/dense_harmonic_balance.hpp"
#include "tests/support/six_link.hpp"

namespace hb {
namespace {

using Index = Eigen::Index;

HillSystem mathieu(double damping) {
  HillSystem s;
  s.mass = Eigen::MatrixXd::Ones(1, 1);
  s.damping = Eigen::MatrixXd::Constant(1, 1, damping);
  s.stiffness[0] = FourierSeries(1, 1);
  s.stiffness[0].c << 1.2, 0.2;
  s.load[0] = FourierSeries(1, 1);
  s.load[0].c << 0, 0.5;
  return s;
}

// x'' + b x' + w^2 x = cos(harmonic t)
HillSystem oscillator(double w, double b, Index harmonic) {
  HillSystem s;
  s.mass = Eigen::MatrixXd::Ones(1, 1);
  s.damping = Eigen::MatrixXd::Constant(1, 1, b);
  s.stiffness[0] = FourierSeries(1, 0);
  s.stiffness[0].c << w * w;
  s.load[0] = FourierSeries(1, harmonic);
  s.load[0].c(0, harmonic) = 0.5;
  return s;
}

struct Family {
  Index modes = 1, stiffness_harmonics = 1, load_harmonics = 1;
  double damping_ratio = 0.01, coupling = 0.1, highest_frequency = 5;
  bool symmetric = true, full_mass = false, full_damping = false;
};

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double operator()(double from, double to) { return from + (to - from) * (engine_() / 4294967295.0); }

 private:
  std::mt19937 engine_;
};

HillSystem random_system(const Family& family, Random& random) {
  const Index I = family.modes, P = family.stiffness_harmonics, F = family.load_harmonics;
  HillSystem s;
  s.mass = Eigen::MatrixXd::Zero(I, I);
  s.damping = Eigen::MatrixXd::Zero(I, I);
  s.stiffness[0] = FourierSeries(I * I, P);
  s.load[0] = FourierSeries(I, F);
  Eigen::VectorXd stiffness(I);
  for (Index i = 0; i < I; ++i) {
    const double w = family.highest_frequency * random(0.1, 1), m = random(0.5, 2);
    s.mass(i, i) = m;
    s.damping(i, i) = 2 * family.damping_ratio * w * m;
    stiffness(i) = w * w * m;
    s.stiffness[0].c(i + I * i, 0) = stiffness(i);
  }
  for (Index i = 0; i < I; ++i)
    for (Index j = 0; j < i; ++j) {
      if (family.full_mass) s.mass(i, j) = s.mass(j, i) = random(-0.4, 0.4) / static_cast<double>(I);
      if (family.full_damping) s.damping(i, j) = 0.3 * s.damping(i, i) * random(-1, 1);
    }
  for (Index k = 0; k <= P; ++k)
    for (Index i = 0; i < I; ++i)
      for (Index j = 0; j <= i; ++j) {
        const double size =
            family.coupling * std::pow(0.6, static_cast<double>(k)) * std::sqrt(stiffness(i) * stiffness(j));
        const std::complex<double> c(size * random(-1, 1), k > 0 ? size * random(-1, 1) : 0.0);
        s.stiffness[0].c(i + I * j, k) += c;
        if (i != j) s.stiffness[0].c(j + I * i, k) += family.symmetric ? c : c * random(-1, 1);
      }
  for (Index k = 0; k <= F; ++k)
    for (Index i = 0; i < I; ++i) {
      const double n = static_cast<double>(k);
      s.load[0].c(i, k) = std::complex<double>(random(-1, 1), k > 0 ? random(-1, 1) : 0.0) / (1 + 0.1 * n * n);
    }
  return s;
}

double error_of(const SteadyState& state, const HillSystem& system, double speed) {
  Index P = 0;
  for (const FourierSeries& part : system.stiffness) P = std::max(P, part.num_harmonics());
  const Index H = state.num_harmonics + std::min<Index>(P, 20) + 10;
  return reference::true_error(state.q, reference::dense_harmonic_balance(system, speed, H));
}

void expect_covered(const HillSystem& system, double speed, const SteadyOptions& options, const std::string& what) {
  const SteadyState state = solve_steady_state(system, speed, options);
  ASSERT_NE(state.status, SteadyStatus::singular) << what;
  const double error = error_of(state, system, speed);
  EXPECT_LE(error, state.error_bound) << what << ", H = " << state.num_harmonics;
  if (state.status == SteadyStatus::converged) {
    EXPECT_LE(state.error_bound, options.tolerance) << what;
  }
}

TEST(SteadyState, MathieuReferenceValues) {
  for (const SteadyMethod method : {SteadyMethod::automatic, SteadyMethod::direct, SteadyMethod::iterative}) {
    const SteadyState state = solve_steady_state(mathieu(0.1), 1, {.tolerance = 1e-12, .method = method});
    ASSERT_EQ(state.status, SteadyStatus::converged);
    EXPECT_NEAR(fourier::evaluate(state.q, 0)(0), 4.65595993, 6e-9);
    EXPECT_NEAR(fourier::evaluate(fourier::derivative(state.q), 0)(0), 2.71750522, 6e-9);
  }
}

TEST(SteadyState, OscillatorHasTheClosedFormAmplitude) {
  for (const double w : {0.0, 1e-3, 1.5, 30.0, 1e4})
    for (const double b : {1e-3, 0.1, 50.0}) {
      const SteadyState state = solve_steady_state(oscillator(w, b, 2), 1, {.tolerance = 1e-13});
      ASSERT_EQ(state.status, w == 0 ? SteadyStatus::singular : SteadyStatus::converged) << w << " " << b;
      if (w == 0) continue;
      const std::complex<double> exact = 0.5 / std::complex<double>(w * w - 4, 2 * b);
      EXPECT_LE(std::abs(state.q.c(0, 2) - exact), 1e-13 * std::abs(exact)) << w << " " << b;
    }
}

TEST(SteadyState, UndampedResonanceIsSingularWhetherOrNotTheLoadExcitesIt) {
  for (const SteadyMethod method : {SteadyMethod::automatic, SteadyMethod::direct, SteadyMethod::iterative})
    for (const Index harmonic : {1, 3}) {
      const SteadyState state = solve_steady_state(oscillator(3, 0, harmonic), 1, {.method = method});
      EXPECT_EQ(state.status, SteadyStatus::singular) << harmonic;
      EXPECT_LE(state.resonance_distance, 1e-13);
      EXPECT_EQ(state.q.c.size(), 0);
    }
}

TEST(SteadyState, ResonanceFarBeyondTheLoadIsSingularToo) {
  EXPECT_EQ(solve_steady_state(oscillator(524, 0, 1), 1).status, SteadyStatus::singular);
  EXPECT_EQ(solve_steady_state(oscillator(524.25, 0, 1), 1).status, SteadyStatus::converged);
}

TEST(SteadyState, ResonanceDistanceShrinksLikeTheDetuning) {
  for (const double detuning : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const SteadyState state = solve_steady_state(oscillator(2 + detuning, 0, 2), 1, {.tolerance = 1e-6});
    ASSERT_EQ(state.status, SteadyStatus::converged) << detuning;
    EXPECT_LE(state.resonance_distance, 3 * detuning);
    EXPECT_GE(state.resonance_distance, 0.1 * detuning);
  }
}

TEST(SteadyState, NoLoadGivesRest) {
  HillSystem s = mathieu(0.1);
  s.load[0] = FourierSeries();
  const SteadyState state = solve_steady_state(s, 1);
  EXPECT_EQ(state.status, SteadyStatus::converged);
  EXPECT_EQ(state.error_bound, 0);
  EXPECT_EQ(state.q.num_harmonics(), 0);
  EXPECT_TRUE(state.q.c.isZero(0));
}

TEST(SteadyState, ErrorBoundCoversTheErrorOfRandomSystems) {
  Random random(7);
  for (int trial = 0; trial < 160; ++trial) {
    Family family;
    family.modes = 1 + static_cast<Index>(random(0, 5.99));
    family.stiffness_harmonics = static_cast<Index>(random(0, trial % 8 == 0 ? 30 : 6));
    family.load_harmonics = static_cast<Index>(random(0, trial % 7 == 0 ? 60 : 6));
    family.damping_ratio = trial % 5 == 0 ? 0 : std::pow(10, random(-5, -0.5));
    family.coupling = std::pow(10, random(-4, -0.5));
    family.highest_frequency = std::pow(10, random(-0.5, trial % 6 == 0 ? 4 : 1.2));
    family.symmetric = trial % 3 != 0;
    family.full_mass = trial % 4 == 1;
    family.full_damping = trial % 4 == 2;
    const HillSystem system = random_system(family, random);
    SteadyOptions options;
    options.tolerance = std::pow(10, -std::floor(random(2, 14)));
    options.method = trial % 3 == 0   ? SteadyMethod::direct
                     : trial % 3 == 1 ? SteadyMethod::iterative
                                      : SteadyMethod::automatic;
    expect_covered(system, random(0.3, 3), options, "trial " + std::to_string(trial));
  }
}

TEST(SteadyState, ErrorBoundCoversTheErrorNextToResonance) {
  Random random(8);
  for (int trial = 0; trial < 60; ++trial) {
    Family family{
        .modes = 1 + trial % 4, .stiffness_harmonics = 2, .load_harmonics = 3, .damping_ratio = 0, .coupling = 0.03};
    HillSystem system = random_system(family, random);
    const double w = 1 + trial % 3 + std::pow(10, random(-11, -2));
    system.stiffness[0].c(0, 0) = w * w * system.mass(0, 0);
    if (trial % 2 == 0) system.stiffness[0].c.rightCols(2).setZero();
    expect_covered(system, 1, {.tolerance = 1e-10}, "trial " + std::to_string(trial));
  }
}

TEST(SteadyState, AskedToleranceIsMetFrom1e2To1e13) {
  const HillSystem system = mathieu(0.1);
  for (int digits = 2; digits <= 13; ++digits) {
    const double tolerance = std::pow(10, -digits);
    const SteadyState state = solve_steady_state(system, 1, {.tolerance = tolerance});
    EXPECT_EQ(state.status, SteadyStatus::converged) << digits;
    EXPECT_LE(error_of(state, system, 1), tolerance) << digits;
  }
}

TEST(SteadyState, MethodsAgree) {
  Random random(9);
  for (int trial = 0; trial < 12; ++trial) {
    const HillSystem system =
        random_system({.modes = 1 + trial, .stiffness_harmonics = 3, .load_harmonics = 2, .coupling = 0.05}, random);
    const SteadyState direct = solve_steady_state(system, 1, {.tolerance = 1e-11, .method = SteadyMethod::direct});
    const SteadyState iterative =
        solve_steady_state(system, 1, {.tolerance = 1e-11, .method = SteadyMethod::iterative});
    ASSERT_EQ(direct.status, SteadyStatus::converged) << trial;
    if (iterative.status != SteadyStatus::converged) continue;
    const Index H = std::max(direct.q.num_harmonics(), iterative.q.num_harmonics());
    const Eigen::MatrixXcd difference = fourier::resized(direct.q, H).c - fourier::resized(iterative.q, H).c;
    EXPECT_LE(difference.cwiseAbs().maxCoeff(), 3e-11 * 2 * direct.q.c.cwiseAbs().sum()) << trial;
  }
}

TEST(SteadyState, ProvedBoundCoversTheErrorAndIsNotFarFromTheEstimate) {
  Random random(13);
  int proved = 0;
  for (int trial = 0; trial < 24; ++trial) {
    Family family{.modes = 1 + trial % 3, .stiffness_harmonics = 2, .load_harmonics = 3, .coupling = 0.05};
    family.damping_ratio = trial % 4 == 0 ? 0 : std::pow(10, random(-4, -1));
    family.full_damping = trial % 5 == 1;
    family.full_mass = trial % 5 == 2;
    const HillSystem system = random_system(family, random);
    SteadyOptions options{.tolerance = std::pow(10, -random(3, 13)), .bound = SteadyBound::proved};
    const SteadyState state = solve_steady_state(system, 1, options);
    const double error = error_of(state, system, 1);
    EXPECT_LE(error, state.error_bound) << trial;
    if (state.bound != SteadyBound::proved) continue;
    ++proved;
    options.bound = SteadyBound::estimated;
    EXPECT_LE(state.error_bound, 10 * solve_steady_state(system, 1, options).error_bound + 1e-14) << trial;
  }
  EXPECT_GE(proved, 18);
}

TEST(SteadyState, NoProofIsClaimedWhereTheContractionFails) {
  // A stiff undamped mode beyond the harmonics that fit: its resonance is not excluded.
  const SteadyState state =
      solve_steady_state(oscillator(5000.25, 0, 1), 1, {.tolerance = 1e-9, .bound = SteadyBound::proved});
  EXPECT_EQ(state.status, SteadyStatus::converged);
  EXPECT_EQ(state.bound, SteadyBound::proved);  // without coupling nothing can feed it
  HillSystem coupled = oscillator(5000.000001, 0, 1);
  coupled.stiffness[0] = fourier::resized(coupled.stiffness[0], 1);
  coupled.stiffness[0].c(0, 1) = 1e6;
  EXPECT_EQ(solve_steady_state(coupled, 1, {.tolerance = 1e-9, .bound = SteadyBound::proved}).bound,
            SteadyBound::estimated);
}

TEST(SteadyState, AmplitudeScaleChangesNoDigit) {
  const HillSystem system = mathieu(0.1);
  const SteadyState plain = solve_steady_state(system, 1);
  for (const int power : {-660, -100, 100, 660}) {
    HillSystem scaled = system;
    scaled.load[0].c *= std::ldexp(1.0, power);
    const SteadyState state = solve_steady_state(scaled, 1);
    ASSERT_EQ(state.status, SteadyStatus::converged) << power;
    const double back = std::ldexp(1.0, -power);
    EXPECT_TRUE((state.q.c * back - plain.q.c).isZero(1e-15)) << power;
  }
}

TEST(SteadyState, SameInputSameBits) {
  Random random(10);
  const HillSystem system = random_system({.modes = 5, .stiffness_harmonics = 8, .load_harmonics = 8}, random);
  const SteadyState first = solve_steady_state(system, 1), second = solve_steady_state(system, 1);
  EXPECT_EQ(first.q.c, second.q.c);
  EXPECT_EQ(first.error_bound, second.error_bound);
}

TEST(SteadyState, LoadWithHundredsOfHarmonics) {
  Random random(11);
  const HillSystem system =
      random_system({.modes = 2, .stiffness_harmonics = 2, .load_harmonics = 300, .coupling = 0.05}, random);
  const SteadyState state = solve_steady_state(system, 1, {.tolerance = 1e-10});
  EXPECT_EQ(state.status, SteadyStatus::converged);
  EXPECT_GE(state.num_harmonics, 300);
  EXPECT_LE(error_of(state, system, 1), state.error_bound);
}

TEST(SteadyState, StiffnessWithTwoHundredHarmonics) {
  Random random(12);
  HillSystem system = random_system({.modes = 2, .stiffness_harmonics = 200, .coupling = 0.02}, random);
  for (Index k = 1; k <= 200; ++k)
    for (Index c = 0; c < 4; ++c)
      system.stiffness[0].c(c, k) = std::polar(0.05 / static_cast<double>(k * k), static_cast<double>(k * k + c));
  const SteadyState state = solve_steady_state(system, 1, {.tolerance = 1e-8});
  EXPECT_EQ(state.status, SteadyStatus::converged);
  EXPECT_LE(error_of(state, system, 1), state.error_bound);
}

double largest_difference(const FourierSeries& a, const FourierSeries& b) {
  const Index H = std::max(a.num_harmonics(), b.num_harmonics());
  return 2 * (fourier::resized(a, H).c - fourier::resized(b, H).c).cwiseAbs().rowwise().sum().maxCoeff();
}

TEST(SteadyState, BeginsWhereItIsToldAndClaimsNothingWhereNoBoundIsAskedFor) {
  Random random(31);
  for (const SteadyMethod method : {SteadyMethod::iterative, SteadyMethod::direct}) {
    const HillSystem s = random_system({.modes = 4, .stiffness_harmonics = 12, .load_harmonics = 8}, random);
    const double speed = 0.7;
    SteadyOptions options{.method = method};
    const SteadyState from_rest = solve_steady_state(s, speed, options);
    ASSERT_EQ(from_rest.status, SteadyStatus::converged);
    const double size = fourier::max_abs(from_rest.q, 0).value;

    options.without_bound = true;
    const SteadyState rough = solve_steady_state(s, speed, options);
    EXPECT_EQ(rough.status, SteadyStatus::not_reached);
    EXPECT_EQ(rough.error_bound, HUGE_VAL);
    EXPECT_LE(largest_difference(rough.q, from_rest.q), 1e-7 * size);
    if (method == SteadyMethod::iterative) {
      EXPECT_LT(rough.iterations, from_rest.iterations);
    }

    options.start = from_rest.q;
    const SteadyState known = solve_steady_state(s, speed, options);
    EXPECT_LE(largest_difference(known.q, from_rest.q), 1e-7 * size);
    if (method == SteadyMethod::iterative) {
      EXPECT_LT(known.iterations, rough.iterations);
    }

    options.without_bound = false;
    options.start.c.array() += 3;  // far off: as accurate
    const SteadyState again = solve_steady_state(s, speed, options);
    EXPECT_EQ(again.status, SteadyStatus::converged);
    EXPECT_LE(largest_difference(again.q, from_rest.q), 1e-7 * size);
  }
}

TEST(SteadyState, TooFewHarmonicsAreSaidToBeTooFew) {
  const SteadyState state = solve_steady_state(mathieu(0.1), 1, {.tolerance = 1e-12, .num_harmonics = 3});
  EXPECT_EQ(state.status, SteadyStatus::not_reached);
  EXPECT_EQ(state.num_harmonics, 3);
  EXPECT_LE(error_of(state, mathieu(0.1), 1), state.error_bound);
}

TEST(SteadyState, WrongOptionsAreRefused) {
  EXPECT_THROW((void)solve_steady_state(mathieu(0.1), 1, {.tolerance = 0}), std::invalid_argument);
  EXPECT_THROW((void)solve_steady_state(mathieu(0.1), 1, {.tolerance = std::nan("")}), std::invalid_argument);
  EXPECT_THROW((void)solve_steady_state(mathieu(0.1), 1, {.num_harmonics = -1}), std::invalid_argument);
  EXPECT_THROW((void)solve_steady_state(mathieu(0.1), std::nan("")), std::invalid_argument);
}

struct SixLink {
  Linkage linkage;
  LinkageCoefficients coefficients;
  explicit SixLink(double J) : linkage(six_link::linkage({.J = J})), coefficients(linkage_coefficients(linkage)) {}
  HillSystem rod(std::size_t index, Index modes) const {
    return ritz_system(*body_at(linkage, coefficients.links[index]), coefficients.rods[index], modes);
  }
};

double radians_per_second(double rpm) { return rpm * std::numbers::pi / 30; }

// Largest |q_i| of the reference table, printed to the digits given.
TEST(SteadyState, SixLinkPeaks) {
  const SixLink soft(45), stiff(4500);
  struct Row {
    const SixLink& mechanism;
    double rpm;
    std::size_t rod;
    std::vector<double> peaks;
  };
  const Row rows[] = {
      {soft, 300, 0, {0.1510922077}},
      {soft, 300, 1, {0.1267067817}},
      {soft, 300, 0, {0.1510928269, 0.0050582129, 0.00064872052, 0.00015724266, 0.000050640311}},
      {soft, 300, 1, {0.1267056394, 0.00098498564, 0.00051203792, 0.000031126823, 0.000039769030}},
      {stiff, 300, 0, {0.0015845946264, 5.021711743e-5, 6.523767310e-6, 1.569202456e-6, 5.07307682e-7}},
      {soft, 1500, 0, {8.96241091, 0.16294031, 0.014309439, 0.0042246094, 0.0011018167}},
      {soft, 1500, 1, {5.03055449, 0.020937403, 0.0093842120, 0.00063015144, 0.00071124349}},
  };
  for (const Row& row : rows) {
    const auto I = static_cast<Index>(row.peaks.size());
    const SteadyState state =
        solve_steady_state(row.mechanism.rod(row.rod, I), radians_per_second(row.rpm), {.tolerance = 1e-12});
    ASSERT_EQ(state.status, SteadyStatus::converged);
    for (Index i = 0; i < I; ++i) {
      const double peak = row.peaks[static_cast<std::size_t>(i)];
      // 8 digits are printed at least; the table's maxima are those of 8192 samples, so true ones are no smaller.
      const double sampled = fourier::synthesise(state.q, 8192).row(i).cwiseAbs().maxCoeff();
      const double last_digit = std::pow(10, std::floor(std::log10(peak)) - 7);
      EXPECT_NEAR(sampled, peak, 0.51 * last_digit) << row.rpm << " rpm, rod " << row.rod;
      EXPECT_GE(fourier::max_abs(state.q, i).value, sampled * (1 - 1e-14)) << row.rpm << " rpm, rod " << row.rod;
    }
  }
}

TEST(SteadyState, SixLinkErrorBoundsHoldFrom1To30000Rpm) {
  for (const double J : {45.0, 4500.0}) {
    const SixLink mechanism(J);
    for (const std::size_t rod : {0, 1})
      for (const double rpm : {1.0, 300.0, 1500.0, 3000.0, 6000.0, 30000.0}) {
        const HillSystem system = mechanism.rod(rod, 5);
        const SteadyState state = solve_steady_state(system, radians_per_second(rpm), {.tolerance = 1e-12});
        const std::string what =
            "J " + std::to_string(J) + ", rod " + std::to_string(rod) + ", rpm " + std::to_string(rpm);
        EXPECT_EQ(state.status, SteadyStatus::converged) << what << ", bound " << state.error_bound;
        EXPECT_LE(error_of(state, system, radians_per_second(rpm)), state.error_bound) << what;
      }
  }
}

}  // namespace
}  // namespace hb
