#include "hb/engine/exponents/turn_exponents.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "hb/engine/exponents/inexact_eigenvalues.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

constexpr double eps = 2.220446049250313e-16;
constexpr double two_pi = 2 * std::numbers::pi;

// One mode, two exponents: with the determinant known (Liouville), s = -b/2 +- acosh(disc)/(2 pi),
// disc = tr Phi/(2 sqrt(det Phi)) and det Phi = exp(-2 pi b), whatever the size of the multipliers.
TurnExponents discriminant(const Eigen::Matrix2d& M, double log_size, double change, double damping) {
  const double mean = -damping / 2;
  const double log_disc = std::log(std::max(std::abs(M.trace() / 2), 1e-300)) + log_size - two_pi * mean;
  if (log_disc > 20) {  // acosh(x) = ln 2x to rounding
    const double growth = (log_disc + std::numbers::ln2) / two_pi, angle = M.trace() < 0 ? 0.5 : 0;
    const double error = 2 * change / std::abs(M.trace() / 2) / two_pi;
    return {{{mean + growth, angle}, {mean - growth, angle}}, {error, error}, -HUGE_VAL, {}};
  }
  const double scale = std::exp(log_size - two_pi * mean);
  const double disc = M.trace() / 2 * scale, error = change * scale;
  const double mean_error = 4 * eps * std::abs(mean);
  const double size = std::abs(disc), angle = disc < 0 ? 0.5 : 0;
  TurnExponents result;
  if (size <= 1) {
    const double turn = std::acos(std::clamp(disc, -1.0, 1.0)) / two_pi;
    // Within `error` of +-1 the pair may as well be real.
    const double slack = (std::acos(std::max(size - error, -1.0)) - std::acos(size)) / two_pi;
    const double growth = size + error > 1 ? std::acosh(std::max(1.0, size + error)) / two_pi : 0;
    result.s = {{mean, -turn}, {mean, turn}};
    result.error = {mean_error + slack + growth, mean_error + slack + growth};
  } else {
    const double growth = std::acosh(size) / two_pi;
    const double up = std::acosh(size + error) / two_pi - growth;
    const double down = growth - std::acosh(std::max(1.0, size - error)) / two_pi;
    const double turn = size - error < 1 ? std::acos(std::max(size - error, -1.0)) / two_pi : 0;
    result.s = {{mean + growth, angle}, {mean - growth, angle}};
    result.error = {mean_error + std::max(up, down) + turn, mean_error + std::max(up, down) + turn};
  }
  return result;
}

// A = Q R by Householder reflections; A is overwritten by R. Small fixed sizes with columns padded to whole registers:
// several times faster than the general routine.
template <int size>
void orthogonalise(Eigen::Matrix<double, size, size>& A, Eigen::Matrix<double, size, size>& Q) {
  using Square = Eigen::Matrix<double, size, size>;
  if constexpr (size == Eigen::Dynamic) {
    const Eigen::HouseholderQR<Square> qr(A);
    Q = qr.householderQ();
    A = qr.matrixQR().template triangularView<Eigen::Upper>();
  } else {
    constexpr int padded = (size + 3) / 4 * 4;
    using Columns = Eigen::Matrix<double, padded, size>;
    Columns R = Columns::Zero(), V, P = Columns::Zero();
    R.template topRows<size>() = A;
    std::array<double, size> beta;
    for (int k = 0; k < size; ++k) {
      auto v = V.col(k);
      v = R.col(k);
      v.head(k).setZero();
      const double end = v(k) > 0 ? -v.norm() : v.norm();
      v(k) -= end;
      const double squared = v.squaredNorm();
      beta[std::size_t(k)] = squared > 0 ? 2 / squared : 0;
      for (int j = k + 1; j < size; ++j) R.col(j) -= beta[std::size_t(k)] * v.dot(R.col(j)) * v;
      R(k, k) = end;
    }
    for (int k = 0; k < size; ++k) P(k, k) = 1;
    for (int k = size - 1; k >= 0; --k)
      for (int j = k; j < size; ++j) P.col(j) -= beta[std::size_t(k)] * V.col(k).dot(P.col(j)) * V.col(k);
    Q = P.template topRows<size>();
    A = R.template topRows<size>().template triangularView<Eigen::Upper>();
  }
}

