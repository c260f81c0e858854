#include <gtest/gtest.h>

#include <cmath>

#include "hb/engine/nonlinear/harmonic_balance.hpp"
#include "hb/engine/nonlinear/motion_search.hpp"
#include "hb/engine/nonlinear/periodic_motion.hpp"
#include "hb/engine/steady/steady_state.hpp"
#include "lib/constants.hpp"
#include "tests/support/nonlinear_systems.hpp"
#include "tests/support/random_hill_system.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
VectorXd some_unknowns(Index size) {
  VectorXd u(size);
  for (Index i = 0; i < size; ++i) u(i) = 0.3 * std::sin(double(1 + 3 * i)) / double(1 + i / 4);
  return u;
}

TEST(NonlinearHarmonicBalance, JacobianIsTheDerivativeOfTheResidual) {
  const NonlinearSystem system = test::double_pendulum({});
  for (const int turns : {1, 2}) {
    nonlinear::HarmonicBalance balance(system, turns, 5, nonlinear::samples_for(5));
    const VectorXd u = some_unknowns(balance.num_unknowns());
    const double p = 1.3, step = 1e-5;
    nonlinear::Linearisation linear;
    VectorXd R, above, below;
    ASSERT_FALSE(balance.linearise(u, p, R, linear));
    const MatrixXd J = balance.jacobian(linear, p);
    for (Index k = 0; k < u.size(); ++k) {
      ASSERT_FALSE(balance.residual(u + step * VectorXd::Unit(u.size(), k), p, above));
      ASSERT_FALSE(balance.residual(u - step * VectorXd::Unit(u.size(), k), p, below));
      // Third derivatives of order 10^2 times step^2, and rounding over the step.
      EXPECT_LT((J.col(k) - (above - below) / (2 * step)).cwiseAbs().maxCoeff(), 1e-7) << "column " << k;
    }
    ASSERT_FALSE(balance.parameter_derivative(u, p, 1, linear, R));
    ASSERT_FALSE(balance.residual(u, p + step, above));
    ASSERT_FALSE(balance.residual(u, p - step, below));
    EXPECT_LT((R - (above - below) / (2 * step)).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(NonlinearHarmonicBalance, GivenAndDifferencedParameterDerivativesAgree) {
  NonlinearSystem system = test::duffing({});
  nonlinear::HarmonicBalance balance(system, 1, 4, nonlinear::samples_for(4));
  const VectorXd u = some_unknowns(balance.num_unknowns());
  nonlinear::Linearisation linear;
  VectorXd R, differenced, given;
  ASSERT_FALSE(balance.linearise(u, 1.4, R, linear));
  ASSERT_FALSE(balance.parameter_derivative(u, 1.4, 1.4, linear, differenced));
  linear.samples.dp = MatrixXd::Zero(1, balance.num_samples());
  ASSERT_FALSE(balance.parameter_derivative(u, 1.4, 1.4, linear, given));
  EXPECT_LT((given - differenced).norm(), 1e-10 * given.norm());
}

// With one harmonic x = A cos(tau + phi): ((1 - Omega^2 + 3/4 cubic A^2)^2 + (damping Omega)^2) A^2 = force^2.
TEST(PeriodicMotion, OneHarmonicObeysTheAmplitudeFrequencyRelationOfDuffingsEquation) {
  for (const double Omega : {0.4, 0.8, 2.5}) {
    const test::Duffing d{0.2, 0.5, 0.3};
    const PeriodicMotion motion =
        solve_periodic_motion(test::duffing(d), Omega, {}, {.tolerance = 1e-12, .num_harmonics = 1});
    ASSERT_EQ(motion.num_harmonics, 1);
    const double A = 2 * std::abs(motion.q.c(0, 1));
    const double detuning = 1 - Omega * Omega + 0.75 * d.cubic * A * A;
    EXPECT_NEAR((detuning * detuning + std::pow(d.damping * Omega, 2)) * A * A, d.force * d.force, 1e-12);
    // One harmonic is not the motion, and the error says so: the third is about cubic A^3/4/|1 - 9 Omega^2|.
    EXPECT_EQ(motion.status, MotionStatus::not_reached);
    const PeriodicMotion whole = solve_periodic_motion(test::duffing(d), Omega, motion.q, {.tolerance = 1e-12});
    ASSERT_EQ(whole.status, MotionStatus::converged);
    const VectorXd difference =
        (fourier::synthesise(whole.q, 512) - fourier::synthesise(motion.q, 512)).cwiseAbs().rowwise().maxCoeff();
    EXPECT_GE(motion.error(0), difference(0));
    EXPECT_LE(motion.error(0), 3 * difference(0));
  }
}

// The load is made so that x = 0.8 cos tau + 0.1 sin 2 tau - 0.05 cos 5 tau solves a system with e^x in it.
TEST(PeriodicMotion, FindsAMotionThatIsKnownInClosedForm) {
  const auto force = [](double tau, double Omega) {
    const double x = 0.8 * std::cos(tau) + 0.1 * std::sin(2 * tau) - 0.05 * std::cos(5 * tau);
    const double v = Omega * (-0.8 * std::sin(tau) + 0.2 * std::cos(2 * tau) + 0.25 * std::sin(5 * tau));
    const double a = Omega * Omega * (-0.8 * std::cos(tau) - 0.4 * std::sin(2 * tau) + 1.25 * std::cos(5 * tau));
    return (1 + 0.3 * x * x) * a + 0.3 * v + std::exp(x) - 1;
  };
  const NonlinearSystem system =
      test::differentiated(1, [&](double p, double tau, const auto& q, const auto& v, const auto& a) {
        using std::exp;
        auto r = a;
        r(0) = (1 + 0.3 * q(0) * q(0)) * a(0) + 0.3 * v(0) + exp(q(0)) - 1.0 - force(tau, p);
        return r;
      });
  for (const double tolerance : {1e-4, 1e-8, 1e-12}) {
    const PeriodicMotion motion = solve_periodic_motion(system, 0.7, {}, {.tolerance = tolerance});
    ASSERT_EQ(motion.status, MotionStatus::converged);
    FourierSeries exact(1, 5);
    exact.c(0, 1) = 0.4;
    exact.c(0, 2) = std::complex<double>(0, -0.05);
    exact.c(0, 5) = -0.025;
    const MatrixXd wrong = fourier::synthesise(motion.q, 512) - fourier::synthesise(exact, 512);
    EXPECT_LE(wrong.cwiseAbs().maxCoeff(), motion.error(0));
    EXPECT_LE(motion.error_bound, tolerance);
  }
}

TEST(PeriodicMotion, OfALinearSystemIsItsSteadyState) {
  stress::Random random(5);
  int compared = 0;
  for (const stress::Family family :
       {stress::Family::plain, stress::Family::full_matrices, stress::Family::stiff, stress::Family::unsymmetric})
    for (int k = 0; k < 5; ++k) {
      const auto [hill, speed] = stress::random_trial(family, random, 4);
      const SteadyState steady = solve_steady_state(hill, speed, {.tolerance = 1e-12});
      if (steady.status != SteadyStatus::converged || steady.num_harmonics > 60) continue;
      ++compared;
      const PeriodicMotion motion = solve_periodic_motion(test::linear(hill), speed, {}, {.tolerance = 1e-11});
      ASSERT_NE(motion.status, MotionStatus::no_motion);
      const Index N = 4 * std::max<Index>(motion.num_harmonics, steady.num_harmonics) + 2;
      const MatrixXd expected = fourier::synthesise(steady.q, N);
      const MatrixXd wrong = fourier::synthesise(motion.q, N) - expected;
      EXPECT_LE(wrong.cwiseAbs().maxCoeff(), 1e-10 * expected.cwiseAbs().maxCoeff()) << to_string(motion.status);
    }
  EXPECT_GE(compared, 10);
}

// Over a turn the torque does the work that the dampers take: mean of q1' torque = mean of d1 q1'^2 + d2 q2'^2.
TEST(PeriodicMotion, PowerPutInIsDissipated) {
  const test::DoublePendulum s;
  for (const double Omega : {0.5, 1.1, 2.7}) {
    const PeriodicMotion motion = solve_periodic_motion(test::double_pendulum(s), Omega, {}, {.tolerance = 1e-11});
    ASSERT_EQ(motion.status, MotionStatus::converged) << "at " << Omega;
    const Index N = 4 * motion.num_harmonics + 4;
    const MatrixXd v = Omega * fourier::synthesise(fourier::derivative(motion.q), N);
    double in = 0, out = 0;
    for (Index j = 0; j < N; ++j) {
      in += v(0, j) * s.torque * std::cos(2 * pi * double(j) / double(N));
      out += s.d1 * v(0, j) * v(0, j) + s.d2 * v(1, j) * v(1, j);
    }
    EXPECT_NEAR(in, out, 1e-9 * out);
  }
}

TEST(PeriodicMotion, EstimatesItsErrorAtEveryNumberOfHarmonics) {
  const NonlinearSystem system = test::double_pendulum({.torque = 3, .bias = 1});
  const PeriodicMotion exact = solve_periodic_motion(system, 0.6, {}, {.tolerance = 1e-13});
  double last = HUGE_VAL;
  for (int H = 4; H <= 24; H += 4) {
    const PeriodicMotion motion = solve_periodic_motion(system, 0.6, exact.q, {.tolerance = 1e-13, .num_harmonics = H});
    ASSERT_EQ(motion.num_harmonics, H);
    const MatrixXd wrong = fourier::synthesise(motion.q, 512) - fourier::synthesise(exact.q, 512);
    for (Index i = 0; i < 2; ++i)
      EXPECT_LE(wrong.row(i).cwiseAbs().maxCoeff(), 1.5 * motion.error(i) + exact.error(i)) << "H = " << H;
    EXPECT_LT(motion.error_bound, last);
    last = motion.error_bound;
  }
}

TEST(PeriodicMotion, WithoutLoadRests) {
  const PeriodicMotion motion = solve_periodic_motion(test::vibrated_pendulum({}), 1.3, {});
  EXPECT_EQ(motion.status, MotionStatus::converged);
  EXPECT_EQ(motion.q.c.cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(motion.error_bound, 0);
}

TEST(PeriodicMotion, OverTwoTurnsTheSameMotionHasEvenHarmonics) {
  const NonlinearSystem system = test::duffing({0.2, 0.5, 0.3});
  const PeriodicMotion once = solve_periodic_motion(system, 0.8, {}, {.tolerance = 1e-12});
  const PeriodicMotion twice =
      solve_periodic_motion(system, 0.8, repeated(once.q, 2), {.tolerance = 1e-12, .turns = 2});
  ASSERT_EQ(twice.status, MotionStatus::converged);
  for (Index k = 0; k <= std::min(once.q.num_harmonics(), twice.q.num_harmonics() / 2); ++k)
    EXPECT_LT(std::abs(twice.q.c(0, 2 * k) - once.q.c(0, k)), 1e-12);
}

TEST(PeriodicMotion, SaysWhereTheEquationsEnd) {
  NonlinearSystem system = test::duffing({0.1, 0, 0.5});
  const auto whole = system.evaluate;
  system.evaluate = [whole](double p, const MotionSamples& motion, Derivatives wanted,
                            ResidualSamples& samples) -> std::optional<EvaluationFailure> {
    for (Index j = 0; j < motion.num_samples(); ++j)
      if (std::abs(motion.q(0, j)) > 1) return EvaluationFailure{"too far", motion.angle(j)};
    return whole(p, motion, wanted, samples);
  };
  // The only motion reaches 0.5/0.1 = 5.
  const PeriodicMotion motion = solve_periodic_motion(system, 1, {});
  EXPECT_EQ(motion.status, MotionStatus::no_residual);
  ASSERT_TRUE(motion.failure);
  EXPECT_EQ(motion.failure->reason, "too far");
  EXPECT_LE(motion.q.c.cwiseAbs().maxCoeff(), 0.5);
}

// Newton's method from rest, damped, comes to a singular matrix there.
TEST(PeriodicMotion, IsFoundAlongAHomotopyWhereNewtonsMethodFails) {
  const test::Duffing d{0.1, 1, 0.3};
  const NonlinearSystem system = test::duffing(d);
  ASSERT_EQ(solve_periodic_motion(system, 1.1, {}).status, MotionStatus::no_motion);
  const PeriodicMotion motion = find_periodic_motion(system, 1.1, {}, {.tolerance = 1e-10});
  ASSERT_EQ(motion.status, MotionStatus::converged);
  const Index N = 4 * motion.num_harmonics + 2;
  const MatrixXd q = fourier::synthesise(motion.q, N), v = 1.1 * fourier::synthesise(fourier::derivative(motion.q), N),
                 a = 1.21 * fourier::synthesise(fourier::derivative(motion.q, 2), N);
  for (Index j = 0; j < N; ++j) {
    const double x = q(0, j), load = d.force * std::cos(2 * pi * double(j) / double(N));
    EXPECT_NEAR(a(0, j) + d.damping * v(0, j) + x + d.cubic * x * x * x, load, 1e-8);
  }
}

TEST(PeriodicMotion, StopsWhenAsked) {
  int asked = 0;
  const MotionOptions options{.stop = [&] { return ++asked > 1; }};
  EXPECT_EQ(solve_periodic_motion(test::duffing({}), 0.5, {}, options).status, MotionStatus::stopped);
}

TEST(PeriodicMotion, RefusesOptionsThatCannotBe) {
  const NonlinearSystem system = test::duffing({});
  EXPECT_THROW((void)solve_periodic_motion(system, 1, {}, {.tolerance = 0}), std::invalid_argument);
  EXPECT_THROW((void)solve_periodic_motion(system, 1, {}, {.turns = 0}), std::invalid_argument);
  EXPECT_THROW((void)solve_periodic_motion(system, 1, FourierSeries(2, 3)), std::invalid_argument);
  EXPECT_THROW((void)solve_periodic_motion({}, 1, {}), std::invalid_argument);
}

}  // namespace
}  // namespace hb
