#include "hb/engine/exponents/cell_chain.hpp"

#include <complex>
#include <numbers>
#include <vector>

#include "hb/engine/exponents/small_matrix.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

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
struct Partial {
  MatrixXd M;
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

Eigen::Matrix2cd inverse_of(const Eigen::Matrix2cd& A) {
  Eigen::Matrix2cd adjugate;
  adjugate << A(1, 1), -A(0, 1), -A(1, 0), A(0, 0);
  return adjugate / (A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0));
}
MatrixXcd inverse_of(const MatrixXcd& A) { return dense::inverse(A); }

// The errors of all entries of a matrix as they add up over the cells.
template <int size>
struct EntryErrors {
  using Real = Eigen::Matrix<double, size, size>;
  Real squares, sizes, given;

  explicit EntryErrors(Index p) : squares(Real::Zero(p, p)), sizes(squares), given(squares) {}
  Real total() const {
    return squares.binaryExpr(sizes, [](double q, double s) { return CellErrors{q, s, 0}.total(); }) + given;
  }
};

// The map is real: an eigenvalue whose disc holds its conjugate is real, the others come in pairs.
void pair_up(InexactEigenvalues& mu) {
  for (Index j = 0; j < mu.value.size(); ++j) {
    const cplx mirrored = std::conj(mu.value(j));
    if (std::abs(mirrored.imag()) <= mu.radius(j)) {
      mu.radius(j) += std::abs(mirrored.imag());
      mu.value(j) = mirrored.real();
      continue;
    }
    Index partner = j;
    (mu.value.array() - mirrored).abs().minCoeff(&partner);
    if (partner <= j) continue;
    mu.radius(j) = mu.radius(partner) =
        std::max(mu.radius(j), mu.radius(partner)) + std::abs(mu.value(partner) - mirrored);
    mu.value(partner) = mirrored;
  }
}

// F_0 = V, F_i diag(d_i) = D_i F_(i-1) with columns of length 1: in these frames the turn's map is diagonal and a
// change of a cell's map is F_i^-1 dD_i F_(i-1), carried over the turn entry by entry.
template <int size>
std::optional<InexactEigenvalues> framed(const CellChain& chain, const MatrixXcd& vectors, double log_size) {
  using Square = Eigen::Matrix<cplx, size, size>;
  using Real = Eigen::Matrix<double, size, size>;
  using Column = Eigen::Vector<double, size>;
  const Index p = chain.size(), N = chain.num_cells();
  const Square V = vectors;
  Square F = V;
  Column g = Column::Ones(p);  // growth of each column so far, over e^log_common
  EntryErrors<size> change(p);
  double log_common = 0;
  for (Index i = 0; i < N; ++i) {
    const auto cell = [&](const MatrixXd& all) { return all.block<size, size>(0, p * i, p, p); };
    const Real before = F.cwiseAbs();
    const Square next = cell(chain.factors).template cast<cplx>() * F;
    const Column d = next.colwise().norm().transpose();
    F = next * d.cwiseInverse().asDiagonal();
    const Real inverse = inverse_of(F).cwiseAbs();
    const Real squares = inverse.cwiseAbs2() * cell(chain.rounding) * before.cwiseAbs2();
    const Real given = inverse * cell(chain.given) * before;
    change.squares = d.cwiseAbs2().asDiagonal() * change.squares + squares * g.cwiseAbs2().asDiagonal();
    change.sizes = d.asDiagonal() * change.sizes + Real(squares.cwiseSqrt()) * g.asDiagonal();
    change.given = d.asDiagonal() * change.given + given * g.asDiagonal();
    g = g.cwiseProduct(d);
    const double scale = g.maxCoeff();
    if (!(scale > 0 && std::isfinite(scale))) return std::nullopt;
    g /= scale;
    change.squares /= scale * scale;
    change.sizes /= scale;
    change.given /= scale;
    log_common += std::log(scale);
  }
  const Square back = inverse_of(V);
  const Square turned = back * chain.closing.cast<cplx>() * F * g.asDiagonal();
  // What the solution with V rounds.
  const Real rounded = 2 * eps * double(p) * back.rowwise().norm() * g.transpose();
  const std::optional<dense::Eigenpairs> refined = dense::eigenpairs(MatrixXcd(turned));
  if (!refined) return std::nullopt;
  const MatrixXcd& W = refined->vectors;
  const MatrixXd changed = dense::inverse(W).cwiseAbs() * MatrixXd(change.total() + rounded) * W.cwiseAbs();
  InexactEigenvalues result{refined->values, gershgorin_radii(refined->values, changed)};
  pair_up(result);
  const double factor = std::exp(log_common - log_size);
  result.value *= factor;
  result.radius *= factor;
  if (!result.radius.allFinite()) return std::nullopt;
  return result;
}

}  // namespace