// R_i, i = 1..N, and what turns the last of them back to the first: Q_0^T Q_N.
struct Sweep {
  MatrixXd R;  // n x n N
  MatrixXd turned;
  std::vector<Index> ends;  // of the diagonal blocks: exclusive
  double closing = 0;  // what is left below the blocks of `turned`
  MatrixXd Q;
};

// Q_i R_i = Phi_i Q_(i-1); over the turns Q_0 turns into the ordered invariant subspaces. `from`: Q_0 to start from, or
// empty: both states of one mode after the other.
template <int size>
Sweep sweep(const TurnMaps& maps, const MatrixXd& from) {
  using Square = Eigen::Matrix<double, size, size>;
  const Index n = maps.num_states(), N = maps.num_cells;
  constexpr int most_sweeps = 16;
  const double apart = std::log(10.0);
  Sweep result{MatrixXd(n, n * N), {}, {}, 0, {}};
  Square Q = Square::Zero(n, n), start, next;
  if (from.rows() == n)
    Q = from;
  else
    for (Index i = 0; i < n; ++i) Q(i % 2 == 0 ? i / 2 : n / 2 + i / 2, i) = 1;
  for (int count = 0; count < most_sweeps; ++count) {
    start = Q;
    VectorXd logs = VectorXd::Zero(n);
    for (Index i = 0; i < N; ++i) {
      next.noalias() = maps.cells.middleCols<size>(n * i, n).lazyProduct(Q);
      orthogonalise<size>(next, Q);
      result.R.middleCols<size>(n * i, n) = next;
      logs += next.diagonal().cwiseAbs().cwiseMax(1e-300).array().log().matrix();
    }
    // Split where the growth over the turn differs by 10 and the leading subspace has come back onto itself.
    result.turned = start.transpose() * Q;
    result.ends.clear();
    bool settled = true;
    for (Index j = 1; j < n; ++j) {
      if (!(logs(j - 1) - logs(j) > apart)) continue;
      if (result.turned.bottomLeftCorner(n - j, j).norm() <= 1e-13 * std::sqrt(double(n)))
        result.ends.push_back(j);
      else
        settled = false;
    }
    result.ends.push_back(n);
    if (settled && count > 0) break;
  }
  for (const Index end : result.ends)
    if (end < n) result.closing = std::max(result.closing, result.turned.bottomLeftCorner(n - end, end).norm());
  result.Q = Q;
  return result;
}

