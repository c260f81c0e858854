// The error that a residual tells: residuals r = A e of errors e that are known, on the window and beyond.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "hb/engine/steady/steady_bound.hpp"
#include "hb/engine/steady/steady_elimination.hpp"
#include "hb/engine/steady/truncation.hpp"
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

  Window(const ScaledSystem& scaled, Index most)
      : system(steady::weighted(scaled)),
        T(scaled.T * system.weight.cwiseInverse().asDiagonal()),
        A(system, steady::predicted_harmonics(system, 1e-8, most)),
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
    return steady::size_in_q(left, T) / (found.outside + found.rest + 1e-12 * response * steady::size_in_q(e, T));
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
      Window window(scale_system(t.system, t.speed), 60);
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

}  // namespace
}  // namespace hb
