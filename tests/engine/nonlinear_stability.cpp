#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "hb/engine/nonlinear/motion_shooting.hpp"
#include "hb/engine/nonlinear/motion_stability.hpp"
#include "lib/constants.hpp"
#include "tests/support/nonlinear_systems.hpp"
#include "tests/support/random_hill_system.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
double distance(std::complex<double> a, std::complex<double> b, double omega) {
  return std::hypot(a.real() - b.real(), std::remainder(a.imag() - b.imag(), omega));
}

double nearest(const std::vector<Exponent>& list, std::complex<double> value, double omega) {
  double result = HUGE_VAL;
  for (const Exponent& e : list) result = std::min(result, distance(e.value, value, omega));
  return result;
}

// x = P(sigma) y with periodic P, the equations multiplied by L(sigma) from the left: mass and damping vary, the
// exponents do not change.
//     M P y'' + (2 M P' + B P) y' + (M P'' + B P' + C P) y = 0
PeriodicSystem in_turning_coordinates(const HillSystem& hill, double speed, Index N) {
  const Index n = hill.num_modes();
  const FourierSeries C = stiffness_at(hill, speed);
  PeriodicSystem system{speed, MatrixXd(n * n, N), MatrixXd(n * n, N), MatrixXd(n * n, N)};
  const auto mixed = [n](double value, double phase, double diagonal) {
    MatrixXd P = diagonal * MatrixXd::Identity(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index k = 0; k < n; ++k) P(i, k) += value / double(n) * std::cos(phase + double(i) - 2 * double(k));
    return P;
  };
  for (Index j = 0; j < N; ++j) {
    const double tau = 2 * pi * double(j) / double(N), depth = 0.3;
    const MatrixXd P = mixed(depth, tau, 1), P1 = speed * mixed(depth, tau + pi / 2, 0),
                   P2 = speed * speed * mixed(-depth, tau, 0), L = mixed(0.2, 2 * tau, 1);
    const MatrixXd stiffness = fourier::evaluate(C, tau).reshaped(n, n);
    system.mass.col(j) = (L * hill.mass * P).reshaped();
    system.damping.col(j) = (L * (2 * hill.mass * P1 + hill.damping * P)).reshaped();
    system.stiffness.col(j) = (L * (hill.mass * P2 + hill.damping * P1 + stiffness * P)).reshaped();
  }
  return system;
}

TEST(PeriodicExponents, AreThoseOfTheSameSystemInOtherCoordinates) {
  stress::Random random(11);
  int compared = 0;
  for (const stress::Family family : {stress::Family::plain, stress::Family::full_matrices, stress::Family::unsymmetric,
                                      stress::Family::strong, stress::Family::undamped})
    for (int k = 0; k < 4; ++k) {
      const auto [hill, speed] = stress::random_trial(family, random, 3);
      const Stability expected = analyse_stability(hill, speed);
      if (!expected.converged || expected.exponents.size() < 2u * std::size_t(hill.num_modes())) continue;
      const Stability found = analyse_stability(in_turning_coordinates(hill, speed, 256), {.tolerance = 1e-10});
      ASSERT_FALSE(found.exponents.empty());
      ++compared;
      for (const Exponent& e : found.exponents) {
        double other = HUGE_VAL, bar = 0;
        for (const Exponent& x : expected.exponents)
          if (distance(x.value, e.value, speed) < other) {
            other = distance(x.value, e.value, speed);
            bar = x.error;
          }
        EXPECT_LE(other, e.error + bar) << "family " << int(family) << " trial " << k;
      }
      EXPECT_LE(std::abs(found.growth_rate - expected.growth_rate), found.growth_error + expected.growth_error);
      EXPECT_LE(found.growth_error, 1e-7 * (speed + std::abs(found.growth_rate)));
    }
  EXPECT_GE(compared, 10);
}

TEST(PeriodicExponents, SeeHarmonicsThatTheSamplesCannotTell) {
  test::VibratedPendulum pendulum;
  HillSystem hill;
  hill.mass = MatrixXd::Identity(1, 1);
  hill.damping = MatrixXd::Constant(1, 1, pendulum.damping);
  hill.stiffness[0] = FourierSeries(1, 1);
  hill.stiffness[0].c << 1, 0.4;
  const double exact = analyse_stability(hill, 2).growth_rate;
  for (const Index N : {8, 12, 16, 32}) {
    const Stability found = analyse_stability(in_turning_coordinates(hill, 2, N));
    EXPECT_LE(std::abs(found.growth_rate - exact), found.growth_error) << N << " samples";
  }
}

