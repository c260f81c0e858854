#include "hb/engine/time/floquet_product.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/dense.hpp"

namespace hb {

// Row k of the cycle: -Phi_k y_k + y_(k+1) = p_k. Carried along: A y_0 + D y_k = r. One QR of the column of y_k,
//   [ A  D      0 | r   ]          [ E0  R  E1 | s ]   keeps y_k for the way back,
//   [ 0  -Phi_k 1 | p_k ]   ->     [ A'  0  D' | r']   carries on.
CyclicSolution solve_cyclic(const std::vector<SegmentMap>& segments) {
  const Eigen::Index n = segments.front().transition.rows();
  const std::size_t N = segments.size();
  struct Kept {
    Eigen::MatrixXd E0, R, E1;
    Eigen::VectorXd s;
  };
  std::vector<Kept> kept;
  Eigen::MatrixXd A = -segments[0].transition, D = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd r = segments[0].particular;
  for (std::size_t k = 1; k < N; ++k) {
    Eigen::MatrixXd column(2 * n, n), rest = Eigen::MatrixXd::Zero(2 * n, 2 * n + 1);
    column << D, -segments[k].transition;
    rest.topLeftCorner(n, n) = A;
    rest.block(n, n, n, n).setIdentity();
    rest.topRightCorner(n, 1) = r;
    rest.bottomRightCorner(n, 1) = segments[k].particular;
    const dense::Qr qr = dense::qr(column);
    rest = (qr.Q.transpose() * rest).eval();
    kept.push_back({rest.topLeftCorner(n, n), qr.R.topRows(n), rest.block(0, n, n, n), rest.topRightCorner(n, 1)});
    A = rest.bottomLeftCorner(n, n);
    D = rest.block(n, n, n, n);
    r = rest.bottomRightCorner(n, 1);
  }
  CyclicSolution solution;
  const dense::Lu<double> lu(A + D);
  // Against the size of the parts: A + D = 0 is the singular case.
  const double size = std::max(A.cwiseAbs().maxCoeff(), D.cwiseAbs().maxCoeff());
  solution.reciprocal_condition = lu.rcond() * std::min(1.0, (A + D).cwiseAbs().maxCoeff() / size);
  solution.states.assign(N, Eigen::VectorXd::Zero(n));
  solution.states[0] = lu.solve(r);
  Eigen::VectorXd next = solution.states[0];
  for (std::size_t k = N; k-- > 1;) {
    const Kept& row = kept[k - 1];
    solution.states[k] =
        row.R.triangularView<Eigen::Upper>().solve(row.s - row.E0 * solution.states[0] - row.E1 * next);
    next = solution.states[k];
  }
  return solution;
}

// Phi_k Q_k = Q_(k+1) R_k. When the leading subspaces repeat after a turn, Q_N = Q_0 S with S block diagonal, and the
// multipliers are the eigenvalues of the blocks of S R_(N-1) ... R_0; blocks hold directions of nearly equal growth.
LogMultipliers log_multipliers(const std::vector<SegmentMap>& segments, double noise) {
  const Eigen::Index n = segments.front().transition.rows();
  constexpr int sweeps = 200, counted = 100;
  constexpr double same_growth = 0.35;  // log of the ratio per turn below which directions stay in one block
  Eigen::MatrixXd Q = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd growth = Eigen::VectorXd::Zero(n), amplification = growth;
  std::vector<bool> resolved(static_cast<std::size_t>(n), true);
  std::vector<Eigen::MatrixXd> R(segments.size());
  // Many segments need few sweeps for a decaying system; bound the work at about 20 000 factorisations.
  const int num_sweeps = std::max(8, std::min(sweeps, 20000 / static_cast<int>(segments.size())));
  const int num_counted = std::min(counted, num_sweeps / 2);
  Eigen::MatrixXd Q0;
  for (int sweep = 0; sweep < num_sweeps; ++sweep) {
    Q0 = Q;
    for (std::size_t k = 0; k < segments.size(); ++k) {
      dense::Qr qr = dense::qr(segments[k].transition * Q);
      Q = std::move(qr.Q);
      R[k] = std::move(qr.R);
      if (sweep < num_sweeps - num_counted) continue;
      const double largest = R[k].cwiseAbs().maxCoeff();
      for (Eigen::Index i = 0; i < n; ++i) {
        const double size = std::abs(R[k](i, i));
        if (!(size > noise * largest)) resolved[static_cast<std::size_t>(i)] = false;
        growth(i) += std::log(std::max(size, 1e-300)) / num_counted;
        amplification(i) += largest / std::max(size, 1e-300) / num_counted;
      }
    }
  }
  const Eigen::MatrixXd S = Q0.transpose() * Q;

  LogMultipliers result;
  for (Eigen::Index first = 0; first < n;) {
    if (!resolved[static_cast<std::size_t>(first)]) {
      result.some_below = true;
      break;
    }
    Eigen::Index last = first;
    while (last + 1 < n && resolved[static_cast<std::size_t>(last + 1)] &&
           growth(last) - growth(last + 1) < same_growth)
      ++last;
    const Eigen::Index size = last - first + 1;
    Eigen::MatrixXd product = Eigen::MatrixXd::Identity(size, size);
    double scale = 0;
    for (const Eigen::MatrixXd& factor : R) {
      product = factor.block(first, first, size, size) * product;
      const double norm = product.cwiseAbs().maxCoeff();
      product /= norm;
      scale += std::log(norm);
    }
    for (const std::complex<double>& mu : dense::eigenvalues(S.block(first, first, size, size) * product)) {
      const std::complex<double> log_mu = std::log(mu);
      const double angle = log_mu.imag() == -std::numbers::pi ? std::numbers::pi : log_mu.imag();
      result.values.push_back({{log_mu.real() + scale, angle}, amplification.segment(first, size).maxCoeff()});
    }
    first = last + 1;
  }
  if (static_cast<Eigen::Index>(result.values.size()) < n) result.some_below = true;
  std::sort(result.values.begin(), result.values.end(), [](const LogMultiplier& a, const LogMultiplier& b) {
    return a.value.real() != b.value.real() ? a.value.real() > b.value.real() : a.value.imag() < b.value.imag();
  });
  return result;
}

}  // namespace hb