double CellErrors::total() const { return eps * (6 * std::sqrt(squares) + 0.75 * sizes) + given; }

ChainProduct product_of(const CellChain& chain) {
  const Index p = chain.size(), N = chain.num_cells();
  MatrixXd factor(p, p), next(p, p);
  const auto cell = [&](const MatrixXd& all, Index i) { return all.middleCols(p * i, p); };
  std::vector<Partial> before{{MatrixXd::Identity(p, p)}};
  before.reserve(std::size_t(N) + 1);
  for (Index i = 0; i < N; ++i) {
    factor = cell(chain.factors, i);
    multiply(factor, before.back().M, next);
    before.push_back({next, before.back().exponent});
    before.back().normalise();
  }
  const Size total = before.back().size();
  Partial behind{MatrixXd::Identity(p, p)};
  Size bound;
  CellErrors change, trace;
  for (Index i = N - 1; i >= 0; --i) {
    const Partial& a = before[std::size_t(i)];
    const auto rounding = cell(chain.rounding, i), given = cell(chain.given, i);
    const double scale =
        std::ldexp(1 / total.value, std::clamp(a.exponent + behind.exponent - total.exponent, -1000, 1000));
    const double norms = std::min(a.M.norm() * scale * behind.M.norm(), 1e200);
    change.add(norms * norms * rounding.sum(), norms * given.norm());
    multiply(a.M, behind.M, next);
    next = (scale * next.cwiseAbs()).cwiseMin(1e200).transpose().eval();
    trace.add(next.cwiseAbs2().cwiseProduct(rounding).sum(), next.cwiseProduct(given).sum());
    factor = cell(chain.factors, i);
    bound.value *= factor.norm() + eps * std::sqrt(rounding.sum()) + given.norm();
    bound.normalise();
    multiply(behind.M, factor, next);
    behind.M.swap(next);
    behind.normalise();
  }
  return {chain.closing * (before.back().M / total.value), total.log(), change.total(), trace.total(), bound.log()};
}

std::optional<InexactEigenvalues> framed_eigenvalues(const CellChain& chain, const ChainProduct& product) {
  const std::optional<dense::Eigenpairs> start = dense::eigenpairs(product.M);
  if (!start) return std::nullopt;
  return chain.size() == 2 ? framed<2>(chain, start->vectors, product.log_size)
                           : framed<Eigen::Dynamic>(chain, start->vectors, product.log_size);
}

double first_order_change(const CellChain& chain, const ChainProduct& product, cplx mu, double radius) {
  const Index p = chain.size(), N = chain.num_cells();
  const dense::Lu<cplx> shifted(product.M.cast<cplx>() - (mu + 0.1 * radius) * MatrixXd::Identity(p, p));
  VectorXcd start = VectorXcd::Ones(p), end = start;
  for (int iteration = 0; iteration < 3; ++iteration) {
    start = shifted.solve(start).normalized();
    end = shifted.solve_transposed(end).normalized();
  }
  const double at_end = std::abs((end.transpose() * start).value());
  // Real and imaginary parts as two columns.
  MatrixXd v(p, 2), w(p, 2), before(p, 2 * N), back(p, 2);
  v << start.real(), start.imag();
  w << end.real(), end.imag();
  for (Index i = 0; i < N; ++i) {
    before.middleCols(2 * i, 2) = v;
    v = chain.factors.middleCols(p * i, p).lazyProduct(before.middleCols(2 * i, 2));
    v /= v.norm();
  }
  CellErrors change;
  for (Index i = N - 1; i >= 0; --i) {
    back = chain.factors.middleCols(p * i, p).transpose().lazyProduct(w);
    const auto here = before.middleCols(2 * i, 2);
    const cplx grown(back.col(0).dot(here.col(0)) - back.col(1).dot(here.col(1)),
                     back.col(0).dot(here.col(1)) + back.col(1).dot(here.col(0)));
    const VectorXd left = w.rowwise().squaredNorm(), right = here.rowwise().squaredNorm();
    const double square = left.dot(chain.rounding.middleCols(p * i, p) * right);
    const double given = left.cwiseSqrt().dot(chain.given.middleCols(p * i, p) * right.cwiseSqrt());
    change.add(square / std::norm(grown), given / std::abs(grown));
    w = back / back.norm();
  }
  // With the rounding of the eigenvalue of the product.
  return change.total() + 2 * eps * double(p) / (at_end * std::abs(mu));
}

}  // namespace hb