TEST(PeriodicExponents, RefuseWhatIsNoSystem) {
  PeriodicSystem system{1, MatrixXd::Ones(1, 8), MatrixXd::Zero(1, 8), MatrixXd::Ones(1, 8)};
  EXPECT_NO_THROW((void)analyse_stability(system));
  system.speed = 0;
  EXPECT_THROW((void)analyse_stability(system), std::invalid_argument);
  system.speed = 1;
  system.mass(0, 3) = 0;
  EXPECT_THROW((void)analyse_stability(system), std::invalid_argument);
  system.mass = MatrixXd::Ones(4, 8);
  EXPECT_THROW((void)analyse_stability(system), std::invalid_argument);
}

// Some masses need rows exchanged, some do not, in every order of neighbouring angles.
TEST(NormalForm, NeedsNoLargeEntryOnTheMassesDiagonal) {
  constexpr Index n = 3;
  MatrixXd mass(n, n);
  mass << 0, 2, 1, 1, 0, 3, -2, 1, 0;
  for (const Index N : {1, 4, 8, 37, 64}) {
    PeriodicSystem system{2, MatrixXd(n * n, N), MatrixXd::Random(n * n, N), MatrixXd::Random(n * n, N)};
    for (Index j = 0; j < N; ++j) {
      const double diagonal = j % 11 < 6 && j % 4 != 2 ? 5 : 0.1 * double(j % 4);
      system.mass.col(j) = (mass + diagonal * MatrixXd::Identity(n, n)).reshaped();
    }
    const NormalForm form = normal_form(system);
    for (Index j = 0; j < N; ++j) {
      const auto at = [j](const MatrixXd& samples) -> MatrixXd { return samples.col(j).reshaped(n, n); };
      EXPECT_LT((4 * at(system.mass) * at(form.alpha) - at(system.stiffness)).cwiseAbs().maxCoeff(), 1e-14);
      EXPECT_LT((2 * at(system.mass) * at(form.beta) - at(system.damping)).cwiseAbs().maxCoeff(), 1e-14);
    }
  }
}

TEST(NormalForm, RefusesAMassThatIsSingularAtOneAngle) {
  constexpr Index n = 3, N = 19;
  for (const Index singular : {0, 5, 18}) {
    PeriodicSystem system{2, MatrixXd(n * n, N), MatrixXd::Random(n * n, N), MatrixXd::Random(n * n, N)};
    for (Index j = 0; j < N; ++j) system.mass.col(j) = MatrixXd::Identity(n, n).reshaped();
    EXPECT_NO_THROW((void)normal_form(system));
    system.mass.col(singular).setZero();
    EXPECT_THROW((void)normal_form(system), std::invalid_argument);
    system.mass.col(singular) = MatrixXd::Identity(n, n).reshaped();
    system.mass(4, singular) = NAN;
    EXPECT_THROW((void)normal_form(system), std::invalid_argument);
  }
}

TEST(MotionStability, OfALinearSystemIsThatOfTheSystem) {
  stress::Random random(7);
  for (int k = 0; k < 6; ++k) {
    const auto [hill, speed] = stress::random_trial(stress::Family::plain, random, 3);
    const PeriodicMotion motion = solve_periodic_motion(test::linear(hill), speed, {}, {.tolerance = 1e-10});
    if (motion.status != MotionStatus::converged) continue;
    const Stability expected = analyse_stability(hill, speed, {.tolerance = 1e-11});
    const Stability found = motion_stability(test::linear(hill), motion, {.tolerance = 1e-11});
    EXPECT_NEAR(found.growth_rate, expected.growth_rate, 1e-10 * (speed + std::abs(expected.growth_rate)));
    EXPECT_EQ(found.verdict, expected.verdict);
  }
}