// How far a change of cell i reaches each diagonal block: N x blocks, |W_i| |V_(i-1)| with V_i the columns that span
// the block's invariant subspace in the frame Q_i and W_i the rows of V_i^-1. V is unit upper triangular by blocks and
// R_i V_(i-1) = V_i D_i with D the diagonal blocks of R: solved from the last cell to the first, which contracts, since
// what leads grows more over a turn. Infinite where that does not settle.
template <int size>
MatrixXd reach(const Sweep& sweep) {
  using Square = Eigen::Matrix<double, size, size>;
  using Rows = Eigen::Matrix<double, size, size, Eigen::RowMajor>;
  const Index n = sweep.R.rows(), N = sweep.R.cols() / n;
  const auto blocks = Index(sweep.ends.size());
  const auto begin = [&](Index b) { return b == 0 ? 0 : sweep.ends[std::size_t(b - 1)]; };
  const auto width = [&](Index b) { return sweep.ends[std::size_t(b)] - begin(b); };
  // 1 for a block that nothing else is mixed with, whatever its width.
  const auto length = [](const auto& block, Index p) { return std::sqrt(block.squaredNorm() - double(p - 1)); };
  const Square turned = sweep.turned;
  MatrixXd right(N, blocks), left(N, blocks);
  Rows V = Rows::Identity(n, n), W(n, n), D(n, n), before;
  constexpr int most_turns = 8;
  for (int turn = 0; turn < most_turns; ++turn) {
    before = V;
    V = turned.transpose() * (V * turned).eval();
    for (Index b = 0; b < blocks; ++b) {
      V.block(begin(b), 0, n - begin(b), sweep.ends[std::size_t(b)]).setZero();
      V.diagonal().segment(begin(b), width(b)).setOnes();
    }
    for (Index i = N - 1; i >= 0; --i) {
      const auto R = sweep.R.middleCols<size>(n * i, n);
      // The first turn only settles V.
      if (turn > 0) {
        W.setIdentity();
        for (Index r = n - 2; r >= 0; --r)
          for (Index c = r + 1; c < n; ++c) W.row(r) -= V(r, c) * W.row(c);
        for (Index b = 0; b < blocks; ++b) left(i, b) = length(W.middleRows(begin(b), width(b)), width(b));
      }
      D.setZero();
      for (Index b = 0; b < blocks; ++b)
        D.block(begin(b), begin(b), width(b), width(b)) = R.block(begin(b), begin(b), width(b), width(b));
      V = (blocks == n ? Rows(V * D.diagonal().asDiagonal()) : Rows(V.lazyProduct(D)));
      for (Index r = n - 1; r >= 0; --r) {
        for (Index c = r + 1; c < n; ++c) V.row(r) -= R(r, c) * V.row(c);
        const bool vanishes = !(std::abs(R(r, r)) > 1e-290);
        V.row(r) *= vanishes ? 0 : 1 / R(r, r);
        if (vanishes) V(r, r) = 1;
      }
      if (turn > 0)
        for (Index b = 0; b < blocks; ++b) right(i, b) = length(V.middleCols(begin(b), width(b)), width(b));
    }
    bool settled = turn > 0;
    for (Index b = 0; b < blocks; ++b) {
      const auto columns = V.middleCols(begin(b), width(b));
      settled = settled && (columns - before.middleCols(begin(b), width(b))).norm() <= 0.1 * columns.norm();
    }
    if (settled) return 1.2 * right.cwiseProduct(left);
  }
  return MatrixXd::Constant(N, blocks, HUGE_VAL);
}

// Product of the diagonal blocks of R, |M| = 1, its size kept apart as a logarithm, and what a change of the cell maps
// does to it.
struct BlockProduct {
  MatrixXd M;
  double log_size = 0;
  double change = 0;  // |dM|
  double log_bound = 0;  // log of the product of the norms
};

// value 2^exponent: products over a turn neither overflow nor vanish.
struct Size {
  double value = 1;
  int exponent = 0;

  void normalise() {
    int e = 0;
    value = std::frexp(value, &e);
    exponent += e;
  }
  double log() const { return std::log(std::max(value, 1e-300)) + exponent * std::numbers::ln2; }
};

// A product so far, of size near 1 but for a power of two kept apart.
template <class Square>
struct Product {
  Square M;
  int exponent = 0;

  void normalise() {
    const double size = M.cwiseAbs().maxCoeff();
    if (size < 1e100 && size > 1e-100) return;
    int e = 0;
    std::frexp(std::max(size, 1e-300), &e);
    M *= std::ldexp(1.0, -e);
    exponent += e;
  }
  Size size() const { return {std::max(M.norm(), 1e-300), exponent}; }
};

