#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hb/engine/nonlinear/continuation.hpp"
#include "hb/engine/nonlinear/motion_stability.hpp"
#include "tests/support/nonlinear_systems.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

double amplitude(const PeriodicMotion& motion) { return 2 * std::abs(motion.q.c(0, 1)); }

std::vector<Bifurcation> of_kind(const Branch& branch, BifurcationKind kind) {
  std::vector<Bifurcation> found;
  for (const Bifurcation& b : branch.bifurcations)
    if (b.kind == kind) found.push_back(b);
  return found;
}

Branch from_rest(const NonlinearSystem& system, double start, const ContinuationOptions& options) {
  return follow_branch(system, solve_periodic_motion(system, start, {}, options.motion), options);
}

// One unknown that depends on p as if at rest, with damping and inertia so that it moves otherwise: speed 1.
template <class Force>
NonlinearSystem at_rest(Force force) {
  return test::differentiated(
      1,
      [force](double p, double, const auto& q, const auto& v, const auto& a) {
        auto r = a;
        r(0) = a(0) + v(0) + force(q(0), p);
        return r;
      },
      [](double) { return 1.0; });
}

// One harmonic: f(X, W) = X ((1 - W + 3/4 b X)^2 + d^2 W) - F^2 = 0 with X = A^2, W = Omega^2; folds where df/dX = 0.
struct OneHarmonic {
  test::Duffing d;
  double f(double X, double W) const {
    const double e = 1 - W + 0.75 * d.cubic * X;
    return X * (e * e + d.damping * d.damping * W) - d.force * d.force;
  }
  double fX(double X, double W) const {
    const double e = 1 - W + 0.75 * d.cubic * X;
    return e * e + d.damping * d.damping * W + 1.5 * d.cubic * X * e;
  }
};

const test::Duffing bent{0.1, 1, 0.3};

TEST(Continuation, FindsTheFoldsOfDuffingsEquationWithOneHarmonic) {
  const NonlinearSystem system = test::duffing(bent);
  const ContinuationOptions options{
      .motion = {.tolerance = 1e-10, .num_harmonics = 1}, .low = 0.5, .high = 3, .stability = false};
  const Branch branch = from_rest(system, 0.5, options);
  ASSERT_EQ(branch.end, BranchEnd::range);
  EXPECT_EQ(branch.points.back().motion.parameter, 3);
  const auto folds = of_kind(branch, BifurcationKind::fold);
  ASSERT_EQ(folds.size(), 2u);
  const OneHarmonic exact{bent};
  for (const Bifurcation& fold : folds) {
    const double A = amplitude(fold.point.motion), Omega = fold.point.motion.parameter;
    // On the curve, and where its slope is infinite: the second to the square root of what the first is good for.
    EXPECT_NEAR(exact.f(A * A, Omega * Omega), 0, 1e-10);
    const double h = 1e-6;
    const double fW = (exact.f(A * A, Omega * Omega + h) - exact.f(A * A, Omega * Omega - h)) / (2 * h);
    const double fXX = (exact.fX(A * A + h, Omega * Omega) - exact.fX(A * A - h, Omega * Omega)) / (2 * h);
    // The fold lies fX^2/(2 fXX fW) beside this point in W = Omega^2.
    const double off = std::pow(exact.fX(A * A, Omega * Omega), 2) / std::abs(2 * fXX * fW) / (2 * Omega);
    EXPECT_LE(off, 1e-8 * Omega);
    // That one harmonic is not the motion is part of the error.
    EXPECT_GT(fold.parameter_error, 1e-4);
  }
  for (const BranchPoint& point : branch.points)
    EXPECT_NEAR(exact.f(std::pow(amplitude(point.motion), 2), std::pow(point.motion.parameter, 2)), 0, 1e-9);
}

TEST(Continuation, PassesEveryStopOnAllThreeSheets) {
  const NonlinearSystem system = test::duffing(bent);
  const ContinuationOptions options{.motion = {.tolerance = 1e-10, .num_harmonics = 1},
                                    .low = 0.5,
                                    .high = 3,
                                    .stops = {1.6, 2.9},
                                    .stability = false};
  const Branch branch = from_rest(system, 0.5, options);
  std::vector<double> amplitudes;
  for (const BranchPoint& point : branch.points)
    if (point.motion.parameter == 1.6) amplitudes.push_back(amplitude(point.motion));
  ASSERT_EQ(amplitudes.size(), 3u);
  EXPECT_GT(amplitudes[0], amplitudes[1]);
  EXPECT_GT(amplitudes[1], amplitudes[2]);
  const OneHarmonic exact{bent};
  for (const double A : amplitudes) EXPECT_NEAR(exact.f(A * A, 1.6 * 1.6), 0, 1e-10);
  EXPECT_EQ(std::count_if(branch.points.begin(), branch.points.end(),
                          [](const BranchPoint& p) { return p.motion.parameter == 2.9 && p.stop; }),
            1);
  for (std::size_t i = 1; i < branch.points.size(); ++i) EXPECT_GT(branch.points[i].arc, branch.points[i - 1].arc);
}

