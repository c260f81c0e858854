#include "hb/engine/exponents/slaving.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "hb/engine/exponents/slaving_iteration.hpp"
#include "hb/engine/system/stiffness_samples.hpp"
#include "lib/constants.hpp"
#include "lib/modulus.hpp"
#include "lib/workspace.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;
using slaving::Iteration;
using slaving::Partition;

namespace {

// Largest sum of harmonics of K_SF A and weight K_SF C that N angles do not tell apart, by what A and C are:
// Iteration's `solution`.
double folded_back(const ScaledSystem& system, const Partition& p, const VectorXd& solution, Index N) {
  const Index n = Index(p.F.size()), nm = n * Index(p.S.size()), H = solution.size() / (4 * nm) - 1;
  const Index P = system.K.num_harmonics(), apart = (N - 1) / 2;
  if (P + H <= apart) return 0;
  // Of A and weight C, from each harmonic on.
  thread_local Workspace kept;
  auto room = kept.matrix(2 * nm, H + 3);
  auto from = room.leftCols(H + 2);
  auto sum = room.col(H + 2);
  from.col(H + 1).setZero();
  for (Index k = H; k >= 0; --k) {
    const auto re = solution.segment(4 * nm * k, 2 * nm).array(),
               im = solution.segment(4 * nm * k + 2 * nm, 2 * nm).array();
    from.col(k) = from.col(k + 1).array() + (re.square() + im.square()).sqrt();
  }
  double largest = 0;
  for (const Index s : p.S) {
    sum.setZero();
    for (Index k = std::max<Index>(apart + 1 - H, 0); k <= P; ++k)
      for (Index j = 0; j < n; ++j) {
        const double size = modulus(system.K.c(s + system.num_modes() * p.F[std::size_t(j)], k));
        for (Index q = j; q < 2 * nm; q += n) sum(q) += size * from(q, std::max<Index>(apart + 1 - k, 0));
      }
    largest = std::max(largest, sum.sum());
  }
  return 4 * largest;
}

// At so many angles is judged what N gave: more, and so many that alpha and beta are not folded back. Where damping
// couples they depend on P and R, which have more harmonics.
Index judging_samples(const ScaledSystem& system, const Partition& p, const VectorXd& solution, Index N) {
  double scale = 0;
  for (const Index s : p.S) scale = std::max(scale, std::abs(system.K.c(s + system.num_modes() * s, 0)));
  N = system.diagonal_damping ? fourier::fast_length(N + 1) : 2 * N;
  while (solution.size() > 0 && folded_back(system, p, solution, N) > eps * scale) N = fourier::fast_length(N + 1);
  return N;
}

// All modes kept, in their own order.
ReducedSystem unreduced(const ScaledSystem& system) {
  const Index I = system.num_modes();
  ReducedSystem all;
  all.converged = true;
  all.others_below = -HUGE_VAL;
  all.start = MatrixXd::Identity(2 * I, 2 * I);
  all.num_modes = I;
  all.beta = FourierSeries(I * I, 0);
  all.beta.c.col(0).real() = system.G.reshaped();
  all.alpha_error = slaving::given_rounding * system.K_rounding;
  all.beta_error = 2 * eps * system.G.cwiseAbs() + system.G_error;
  all.alpha = slaving::without_tail(system.K.c.transpose(), all.alpha_error);
  return all;
}

}  // namespace

const SampledStiffness::Samples& SampledStiffness::at(Index num_samples) {
  const auto [place, is_new] = samples_.try_emplace(num_samples);
  if (is_new) {
    place->second.K = stiffness_samples(system_, num_samples);
    place->second.largest = place->second.K.cwiseAbs().colwise().maxCoeff();
  }
  return place->second;
}

ReducedSystem slave_to(const ScaledSystem& system, std::span<const Index> slow, double tolerance) {
  SampledStiffness stiffness(system);
  return slave_to(stiffness, slow, tolerance, true);
}

ReducedSystem slave_to(SampledStiffness& stiffness, std::span<const Index> slow, double tolerance, bool bounds_others,
                       const SlavingStart& begun) {
  const ScaledSystem& system = stiffness.system();
  const Index I = system.num_modes();
  const Partition p = slaving::partition(I, slow);
  if (p.F.empty()) return unreduced(system);
  ReducedSystem reduced;
  // Few samples for the iteration; more judge what it gave.
  constexpr Index fewest_samples = 32, most_samples = 8192;
  const Index start = fourier::fast_length(std::max(2 * system.K.num_harmonics() + 4, fewest_samples));
  const auto finish = [&](Iteration& iteration) {
    const int iterations = reduced.iterations;
    if (bounds_others) iteration.see_shifted_resonances();
    reduced = iteration.result(bounds_others);
    reduced.iterations = iterations;
  };
  // As many samples as the neighbour's harmonics were found with.
  const auto numbers = [&](Index N) { return 4 * Index(p.F.size() * p.S.size()) * ((N - 1) / 2 + 1); };
  Index own = start;
  while (numbers(own) < begun.solution.size()) own = fourier::fast_length(own + 1);
  // A neighbour's solution is judged by more samples from the beginning; what needs more corrections gets them
  // with few samples.
  SlavingStart nearer;
  const Index begun_judge = begun.rough ? own : judging_samples(system, p, begun.solution, own);
  const bool may_begin = begun.solution.size() > 0 && own <= 4 * start && begun_judge <= most_samples;
  if (may_begin && begun.rough) {
    nearer = begun;
  } else if (may_begin) {
    constexpr int few_iterations = 4;
    Iteration judged(stiffness, p, begun_judge);
    judged.start_from(begun);
    if (judged.run(std::max(1e-13, tolerance), reduced.iterations, few_iterations)) {
      finish(judged);
      return reduced;
    }
    nearer = judged.solved();
  }
  const auto solve = [&](const SlavingStart& from) {
    Index N = from.solution.size() > 0 ? own : start;
    std::optional<Iteration> iteration(std::in_place, stiffness, p, N);
    iteration->start_from(from);
    while (N <= 4 * start && iteration->run(tolerance, reduced.iterations)) {
      const SlavingStart coarse = iteration->solved();
      N = judging_samples(system, p, coarse.solution, N);
      if (N > most_samples) break;
      iteration.emplace(stiffness, p, N);
      iteration->refine(coarse);
      if (!iteration->solved_by_start(tolerance)) continue;
      finish(*iteration);
      return true;
    }
    return false;
  };
  if (nearer.solution.size() == 0 || !nearer.solution.allFinite() || !solve(nearer)) solve({});
  return reduced;
}

VectorXd resonance_strength(const ScaledSystem& system, std::span<const Index> slow) {
  const Index I = system.num_modes(), P = system.K.num_harmonics();
  const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  VectorXd strength = VectorXd::Constant(I, -1);
  for (const Index j : slaving::partition(I, slow).F) {
    strength(j) = 0;
    for (const Index s : slow) {
      const cplx lambda = slaving::root(b(s), w2(s));
      for (Index k = -P; k <= P; ++k) {
        const cplx z = lambda + cplx(0, double(k));
        const double coupling =
            modulus(system.K.c(s + I * j, std::abs(k))) * modulus(system.K.c(j + I * s, std::abs(k))) +
            std::abs(system.G(s, j) * system.G(j, s)) * (k == 0 ? std::norm(z) : 0);
        const double denominator = modulus(z * z + b(j) * z + w2(j)) * std::max(std::abs(2.0 * lambda + b(s)), 1e-3);
        strength(j) = std::max(strength(j), coupling / std::max(denominator, 1e-300));
      }
    }
  }
  return strength;
}

}  // namespace hb