// A block whose cell map i is known to errors(i) of the size of the whole map changes by
// sum_i |behind_i| errors(i) |Phi_i| |before_i|.
template <int size, int most = size>
BlockProduct block_product(const Sweep& sweep, Index begin, Index p, const VectorXd& errors) {
  using Square = Eigen::Matrix<double, size, size, Eigen::ColMajor, most, most>;
  const Index n = sweep.R.rows(), N = sweep.R.cols() / n;
  const auto block = [&](Index i) { return sweep.R.block<size, size>(begin, n * i + begin, p, p); };
  const auto whole = [&](Index i) { return sweep.R.middleCols(n * i, n).norm(); };
  std::vector<Size> before(std::size_t(N) + 1);
  before[0].value = std::sqrt(double(p));
  Product<Square> product{Square::Identity(p, p)};
  for (Index i = 0; i < N; ++i) {
    product.M = block(i).lazyProduct(product.M).eval();
    product.normalise();
    before[std::size_t(i) + 1] = product.size();
  }
  const Size total = before[std::size_t(N)];
  Product<Square> behind{Square::Identity(p, p)};
  Size bound;
  double change = 0;
  for (Index i = N - 1; i >= 0; --i) {
    const double norm = whole(i), error = errors(i);
    const Size b = behind.size(), &a = before[std::size_t(i)];
    const double term = a.value * (norm / total.value) * b.value;
    change += error * std::min(std::ldexp(term, a.exponent + b.exponent - total.exponent), 1e200);
    bound.value *= block(i).norm() + error * norm;
    bound.normalise();
    behind.M = behind.M.lazyProduct(block(i)).eval();
    behind.normalise();
  }
  return {sweep.turned.block(begin, begin, p, p) * (product.M / total.value), total.log(), change, bound.log()};
}