TEST(Continuation, BothDirectionsAndARestartFindTheSameFolds) {
  const NonlinearSystem system = test::duffing(bent);
  ContinuationOptions options{.motion = {.tolerance = 1e-10}, .low = 0.5, .high = 3, .stability = false};
  const Branch up = from_rest(system, 0.5, options);
  options.direction = -1;
  const Branch down = from_rest(system, 3, options);
  const auto folds_up = of_kind(up, BifurcationKind::fold), folds_down = of_kind(down, BifurcationKind::fold);
  ASSERT_EQ(folds_up.size(), 2u);
  ASSERT_EQ(folds_down.size(), 2u);
  for (int i : {0, 1})
    EXPECT_NEAR(folds_up[std::size_t(i)].point.motion.parameter, folds_down[std::size_t(1 - i)].point.motion.parameter,
                3e-8);
  const Branch rest = follow_branch(system, up.points[folds_up[0].after - 2], options);
  EXPECT_EQ(of_kind(rest, BifurcationKind::fold).size(), 2u);
  const Branch back = follow_branch(system, reversed(up.points[folds_up[0].after + 2]), options);
  const auto fold_back = of_kind(back, BifurcationKind::fold);
  ASSERT_EQ(fold_back.size(), 1u);
  EXPECT_NEAR(fold_back[0].point.motion.parameter, folds_up[0].point.motion.parameter, 3e-8);
  EXPECT_EQ(back.points.back().motion.parameter, 0.5);
}

TEST(Continuation, BetweenTheFoldsTheMotionIsUnstable) {
  const NonlinearSystem system = test::duffing(bent);
  const Branch branch = from_rest(system, 0.5, {.motion = {.tolerance = 1e-9}, .low = 0.5, .high = 2.4});
  ASSERT_EQ(branch.end, BranchEnd::range);
  const auto folds = of_kind(branch, BifurcationKind::fold);
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_EQ(branch.bifurcations.size(), 2u);
  for (std::size_t i = 0; i < branch.points.size(); ++i) {
    ASSERT_TRUE(branch.points[i].stability);
    const bool inside = i > folds[0].after && i <= folds[1].after;
    EXPECT_EQ(branch.points[i].stability->verdict, inside ? Verdict::unstable : Verdict::stable) << "point " << i;
    // Liouville: the exponents add up to minus the damping.
    const auto& exponents = branch.points[i].stability->exponents;
    ASSERT_EQ(exponents.size(), 2u);
    EXPECT_NEAR((exponents[0].value + exponents[1].value).real(), -bent.damping, 1e-9);
  }
  // At a fold an exponent is 0, up to the square root of what its parameter is good for.
  for (const Bifurcation& fold : folds) EXPECT_NEAR(motion_stability(system, fold.point.motion).growth_rate, 0, 1e-3);
}

// The circle q^2 + p^2 = 1.
TEST(Continuation, ComesBackToItsStartOnAClosedBranch) {
  const NonlinearSystem system = at_rest([](const auto& q, double p) { return q * q + p * p - 1.0; });
  FourierSeries start(1, 1);
  start.c(0, 0) = 1;
  ContinuationOptions options{.low = -2, .high = 2, .parameter_scale = 1, .motion_scale = 1, .stability = false};
  const Branch branch = follow_branch(system, solve_periodic_motion(system, 0, start, options.motion), options);
  EXPECT_EQ(branch.end, BranchEnd::closed);
  const auto folds = of_kind(branch, BifurcationKind::fold);
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_NEAR(folds[0].point.motion.parameter, 1, 1e-8);
  EXPECT_NEAR(folds[1].point.motion.parameter, -1, 1e-8);
  for (const BranchPoint& point : branch.points)
    EXPECT_NEAR(std::pow(point.motion.q.c(0, 0).real(), 2) + std::pow(point.motion.parameter, 2), 1, 1e-7);
}

