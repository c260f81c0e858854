#include "hb/engine/exponents/cell_chain.hpp"

#include <complex>
#include <numbers>
#include <type_traits>
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

MatrixXd sizes(const MatrixXcd& A) { return A.cwiseAbs(); }

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
    for (Index k = 0; k < mu.value.size(); ++k)
      if (std::abs(mu.value(k) - mirrored) < std::abs(mu.value(partner) - mirrored)) partner = k;
    if (partner <= j) continue;
    mu.radius(j) = mu.radius(partner) =
        std::max(mu.radius(j), mu.radius(partner)) + std::abs(mu.value(partner) - mirrored);
    mu.value(partner) = mirrored;
  }
}

// F_0 = V, F_i diag(d_i) = D_i F_(i-1) with columns of length 1: in these frames the turn's map is diagonal and a
// change of a cell's map is F_i^-1 dD_i F_(i-1), carried over the turn entry by entry. Plain loops over p, a constant
// or not, which the compiler unrolls where it is one.
template <class Length>
struct Frames {
  Length p;
  MatrixXcd F, next;
  VectorXd g = VectorXd::Ones(p);  // growth of each column so far, over e^log_common
  double log_common = 0;
  VectorXd d = g;
  MatrixXd before = sizes(F), inverse = before;  // |F_(i-1)|, |F_i^-1|
  VectorXd square = g, given = g;
  std::vector<CellErrors> change = std::vector<CellErrors>(std::size_t(p * p));

  // Over cell i. False if the growth is no number.
  bool pass(const CellChain& chain, Index i) {
    advance(chain, i);
    for (Index k = 0; k < p; ++k) add_change(chain, i, k);
    double scale = 0;
    for (Index k = 0; k < p; ++k) scale = std::max(scale, g(k) *= d(k));
    if (!(scale > 0 && g.allFinite())) return false;
    for (Index k = 0; k < p; ++k) g(k) /= scale;
    for (CellErrors& entry : change) {
      entry.squares /= scale * scale;
      entry.sizes /= scale;
      entry.given /= scale;
    }
    log_common += std::log(scale);
    return true;
  }

  void advance(const CellChain& chain, Index i) {
    for (Index k = 0; k < p; ++k) {
      double square = 0;
      for (Index j = 0; j < p; ++j) {
        before(j, k) = std::abs(F(j, k));
        cplx sum = 0;
        for (Index m = 0; m < p; ++m) sum += chain.factors(j, p * i + m) * F(m, k);
        next(j, k) = sum;
        square += std::norm(sum);
      }
      d(k) = std::sqrt(square);
      for (Index j = 0; j < p; ++j) next(j, k) /= d(k);
    }
    F.swap(next);
    if (p == 2) {
      const double determinant = std::abs(F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0));
      for (Index k = 0; k < 2; ++k)
        for (Index j = 0; j < 2; ++j) inverse(j, k) = std::abs(F(1 - k, 1 - j)) / determinant;
    } else {
      inverse = sizes(dense::inverse(F));
    }
  }

  // Column k of change <- diag(d) change + |F_i^-1| |dD_i| |F_(i-1)| diag(g), of rounding with squares of the sizes.
  void add_change(const CellChain& chain, Index i, Index k) {
    square.setZero();
    given.setZero();
    for (Index m = 0; m < p; ++m) {
      double of_row_square = 0, of_row_given = 0;
      for (Index n = 0; n < p; ++n) {
        of_row_square += chain.rounding(m, p * i + n) * before(n, k) * before(n, k);
        of_row_given += chain.given(m, p * i + n) * before(n, k);
      }
      for (Index j = 0; j < p; ++j) {
        square(j) += inverse(j, m) * inverse(j, m) * of_row_square;
        given(j) += inverse(j, m) * of_row_given;
      }
    }
    CellErrors* const column = &change[std::size_t(p * k)];
    for (Index j = 0; j < p; ++j) {
      column[j].squares *= d(j) * d(j);
      column[j].sizes *= d(j);
      column[j].given *= d(j);
      column[j].add(square(j) * g(k) * g(k), given(j) * g(k));
    }
  }
};

template <class Length>
std::optional<InexactEigenvalues> framed(Length p, const CellChain& chain, const MatrixXcd& V, double log_size) {
  Frames<Length> frames{p, V, V};
  for (Index i = 0; i < chain.num_cells(); ++i)
    if (!frames.pass(chain, i)) return std::nullopt;
  const MatrixXcd back = dense::inverse(V), closing = chain.closing.cast<cplx>();
  MatrixXcd turned = back * closing * frames.F;
  MatrixXd known(back.rows(), back.cols());
  for (Index k = 0; k < p; ++k) {
    turned.col(k) *= frames.g(k);
    for (Index j = 0; j < p; ++j) {
      // What the solution with V rounds.
      const double rounded = 2 * eps * double(p) * back.row(j).norm() * frames.g(k);
      known(j, k) = frames.change[std::size_t(j + p * k)].total() + rounded;
    }
  }
  const std::optional<dense::Eigenpairs> refined = dense::eigenpairs(turned);
  if (!refined) return std::nullopt;
  const MatrixXcd& W = refined->vectors;
  const MatrixXd changed = sizes(dense::inverse(W)) * known * sizes(W);
  InexactEigenvalues result{refined->values, gershgorin_radii(refined->values, changed)};
  pair_up(result);
  const double factor = std::exp(frames.log_common - log_size);
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
    double square = 0, sum = 0;
    for (Index k = 0; k < p; ++k)
      for (Index j = 0; j < p; ++j) {
        const double weight = std::min(scale * std::abs(next(k, j)), 1e200);
        square += weight * weight * rounding(j, k);
        sum += weight * given(j, k);
      }
    trace.add(square, sum);
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
  const std::integral_constant<Index, 2> two;
  return chain.size() == 2 ? framed(two, chain, start->vectors, product.log_size)
                           : framed(chain.size(), chain, start->vectors, product.log_size);
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
  for (Index j = 0; j < p; ++j) {
    v(j, 0) = start(j).real(), v(j, 1) = start(j).imag();
    w(j, 0) = end(j).real(), w(j, 1) = end(j).imag();
  }
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
