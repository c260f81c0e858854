// The error that a residual tells: residuals r = A e of errors e that are known, on the window and beyond.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "hb/engine/steady/steady_bound.hpp"
#include "hb/engine/steady/steady_elimination.hpp"
#include "hb/engine/steady/truncation.hpp"
#include "lib/modulus.hpp"
#include "tests/support/random_hill_system.hpp"

namespace hb {
namespace {

using Eigen::Index;
using steady::Spectrum;

Spectrum random_error(Index H, Index I, double decay, stress::Random& random) {
  Spectrum e(H + 1, I);
  for (Index i = 0; i < I; ++i)
    for (Index k = 0; k <= H; ++k) {
      const double size = std::exp(-decay * double(k));
      e(k, i) = {size * random(-1, 1), k > 0 ? size * random(-1, 1) : 0};
    }
  return e;
}

struct Window {
  steady::WeightedSystem system;
  Eigen::MatrixXd T;
  steady::Operator A;
  std::unique_ptr<steady::EliminatedInverse> inverse;
  double response;

  // By default as many harmonics as a tolerance of 1e-8 takes.
  explicit Window(const ScaledSystem& scaled, Index harmonics = -1)
      : system(steady::weighted(scaled)),
        T(scaled.T * system.weight.cwiseInverse().asDiagonal()),
        A(system, harmonics < 0 ? steady::predicted_harmonics(system, 1e-8, 60) : harmonics),
        inverse(steady::eliminate(A)),
        response(inverse->regular() ? steady::response(A, *inverse, T) : HUGE_VAL) {}

  // A e, rows beyond the window too, for e with harmonics up to `last_row` of A at most.
  Spectrum image(const Spectrum& e) {
    Spectrum r;
    steady::Operator wide(system, e.rows() - 1);
    wide.couple(e, wide.last_row(), r);
    r.topRows(e.rows()) += wide.D().cwiseProduct(e);
    return r;
  }