// What the load changes is of second order in it.
TEST(MotionStability, TendsToTheLinearOneAsTheLoadIsScaledToZero) {
  test::DoublePendulum s{.bias = 0};
  HillSystem hill;
  hill.mass = MatrixXd{{s.a + 2 * s.b, s.c + s.b}, {s.c + s.b, s.c}};
  hill.damping = MatrixXd{{s.d1, 0}, {0, s.d2}};
  hill.stiffness[0] = FourierSeries(4, 0);
  hill.stiffness[0].c << s.k1, 0, 0, s.k2;
  const double Omega = 0.9, linear = analyse_stability(hill, Omega).growth_rate;
  std::vector<double> change;
  for (const double torque : {0.1, 0.01}) {
    s.torque = torque;
    const NonlinearSystem system = test::double_pendulum(s);
    const PeriodicMotion motion = solve_periodic_motion(system, Omega, {}, {.tolerance = 1e-11});
    ASSERT_EQ(motion.status, MotionStatus::converged);
    change.push_back(std::abs(motion_stability(system, motion).growth_rate - linear));
  }
  EXPECT_GT(change[0], 1e-8);
  EXPECT_NEAR(change[0] / change[1], 100, 2);
}

struct Case {
  const char* name;
  NonlinearSystem system;
  double Omega;
  int turns = 1;
};

StartingOrbit orbit_of(const PeriodicMotion& motion) {
  const Index N = fourier::fast_length(4 * motion.num_harmonics + 2);
  return {fourier::synthesise(motion.q, N),
          fourier::synthesise(fourier::derivative(motion.q), N) / double(motion.turns)};
}

TEST(MotionShooting, FindsTheMotionAndTheExponentsOfHarmonicBalance) {
  // Three times the pendulum's frequency shakes it into a motion of two turns (found by continuation, checked here).
  const Case cases[] = {
      {"Duffing", test::duffing({0.1, 1, 0.3}), 0.8},
      {"double pendulum", test::double_pendulum({.torque = 2.5, .bias = 0.8}), 0.7},
      {"double pendulum, fast", test::double_pendulum({.torque = 4}), 2.3},
      {"pendulum held off", test::vibrated_pendulum({.damping = 0.2, .depth = 0.6, .force = 0.4}), 1.6}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const PeriodicMotion motion = solve_periodic_motion(c.system, c.Omega, {}, {.tolerance = 1e-11});
    ASSERT_EQ(motion.status, MotionStatus::converged);
    const Stability stability = motion_stability(c.system, motion);
    // A start far enough away that shooting has to find the motion itself.
    StartingOrbit start = orbit_of(motion);
    start.q *= 1.02;
    const ShootingResult shot = shoot_motion(c.system, c.Omega, start, {.tolerance = 1e-7});
    ASSERT_EQ(shot.status, ShootingStatus::converged) << shot.message;
    const Index N = shot.orbit.q.cols();
    const MatrixXd q =
        fourier::synthesise(fourier::resized(motion.q, std::min<Index>(motion.num_harmonics, N / 2 - 1)), N);
    EXPECT_LE((shot.orbit.q - q).cwiseAbs().maxCoeff() / q.cwiseAbs().maxCoeff(), shot.q_error + motion.error_bound);
    ASSERT_FALSE(shot.exponents.empty());
    for (const Exponent& e : shot.exponents)
      EXPECT_LE(nearest(stability.exponents, e.value, c.Omega), e.error + 1e-8) << e.value;
    EXPECT_EQ(shot.verdict, stability.verdict);
  }
}

TEST(MotionShooting, SaysWhereTheEquationsEnd) {
  NonlinearSystem system = test::duffing({0.1, 0, 0.5});
  const auto whole = system.evaluate;
  system.evaluate = [whole](double p, const MotionSamples& motion, Derivatives wanted,
                            ResidualSamples& samples) -> std::optional<EvaluationFailure> {
    if (motion.q.cwiseAbs().maxCoeff() > 1) return EvaluationFailure{"too far", motion.angle(0)};
    return whole(p, motion, wanted, samples);
  };
  const StartingOrbit rest{MatrixXd::Zero(1, 4), MatrixXd::Zero(1, 4)};
  const ShootingResult shot = shoot_motion(system, 1, rest);
  EXPECT_EQ(shot.status, ShootingStatus::failed);
  EXPECT_NE(shot.message.find("too far"), std::string::npos) << shot.message;
}

}  // namespace
}  // namespace hb