// Eigenvalues of a block's product in frames that move with its eigenvectors: F_0 = V, F_i D_i = R_i F_(i-1) with
// columns of length 1, the turn's map is diagonal and a change of a cell's map is (F_i^-1 dR_i F_(i-1))_jk <= |row j of
// F_i^-1| |dR_i|: growth inside the turn that is taken back before its end does not count, as it does in norms of
// partial products. Changes are carried over the turn entry by entry; Gershgorin's discs then hold an eigenvalue each
// where they are apart. Empty where not, or where eigenvectors are too close.
template <int size>
std::optional<InexactEigenvalues> framed_eigenvalues(const Sweep& sweep, Index begin, Index p, const VectorXd& errors,
                                                     const MatrixXd& M, double log_size) {
  using Square = Eigen::Matrix<cplx, size, size>;
  using Real = Eigen::Matrix<double, size, size>;
  using Column = Eigen::Vector<double, size>;
  const Index n = sweep.R.rows(), N = sweep.R.cols() / n;
  const Eigen::EigenSolver<MatrixXd> solver(M);
  const Square V = solver.eigenvectors();
  Square F = V;
  Column g = Column::Ones(p);  // growth of each column so far, over e^log_common
  Real change = Real::Zero(p, p);
  double log_common = 0;
  for (Index i = 0; i < N; ++i) {
    const auto R = sweep.R.block<size, size>(begin, n * i + begin, p, p);
    const Square next = R.template cast<cplx>() * F;
    const Column d = next.colwise().norm().transpose();
    F = next * d.cwiseInverse().asDiagonal();
    const Square inverse = F.inverse();
    const Column pulled = errors(i) * sweep.R.middleCols(n * i, n).norm() * inverse.rowwise().norm();
    const Eigen::RowVector<double, size> carried = g.transpose() + change.colwise().sum();
    change = d.asDiagonal() * change + pulled * carried;
    g = g.cwiseProduct(d);
    const double scale = g.maxCoeff();
    if (!(scale > 0 && std::isfinite(scale))) return std::nullopt;
    g /= scale;
    change /= scale;
    log_common += std::log(scale);
  }
  const Square back = V.inverse();
  const Square turned = back * sweep.turned.block(begin, begin, p, p).template cast<cplx>() * F * g.asDiagonal();
  // What the solution with V rounds.
  change += 64 * eps * double(p) * back.rowwise().norm() * g.transpose();
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> refined{Eigen::MatrixXcd(turned)};
  if (refined.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXcd& W = refined.eigenvectors();
  const MatrixXd changed = W.inverse().cwiseAbs() * MatrixXd(change) * W.cwiseAbs();
  InexactEigenvalues result{refined.eigenvalues(), changed.rowwise().sum()};
  for (Index j = 0; j < p; ++j)
    for (Index k = 0; k < j; ++k)
      if (!(std::abs(result.value(j) - result.value(k)) > result.radius(j) + result.radius(k))) return std::nullopt;
  // The map is real: an eigenvalue whose disc holds its conjugate is real, the others come in pairs.
  for (Index j = 0; j < p; ++j) {
    const cplx mirrored = std::conj(result.value(j));
    if (std::abs(mirrored.imag()) <= result.radius(j)) {
      result.radius(j) += std::abs(mirrored.imag());
      result.value(j) = mirrored.real();
      continue;
    }
    Index partner = j;
    (result.value.array() - mirrored).abs().minCoeff(&partner);
    if (partner <= j) continue;
    result.radius(j) = result.radius(partner) =
        std::max(result.radius(j), result.radius(partner)) + std::abs(result.value(partner) - mirrored);
    result.value(partner) = mirrored;
  }
  const double factor = std::exp(log_common - log_size);
  result.value *= factor;
  result.radius *= factor;
  if (!result.radius.allFinite()) return std::nullopt;
  return result;
}

// Whether the disc of one eigenvalue is small and touches no other one.
bool apart(const InexactEigenvalues& mu, Index one) {
  for (Index j = 0; j < mu.value.size(); ++j)
    if (j != one && !(std::abs(mu.value(j) - mu.value(one)) > mu.radius(j) + 10 * mu.radius(one))) return false;
  return mu.radius(one) < 0.1 * std::abs(mu.value(one));
}

// Relative change of the leading eigenvalue mu of the turn's map M to first order, v and w its right and left vectors,
//     sum_i errors(i) |Phi_i| |w_i| |v_(i-1)|/|w_i' Phi_i v_(i-1)|,
// carried through the cells: growth inside the turn that is taken back before its end does not count here either. No
// other eigenvalue lies within ten times `radius`.
template <int size>
double leading_change(const Sweep& sweep, const VectorXd& errors, const MatrixXd& M, cplx mu, double radius) {
  using Column = Eigen::Matrix<cplx, size, 1>;
  using Square = Eigen::Matrix<cplx, size, size>;
  const Index n = sweep.R.rows(), N = sweep.R.cols() / n;
  const Eigen::PartialPivLU<Square> shifted(M.cast<cplx>() - (mu + 0.1 * radius) * MatrixXd::Identity(n, n));
  Column v = Column::Ones(n), w = v;
  for (int iteration = 0; iteration < 3; ++iteration) {
    v = shifted.solve(v).normalized();
    w = shifted.transpose().solve(w).normalized();
  }
  const double at_end = std::abs((w.transpose() * v).value());
  std::vector<Column, Eigen::aligned_allocator<Column>> before(static_cast<std::size_t>(N));
  for (Index i = 0; i < N; ++i) {
    before[std::size_t(i)] = v;
    v = (sweep.R.middleCols<size>(n * i, n).template cast<cplx>() * v).normalized();
  }
  // Rounding of the eigenvalue of the product.
  double change = 8 * eps * double(n) / (at_end * std::abs(mu));
  for (Index i = N - 1; i >= 0; --i) {
    const auto Phi = sweep.R.middleCols<size>(n * i, n);
    const Column back = Phi.transpose().template cast<cplx>() * w;
    change += errors(i) * Phi.norm() / std::abs((back.transpose() * before[std::size_t(i)]).value());
    w = back.normalized();
  }
  return change;
}

template <int size>
TurnExponents exponents(const TurnMaps& maps, double cell_error, bool leading_only, const MatrixXd& subspaces) {
  const Index n = maps.num_states();
  const bool at_once = leading_only || n == 2;
  const Sweep swept = at_once ? Sweep{maps.cells, MatrixXd::Identity(n, n), {n}, 0, {}} : sweep<size>(maps, subspaces);

  TurnExponents result;
  const auto lose = [&](double bound) {
    result.others_below = std::isnan(bound) ? HUGE_VAL : std::max(result.others_below, bound);
  };
  const bool split = swept.ends.size() > 1;
  MatrixXd reaches;
  if constexpr (size != 2)
    if (split) reaches = reach<size>(swept);
  Index begin = 0, block = -1;
  for (const Index end : swept.ends) {
    const Index p = end - begin, from = begin;
    ++block;
    // A leading subspace that has not quite come back is a change of the last cell.
    VectorXd errors = VectorXd::Constant(maps.num_cells, cell_error);
    errors(maps.num_cells - 1) += swept.closing;
    if (split) errors = errors.cwiseProduct(reaches.col(block));
    const auto [M, log_size, change, log_bound] = p == n ? block_product<size>(swept, begin, p, errors)
                                                         : block_product<Eigen::Dynamic, size>(swept, begin, p, errors);
    begin = end;
    if (n == 2) return discriminant(M, log_size, change, maps.damping_trace);
    if (!(change < 0.5)) {
      lose(log_bound / two_pi);
      continue;
    }
    InexactEigenvalues mu = inexact_eigenvalues(M, change, leading_only);
    constexpr double sharp = 1e-10;
    if (p > 1 && !at_once && !((mu.radius.array() / mu.value.array().abs()).maxCoeff() < sharp)) {
      const auto framed = p == 2 ? framed_eigenvalues<2>(swept, from, p, errors, M, log_size)
                                 : framed_eigenvalues<Eigen::Dynamic>(swept, from, p, errors, M, log_size);
      if (framed && framed->radius.maxCoeff() < mu.radius.maxCoeff()) mu = *framed;
    }
    if constexpr (size != 2) {
      Index first = 0;
      const double largest = mu.value.cwiseAbs().maxCoeff(&first);
      if (at_once && apart(mu, first)) {
        // Beyond the first order while the disc is small.
        const double radius = 2 * leading_change<size>(swept, errors, M, mu.value(first), mu.radius(first)) * largest;
        for (Index j = 0; j < p; ++j)
          if ((j == first || mu.value(j) == std::conj(mu.value(first))) && radius < mu.radius(j)) mu.radius(j) = radius;
      }
    }
    for (Index j = 0; j < p; ++j) {
      const double radius = mu.radius(j), modulus = std::abs(mu.value(j));
      if (!(radius < 0.5 * modulus)) {
        lose((std::log(modulus + radius) + log_size) / two_pi);
        continue;
      }
      double argument = std::arg(mu.value(j));
      if (argument <= -std::numbers::pi) argument = std::numbers::pi;
      result.s.emplace_back((std::log(modulus) + log_size) / two_pi, argument / two_pi);
      result.error.push_back(1.5 * radius / modulus / two_pi);
    }
  }
  std::vector<std::size_t> order(result.s.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    if (result.s[i].real() != result.s[j].real()) return result.s[i].real() > result.s[j].real();
    return result.s[i].imag() < result.s[j].imag();
  });
  TurnExponents sorted;
  sorted.others_below = result.others_below;
  sorted.subspaces = swept.Q;
  for (const std::size_t i : order) {
    sorted.s.push_back(result.s[i]);
    sorted.error.push_back(result.error[i]);
  }
  return sorted;
}

}  // namespace

TurnExponents turn_exponents(const TurnMaps& maps, double cell_error, bool leading_only, const MatrixXd& subspaces) {
  switch (maps.num_states()) {
    case 2:
      return exponents<2>(maps, cell_error, leading_only, subspaces);
    case 4:
      return exponents<4>(maps, cell_error, leading_only, subspaces);
    case 6:
      return exponents<6>(maps, cell_error, leading_only, subspaces);
    case 8:
      return exponents<8>(maps, cell_error, leading_only, subspaces);
    case 10:
      return exponents<10>(maps, cell_error, leading_only, subspaces);
    default:
      return exponents<Eigen::Dynamic>(maps, cell_error, leading_only, subspaces);
  }
}

}  // namespace hb
