#include "hb/engine/exponents/growth_bound.hpp"

#include <cmath>

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

}  // namespace

double growth_bound(const SampledSystem& system) {
  const Index N = system.stiffness.rows(), n = system.damping.size();
  const auto K = [&](Index j, Index i) { return system.stiffness.col(j + n * i).array(); };
  // Growth of each mode's amplitude; a coupling k from mode i to mode j changes it by |k| out_j in_i, one of y1' by
  // |nu| slope_j in_i.
  MatrixXd own(N, n), in(N, n), out(N, n), slope(N, n);
  for (Index j = 0; j < n; ++j) {
    const double b = system.damping(j);
    const ArrayXd k = K(j, j), W2 = k - b * b / 4;
    if (W2.minCoeff() > 1e-3 * std::abs(W2.mean())) {
      const FourierSeries L = fourier::analyse((0.5 * W2.log()).matrix().transpose());  // ln W
      const ArrayXd W = W2.sqrt();
      const ArrayXd L1 = fourier::synthesise(fourier::derivative(L), N).row(0).transpose();
      const ArrayXd L2 = fourier::synthesise(fourier::derivative(L, 2), N).row(0).transpose();
      own.col(j) = -b / 2 + (0.5 * L2 - 0.25 * L1.square()).abs() / (2 * W);
      in.col(j) = W.rsqrt();
      out.col(j) = W.rsqrt();
      slope.col(j) = W.sqrt() + (b / 2 + L1 / 2).abs() * W.rsqrt();
    } else if (W2.mean() < 0) {
      const double mean = k.mean(), root = std::sqrt(b * b / 4 - mean);
      const double r2 = -b / 2 - root, r1 = b > 0 ? mean / r2 : -b / 2 + root;
      const ArrayXd d = (k - mean) / (2 * root);
      own.col(j) = (r1 - d).max(r2 + d);
      in.col(j).setConstant(std::sqrt(2 / root));
      out.col(j).setConstant(1 / std::sqrt(2 * root));
      slope.col(j).setConstant(std::max(std::abs(r1), std::abs(r2)) / std::sqrt(2 * root));
    } else {
      return HUGE_VAL;
    }
  }
  const auto pull = [&](Index j, Index i) {
    ArrayXd p = i == j ? ArrayXd(ArrayXd::Zero(N)) : ArrayXd(K(j, i).abs() * out.col(j).array());
    if (system.cross.size() > 0) p += system.cross.col(j + n * i).array().abs() * slope.col(j).array();
    return ArrayXd(p * in.col(i).array());
  };
  MatrixXd pulls(N, n * n);
  MatrixXd mean(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      pulls.col(j + n * i) = pull(j, i);
      mean(j, i) = pulls.col(j + n * i).mean() + (i == j ? own.col(j).mean() : 0);
    }
  const VectorXd perron = perron_vector(mean);
  // The largest row varies over the turn; powers of the weights leave it more room.
  double best = HUGE_VAL;
  for (const double power : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    if (power > 0 && n == 1) break;  // weights of one mode cancel
    const VectorXd v = perron.array().pow(power);
    ArrayXd largest = ArrayXd::Constant(N, -HUGE_VAL);
    for (Index j = 0; j < n; ++j) {
      ArrayXd row = own.col(j).array();
      for (Index i = 0; i < n; ++i) row += pulls.col(j + n * i).array() * (v(i) / v(j));
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
  const Index N = fourier::fast_length(2 * system.K.num_harmonics() + 12);
  return growth_bound(SampledSystem{fourier::synthesise(system.K, N).transpose(), {}, system.damping_diagonal()});
}

}  // namespace hb