  // Largest of all components of what is left of e over what is claimed.
  double uncovered(const Spectrum& e, double negligible) {
    const steady::Correction found =
        steady::correction(A, *inverse, image(e), response, T, HUGE_VAL, negligible * steady::size_in_q(e, T));
    Spectrum left = e;
    left.topRows(A.num_harmonics() + 1) -= found.window;
    return steady::size_in_q(left, T) /
           (found.outside + found.beyond + found.rest + 1e-12 * response * steady::size_in_q(e, T));
  }
};

// In the direction nearest to resonance, a mixture, decaying, and beyond the window; told by several steps or one.
TEST(ErrorChain, ClaimsCoverErrorsThatAreKnown) {
  for (int family = 0; family < stress::num_families; ++family) {
    if (stress::Family(family) == stress::Family::many_harmonics) continue;
    double closest = 0;
    for (int trial = 0; trial < stress::multiplied(6); ++trial) {
      stress::Random random(stress::seed() * 7919 + std::uint64_t(trial) * 131 + std::uint64_t(family));
      stress::Trial t = stress::random_trial(stress::Family(family), random, 4);
      t.system.load[0] = FourierSeries(t.system.num_modes(), 2);
      t.system.load[0].c.setOnes();
      Window window(scale_system(t.system, t.speed));
      if (!(window.response < 1e6)) continue;
      const Index H = window.A.num_harmonics(), I = window.system.I;
      Spectrum near = random_error(H, I, 0, random), next;
      for (int step = 0; step < 3; ++step) {
        window.inverse->solve(near, 1e-3, next);
        near = next / next.cwiseAbs().maxCoeff();
      }
      const Index beyond = std::max(H, std::min(window.A.last_row(), H + 4));
      // Beyond the window, and what answers it there: no residual on the window.
      Spectrum answered = random_error(beyond, I, 0.3, random);
      answered.topRows(H + 1).setZero();
      window.inverse->solve(window.image(answered).topRows(H + 1), 1e-14, next);
      answered.topRows(H + 1) = -next;
      for (const Spectrum& e : {near, random_error(H, I, 0, random), random_error(H, I, 0.5, random),
                                random_error(beyond, I, 0.3, random), answered})
        for (const double negligible : {0.0, 1e-6, 0.1, HUGE_VAL}) {
          const double over = window.uncovered(e, negligible);
          closest = std::max(closest, over);
          EXPECT_LE(over, 1) << "family " << family << " trial " << trial << " H " << H << " response "
                             << window.response << " negligible " << negligible << " rows " << e.rows();
        }
    }
    RecordProperty("largest error over claim of family " + std::to_string(family), std::to_string(closest));
  }
}

// One or two modes of which the last is in resonance at the window's end: the tail's answer comes back larger than it
// was.
ScaledSystem resonant_at(Index H, stress::Random& random) {
  const Index I = random.integer(1, 2), P = random.integer(1, 3);
  HillSystem system;
  system.mass = Eigen::MatrixXd::Identity(I, I);
  system.damping = Eigen::MatrixXd::Zero(I, I);
  system.stiffness[0] = FourierSeries(I * I, P);
  const double coupling = std::pow(10, random(-2, 0.5));
  for (Index i = 0; i < I; ++i) {
    const double off = std::pow(10, random(-6, -1)) * (random(-1, 1) > 0 ? 1 : -1);
    const double w = i == I - 1 ? double(H - random.integer(0, 1)) + off : random(0.3, double(H));
    system.stiffness[0].c(i + I * i, 0) = w * w;
    system.damping(i, i) = std::pow(10, random(-7, -2));
    for (Index k = 1; k <= P; ++k)
      for (Index j = 0; j <= i; ++j)
        system.stiffness[0].c(i + I * j, k) = system.stiffness[0].c(j + I * i, k) = coupling * random(-1, 1);
  }
  system.load[0] = FourierSeries(I, 1);
  system.load[0].c.setOnes();
  return scale_system(system, 1);
}

// Residuals on the window, on all rows, and beyond it only; `negligible` just above the first step.
TEST(ErrorChain, ClaimsCoverWhatAnswersBesideAResonance) {
  stress::Random random(stress::seed() * 104729);
  int told = 0;
  for (int trial = 0; trial < stress::multiplied(300); ++trial) {
    const Index H = random.integer(3, 11);
    const ScaledSystem scaled = resonant_at(H, random);
    Window window(scaled, H), wide(scaled, H + 44);
    if (!(window.response < 1e7) || !wide.inverse->regular()) continue;
    const Index I = window.system.I, R = window.A.last_row();
    for (const Index first : {Index(0), H + 1}) {
      Spectrum r = random_error(R, I, 0, random), e, z, step(R + 1, I), padded = Spectrum::Zero(H + 45, I);
      r.topRows(first).setZero();
      padded.topRows(R + 1) = r;
      wide.inverse->solve(padded, 1e-13, e);
      window.inverse->solve(r.topRows(H + 1), 1e-12, z);
      step.topRows(H + 1) = z;
      for (Index k = H + 1; k <= R; ++k)
        for (Index i = 0; i < I; ++i) step(k, i) = r(k, i) / window.system.D(i, k);
      for (const double times : {0.0, 1.05, 30.0}) {
        const steady::Correction found = steady::correction(window.A, *window.inverse, r, window.response, window.T,
                                                            HUGE_VAL, times * steady::size_in_q(step, window.T));
        if (!std::isfinite(found.rest)) continue;
        Spectrum left = e;
        left.topRows(H + 1) -= found.window;
        ++told;
        EXPECT_LE(steady::size_in_q(left, window.T), found.outside + found.beyond + found.rest)
            << "trial " << trial << " H " << H << " response " << window.response << " times " << times << " rows from "
            << first;
      }
    }
  }
  EXPECT_GT(told, stress::multiplied(300));
}

// A residual without a direction of its own counts by its size, and a tail below it by norms; with the response that it
// has, where the estimate misses that (as it then does for rounding).
TEST(ErrorChain, ClaimsCoverResidualsAsGoodAsRounding) {
  stress::Random random(stress::seed() * 15485863);
  int told = 0, trials = 0;
  for (int family = 0; family < stress::num_families; ++family) {
    if (stress::Family(family) == stress::Family::many_harmonics) continue;
    for (int trial = 0; trial < stress::multiplied(6); ++trial) {
      stress::Trial t = stress::random_trial(stress::Family(family), random, 4);
      t.system.load[0] = FourierSeries(t.system.num_modes(), 2);
      t.system.load[0].c.setOnes();
      const ScaledSystem scaled = scale_system(t.system, t.speed);
      Window window(scaled);
      const Index H = window.A.num_harmonics(), I = window.system.I;
      Window wide(scaled, H + 2 * window.system.P + 8);
      if (!(window.response < 1e6) || !wide.inverse->regular()) continue;
      Spectrum r = random_error(window.A.last_row(), I, 0, random), padded, e, own;
      window.inverse->solve(r.topRows(H + 1), 1e-12, own);
      const double response =
          std::max(window.response, 3 * steady::size_in_q(own, window.T) /
                                        steady::amplified(window.A, moduli(r.topRows(H + 1)), 1, window.T));
      r.bottomRows(r.rows() - H - 1) *= std::pow(10, random(-6, 0));
      padded = Spectrum::Zero(wide.A.num_harmonics() + 1, I);
      padded.topRows(r.rows()) = r;
      wide.inverse->solve(padded, 1e-13, e);
      const steady::Correction found =
          steady::correction(window.A, *window.inverse, r, response, window.T, HUGE_VAL, 0, HUGE_VAL);
      ++trials;
      if (found.window.cwiseAbs().maxCoeff() > 0) continue;
      ++told;
      EXPECT_LE(steady::size_in_q(e, window.T), found.outside + found.beyond + found.rest)
          << "family " << family << " trial " << trial << " H " << H << " response " << response;
    }
  }
  EXPECT_GT(told, trials / 2);
}

}  // namespace
}  // namespace hb