TEST(Continuation, FindsAndSwitchesAtAPitchfork) {
  const NonlinearSystem system = at_rest([](const auto& q, double p) { return q * q * q - p * q; });
  ContinuationOptions options{.motion = {.tolerance = 1e-10}, .low = -0.5, .high = 0.5, .motion_scale = 1};
  const Branch branch = from_rest(system, -0.5, options);
  ASSERT_EQ(branch.end, BranchEnd::range);
  ASSERT_EQ(branch.bifurcations.size(), 1u);
  EXPECT_EQ(branch.bifurcations[0].kind, BifurcationKind::branch_point);
  EXPECT_NEAR(branch.bifurcations[0].point.motion.parameter, 0, 1e-8);
  const std::vector<BranchPoint> others = branches_at(system, branch.bifurcations[0], options);
  ASSERT_EQ(others.size(), 2u);
  EXPECT_LT(others[0].motion.q.c(0, 0).real() * others[1].motion.q.c(0, 0).real(), 0);
  for (const BranchPoint& other : others) {
    const Branch side = follow_branch(system, other, options);
    EXPECT_EQ(side.end, BranchEnd::range);
    EXPECT_NEAR(std::pow(side.points.back().motion.q.c(0, 0).real(), 2), 0.5, 1e-8);
    EXPECT_EQ(side.points.back().stability->verdict, Verdict::stable);
  }
}

// x'' - p x' + 2 x + x^3: exponents p/2 +- i sqrt(2 - p^2/4) at rest.
TEST(Continuation, FindsANeimarkSackerPoint) {
  const NonlinearSystem system = test::differentiated(
      1,
      [](double p, double, const auto& q, const auto& v, const auto& a) {
        auto r = a;
        r(0) = a(0) - p * v(0) + 2.0 * q(0) + q(0) * q(0) * q(0);
        return r;
      },
      [](double) { return 1.0; });
  const Branch branch = from_rest(system, -0.3, {.low = -0.3, .high = 0.4, .motion_scale = 1});
  ASSERT_EQ(branch.bifurcations.size(), 1u);
  EXPECT_EQ(branch.bifurcations[0].kind, BifurcationKind::neimark_sacker);
  EXPECT_NEAR(branch.bifurcations[0].point.motion.parameter, 0, 1e-8);
}

HillSystem mathieu(const test::VibratedPendulum& s) {
  HillSystem hill;
  hill.mass = MatrixXd::Identity(1, 1);
  hill.damping = MatrixXd::Constant(1, 1, s.damping);
  hill.stiffness[0] = FourierSeries(1, 1);
  hill.stiffness[0].c << 1, s.depth / 2;
  return hill;
}

TEST(Continuation, ThePendulumsRestDoublesItsPeriodAtTheEdgesOfMathieusTongue) {
  const test::VibratedPendulum pendulum{.damping = 0.1, .depth = 0.5};
  const NonlinearSystem system = test::vibrated_pendulum(pendulum);
  ContinuationOptions options{.motion = {.tolerance = 1e-9}, .low = 1.5, .high = 2.6, .motion_scale = 1};
  const Branch branch = from_rest(system, 1.5, options);
  const auto doublings = of_kind(branch, BifurcationKind::period_doubling);
  ASSERT_EQ(doublings.size(), 2u);
  for (const Bifurcation& doubling : doublings) {
    const double Omega = doubling.point.motion.parameter, error = 1e-7;
    const double before = analyse_stability(mathieu(pendulum), Omega - error).growth_rate;
    const double after = analyse_stability(mathieu(pendulum), Omega + error).growth_rate;
    EXPECT_LT(before * after, 0) << "at " << Omega;
  }

  // Of the swinging motion q^2 grows in proportion to the distance from where it begins.
  options.motion.turns = 2;
  options.motion_scale = 0;
  std::vector<BranchPoint> swinging = branches_at(system, doublings[1], options);
  ASSERT_EQ(swinging.size(), 1u);
  EXPECT_EQ(swinging[0].motion.turns, 2);
  const double begin = doublings[1].point.motion.parameter;
  options.stops = {begin - 1e-3, begin - 2e-3};
  const Branch branch2 = follow_branch(system, swinging[0], options);
  std::vector<double> squares;
  for (const Branch& part : {branch2, follow_branch(system, reversed(swinging[0]), options)})
    for (const BranchPoint& point : part.points)
      if (point.stop && std::abs(point.motion.parameter - begin) < 3e-3) {
        squares.push_back(std::norm(point.motion.q.c(0, 1)));
        // Half the frequency alone: odd harmonics of it.
        EXPECT_LT(std::abs(point.motion.q.c(0, 2)), 1e-9);
      }
  ASSERT_GE(squares.size(), 2u);
  std::sort(squares.begin(), squares.end());
  EXPECT_NEAR(squares.back() / squares.front(), 2, 0.02);
}

