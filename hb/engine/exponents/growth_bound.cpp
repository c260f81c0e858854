#include "hb/engine/exponents/growth_bound.hpp"

#include <cmath>
#include <vector>

#include "hb/engine/system/stiffness_samples.hpp"
#include "lib/dense.hpp"

namespace hb {

namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Weights v > 0 that make max_j (M v)_j/v_j small, M >= 0 off the diagonal: inverse iteration with that quotient, which
// is never below the largest eigenvalue (Collatz, Wielandt), as shift.
VectorXd perron_vector(const MatrixXd& M) {
  constexpr int iterations = 6;
  const Index n = M.rows();
  if (n == 1) return VectorXd::Ones(1);
  VectorXd v = VectorXd::Ones(n);
  for (int i = 0; i < iterations; ++i) {
    const double quotient = (M * v).cwiseQuotient(v).maxCoeff();
    const double shift = quotient + 1e-3 * M.cwiseAbs().maxCoeff() / double(n) + 1e-300;
    const VectorXd next = dense::Lu<double>(shift * MatrixXd::Identity(n, n) - M).solve(v);
    const double largest = next.maxCoeff();
    if (!(next.minCoeff() > 0 && std::isfinite(largest))) break;
    // A mode that nothing pulls at keeps some weight.
    v = (next / largest).cwiseMax(1e-12);
  }
  return v;
}

// Each mode's amplitude over the turn. A coupling k from mode i to mode j changes it by |k| out_j in_i, one of y1' by
// |nu| slope_j in_i.
struct Amplitudes {
  MatrixXd own, in, out, slope;  // N x n; own: its growth by itself

  void resize(Index N, Index n) {
    for (MatrixXd* each : {&own, &in, &out, &slope}) each->resize(N, n);
  }
};

// Kept by each thread from one bound to the next.
struct Memory {
  Amplitudes amplitudes;
  std::vector<Index> vibrate;
  MatrixXd W2, L, pulls, mean;
  ArrayXd largest, row;
};

// Of a mode that vibrates throughout, from samples of W^2 and of L' and L'', L = ln W.
template <class Square, class Slope>
void vibrating(Amplitudes& of, Index j, double b, const Square& W2, const Slope& L1, const Slope& L2) {
  auto in = of.in.col(j).array();
  const ArrayXd W = W2.sqrt();
  in = W.sqrt().inverse();
  of.out.col(j) = of.in.col(j);
  of.own.col(j).array() = -b / 2 + (0.5 * L2 - 0.25 * L1.square()).abs() / (2 * W);
  of.slope.col(j).array() = in * (W + (b / 2 + L1 / 2).abs());
}

// Of an overdamped one, along its two mean roots.
template <class Stiffness>
void overdamped(Amplitudes& of, Index j, double b, const Stiffness& k) {
  const double mean = k.mean(), root = std::sqrt(b * b / 4 - mean);
  const double r2 = -b / 2 - root, r1 = b > 0 ? mean / r2 : -b / 2 + root;
  const ArrayXd d = (k - mean) / (2 * root);
  of.own.col(j) = (r1 - d).max(r2 + d);
  of.in.col(j).setConstant(std::sqrt(2 / root));
  of.out.col(j).setConstant(1 / std::sqrt(2 * root));
  of.slope.col(j).setConstant(std::max(std::abs(r1), std::abs(r2)) / std::sqrt(2 * root));
}

// First and second derivative of the samples in the columns, those of L1 after one another, then those of L2.
Eigen::Map<MatrixXd> derivatives(const MatrixXd& samples) {
  const Index N = samples.rows(), n = samples.cols(), H = (N - 1) / 2;
  fourier::RealTransform& one = fourier::thread_transform(N, n);
  one.samples() = samples;
  one.forward();
  const auto given = one.spectrum();
  fourier::RealTransform& both = fourier::thread_transform(N, 2 * n);
  auto spectrum = both.spectrum();
  for (Index j = 0; j < n; ++j) {
    for (Index k = 0; k <= H; ++k) {
      const double m = double(k);
      spectrum(k, j) = {-m * given(k, j).imag(), m * given(k, j).real()};
      spectrum(k, n + j) = -m * m * given(k, j);
    }
    spectrum.col(j).tail(N / 2 - H).setZero();
    spectrum.col(n + j).tail(N / 2 - H).setZero();
  }
  both.backward();
  return both.samples();
}

// False where W^2 comes near zero.
bool find_amplitudes(const SampledSystem& system, Memory& memory) {
  const Index N = system.stiffness.rows(), n = system.damping.size();
  auto& [found, vibrate, W2, L, pulls, mean_pulls, largest, row] = memory;
  found.resize(N, n);
  vibrate.clear();
  for (Index j = 0; j < n; ++j) {
    const auto k = system.stiffness.col(j + n * j).array();
    const double b = system.damping(j), mean = k.mean() - b * b / 4;
    if (k.minCoeff() - b * b / 4 > 1e-3 * std::abs(mean))
      vibrate.push_back(j);
    else if (mean < 0)
      overdamped(found, j, b, k);
    else
      return false;
  }
  if (vibrate.empty()) return true;
  const Index count = Index(vibrate.size());
  W2.resize(N, count);
  L.resize(N, count);
  for (Index c = 0; c < count; ++c) {
    const Index j = vibrate[std::size_t(c)];
    const double b = system.damping(j);
    W2.col(c).array() = system.stiffness.col(j + n * j).array() - b * b / 4;
  }
  L.array() = 0.5 * W2.array().log();
  const auto slopes = derivatives(L);
  for (Index c = 0; c < count; ++c) {
    const Index j = vibrate[std::size_t(c)];
    vibrating(found, j, system.damping(j), W2.col(c).array(), slopes.col(c).array(), slopes.col(count + c).array());
  }
  return true;
}

}  // namespace