// Damping that grows with the swing holds the motion between both edges of the tongue.
TEST(Continuation, ADoubledBranchEndsWhereItJoinsTheMotionItLeft) {
  const NonlinearSystem system =
      test::differentiated(1, [](double, double tau, const auto& q, const auto& v, const auto& a) {
        auto r = a;
        r(0) = a(0) + (0.1 + q(0) * q(0)) * v(0) + (1 + 0.5 * std::cos(tau)) * q(0);
        return r;
      });
  ContinuationOptions options{.motion = {.tolerance = 1e-8}, .low = 1.5, .high = 2.6, .motion_scale = 1};
  const Branch branch = from_rest(system, 1.5, options);
  const auto doublings = of_kind(branch, BifurcationKind::period_doubling);
  ASSERT_EQ(doublings.size(), 2u);
  const std::vector<BranchPoint> starts = branches_at(system, doublings[0], options);
  ASSERT_EQ(starts.size(), 1u);
  options.motion.turns = 2;
  const Branch doubled = follow_branch(system, starts[0], options);
  EXPECT_EQ(doubled.end, BranchEnd::joined);
  EXPECT_NEAR(doubled.points.back().motion.parameter, doublings[1].point.motion.parameter, 0.02);
  for (const BranchPoint& point : doubled.points) EXPECT_EQ(point.stability->verdict, Verdict::stable);
}

TEST(Continuation, SaysWhyAndWhereABranchEnds) {
  NonlinearSystem system = test::duffing({0.1, 0, 0.1});
  const auto whole = system.evaluate;
  system.evaluate = [whole](double p, const MotionSamples& motion, Derivatives wanted,
                            ResidualSamples& samples) -> std::optional<EvaluationFailure> {
    for (Index j = 0; j < motion.num_samples(); ++j)
      if (std::abs(motion.q(0, j)) > 0.5) return EvaluationFailure{"too far", motion.angle(j)};
    return whole(p, motion, wanted, samples);
  };
  // |q| = 0.1/|1 - Omega^2 + 0.1 i Omega| reaches 0.5 at Omega^2 = 0.81 or so.
  const ContinuationOptions options{.low = 0.1, .high = 2, .stability = false};
  const Branch branch = from_rest(system, 0.1, options);
  EXPECT_EQ(branch.end, BranchEnd::no_residual);
  ASSERT_TRUE(branch.failure);
  EXPECT_EQ(branch.failure->reason, "too far");
  const double Omega2 = std::pow(branch.points.back().motion.parameter, 2);
  const double reached = 0.1 / std::sqrt(std::pow(1 - Omega2, 2) + 0.01 * Omega2);
  // The samples that are looked at lie beside the peak.
  EXPECT_NEAR(reached, 0.5, 0.01);
}

TEST(Continuation, EndsOnItsLimits) {
  const NonlinearSystem system = test::duffing(bent);
  ContinuationOptions options{.low = 0.5, .high = 3, .max_points = 7, .stability = false};
  const Branch few = from_rest(system, 0.5, options);
  EXPECT_EQ(few.end, BranchEnd::points);
  EXPECT_EQ(few.points.size(), 7u);
  options.max_points = 1000;
  int asked = 0;
  options.stop = [&] { return ++asked > 100; };
  const Branch stopped = from_rest(system, 0.5, options);
  EXPECT_EQ(stopped.end, BranchEnd::stopped);
  EXPECT_GT(stopped.points.size(), 1u);
  EXPECT_THROW((void)from_rest(system, 0.5, {.low = 3, .high = 0.5}), std::invalid_argument);
}

TEST(Continuation, IsTheSameToTheLastBitInEveryRun) {
  const NonlinearSystem system = test::duffing(bent);
  const ContinuationOptions options{.low = 0.5, .high = 3};
  const Branch first = from_rest(system, 0.5, options), second = from_rest(system, 0.5, options);
  ASSERT_EQ(first.points.size(), second.points.size());
  for (std::size_t i = 0; i < first.points.size(); ++i) {
    EXPECT_EQ(first.points[i].motion.parameter, second.points[i].motion.parameter);
    EXPECT_EQ((first.points[i].motion.q.c - second.points[i].motion.q.c).cwiseAbs().maxCoeff(), 0);
    EXPECT_EQ(first.points[i].stability->growth_rate, second.points[i].stability->growth_rate);
  }
}

}  // namespace
}  // namespace hb