double growth_bound(const SampledSystem& system) {
  const Index N = system.stiffness.rows(), n = system.damping.size();
  thread_local Memory memory;
  if (!find_amplitudes(system, memory)) return HUGE_VAL;
  const auto& [own, in, out, slope] = memory.amplitudes;
  MatrixXd &pulls = memory.pulls, &mean = memory.mean;
  pulls.resize(N, n * n);
  mean.resize(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      auto pull = pulls.col(j + n * i).array();
      if (i == j)
        pull.setZero();
      else
        pull = system.stiffness.col(j + n * i).array().abs() * out.col(j).array() * in.col(i).array();
      if (system.cross.size() > 0)
        pull += system.cross.col(j + n * i).array().abs() * slope.col(j).array() * in.col(i).array();
      mean(j, i) = pull.mean() + (i == j ? own.col(j).mean() : 0);
    }
  const VectorXd perron = perron_vector(mean);
  // The largest row varies over the turn; powers of the weights leave it more room.
  double best = HUGE_VAL;
  ArrayXd &largest = memory.largest, &row = memory.row;
  largest.resize(N);
  for (const double power : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    if (power > 0 && n == 1) break;  // weights of one mode cancel
    const VectorXd v = perron.array().pow(power);
    largest.setConstant(-HUGE_VAL);
    for (Index j = 0; j < n; ++j) {
      row = own.col(j).array();
      for (Index i = 0; i < n; ++i)
        if (i != j || system.cross.size() > 0) row += pulls.col(j + n * i).array() * (v(i) / v(j));
      largest = largest.max(row);
    }
    double half = 0;
    for (Index t = 0; t < N; t += 2) half += largest(t);
    half /= double((N + 1) / 2);
    const double bound = largest.mean() + 2 * std::abs(largest.mean() - half) + 1e-9 * largest.abs().maxCoeff();
    if (bound < best) best = bound;
  }
  return best;
}

double growth_bound(const ScaledSystem& system) {
  if (!system.diagonal_damping) return HUGE_VAL;
  const Index N = fourier::fast_length(2 * system.K.c.cols() + 10);
  return growth_bound(SampledSystem{stiffness_samples(system, N), {}, system.damping_diagonal()});
}

}  // namespace hb
