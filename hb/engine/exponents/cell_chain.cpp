#include "hb/engine/exponents/cell_chain.hpp"

#include <algorithm>
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

// Brings a product to a size near 1; returned is the power of two that it lost.
template <class Product>
int normalised(Product&& product) {
  const double size = product.cwiseAbs().maxCoeff();
  if (size < 1e100 && size > 1e-100) return 0;
  int e = 0;
  std::frexp(std::max(size, 1e-300), &e);
  product *= std::ldexp(1.0, -e);
  return e;
}

// |F^-1|^2 entry by entry, F = X + i Y, by Gauss and Jordan with row pivots.
class InverseSquares {
 public:
  explicit InverseSquares(Index size) : p_(size), rows_(std::size_t(size * size)), pivots_(std::size_t(size)) {}

  void operator()(const MatrixXd& X, const MatrixXd& Y, MatrixXd& squares) {
    for (Index i = 0; i < p_; ++i)
      for (Index j = 0; j < p_; ++j) row(i)[j] = {X(i, j), Y(i, j)};
    for (Index k = 0; k < p_; ++k) {
      Index pivot = k;
      for (Index i = k + 1; i < p_; ++i)
        if (std::norm(row(i)[k]) > std::norm(row(pivot)[k])) pivot = i;
      pivots_[std::size_t(k)] = pivot;
      if (pivot != k) std::swap_ranges(row(k), row(k) + p_, row(pivot));
      const cplx inverse = std::conj(row(k)[k]) / std::norm(row(k)[k]);
      row(k)[k] = 1;
      for (Index j = 0; j < p_; ++j) row(k)[j] *= inverse;
      for (Index i = 0; i < p_; ++i) {
        if (i == k) continue;
        const cplx l = row(i)[k];
        row(i)[k] = 0;
        for (Index j = 0; j < p_; ++j) row(i)[j] -= l * row(k)[j];
      }
    }
    for (Index i = 0; i < p_; ++i)
      for (Index j = 0; j < p_; ++j) squares(i, j) = std::norm(row(i)[j]);
    for (Index k = p_ - 1; k >= 0; --k) squares.col(k).swap(squares.col(pivots_[std::size_t(k)]));
  }

 private:
  cplx* row(Index i) { return rows_.data() + i * p_; }

  Index p_;
  std::vector<cplx> rows_;
  std::vector<Index> pivots_;
};

// Standard deviation of what a product with a matrix and one with an inverse of p rows round, over sqrt(p) epsilon.
constexpr double multiplied = 0.35;

// The errors of all entries of a matrix as they add up over the cells.
struct EntryErrors {
  double joined;  // cells per step
  MatrixXd variance, deviation, given;

  EntryErrors(Index p, Index joined_cells)
      : joined(double(joined_cells)), variance(MatrixXd::Zero(p, p)), deviation(variance), given(variance) {}

  // E <- diag(d) E + e diag(g) with what one cell adds.
  void carry(const VectorXd& d, const VectorXd& g, const MatrixXd& new_variance, const MatrixXd& new_given) {
    for (Index j = 0; j < g.size(); ++j)
      for (Index i = 0; i < d.size(); ++i) {
        variance(i, j) = d(i) * d(i) * variance(i, j) + new_variance(i, j) / joined * g(j) * g(j);
        deviation(i, j) = d(i) * deviation(i, j) + std::sqrt(new_variance(i, j)) * g(j);
        given(i, j) = d(i) * given(i, j) + new_given(i, j) * g(j);
      }
  }
  void divide(double scale) {
    variance /= scale * scale;
    deviation /= scale;
    given /= scale;
  }
  // real: which of the eigenvectors are.
  MatrixXd total(const std::vector<bool>& real) const {
    MatrixXd result = given;
    for (Index j = 0; j < result.cols(); ++j)
      for (Index i = 0; i < result.rows(); ++i)
        result(i, j) +=
            CellErrors{1, variance(i, j), deviation(i, j), 0}.total(real[std::size_t(i)] && real[std::size_t(j)]);
    return result;
  }
};

// The map is real: an eigenvalue whose disc holds its conjugate is real, the others come in pairs. Two values for one
// are averaged, where their discs tell that they are.
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
    const double apart = std::abs(mu.value(partner) - mirrored), radius = std::max(mu.radius(j), mu.radius(partner));
    mu.radius(j) = mu.radius(partner) = apart <= radius ? radius : radius + apart;
    mu.value(j) = (mu.value(j) + std::conj(mu.value(partner))) / 2.0;
    mu.value(partner) = std::conj(mu.value(j));
  }
}

// Eigenvalues of M = diag + what is left beside it, known to `change`: to first order the diagonal, or by the
// eigenvectors where what is left beside it would count.
std::optional<InexactEigenvalues> nearly_diagonal(const MatrixXcd& M, const MatrixXd& change) {
  MatrixXd beside = M.cwiseAbs();
  beside.diagonal().setZero();
  InexactEigenvalues result{M.diagonal(), gershgorin_radii(M.diagonal(), change + beside)};
  if ((result.radius.array() <= 1.1 * change.diagonal().array()).all()) return result;
  const std::optional<dense::Eigenpairs> pairs = dense::eigenpairs(M);
  if (!pairs) return std::nullopt;
  const MatrixXcd& W = pairs->vectors;
  const MatrixXd solved = MatrixXd::Constant(M.rows(), M.rows(), eps * M.norm());
  InexactEigenvalues turned{
      pairs->values, gershgorin_radii(pairs->values, dense::inverse(W).cwiseAbs() * (change + solved) * W.cwiseAbs())};
  return turned.radius.maxCoeff() < result.radius.maxCoeff() ? turned : result;
}

// F_0 = V, F_i diag(d_i) = D_i F_(i-1) with columns of length 1: in these frames the turn's map is diagonal and a
// change of a cell's map is F_i^-1 dD_i F_(i-1), carried over the turn entry by entry.
std::optional<InexactEigenvalues> framed(const CellChain& chain, const MatrixXcd& V, double log_size) {
  const Index p = chain.size(), N = chain.num_cells(), entries = p * p;
  const bool exact = chain.given.cwiseAbs().maxCoeff() == 0;
  MatrixXd X = V.real(), Y = V.imag(), next_X(p, p), next_Y(p, p);  // F = X + i Y
  MatrixXd before(p, p), inverse(p, p), part(p, p), variance(p, p), given = MatrixXd::Zero(p, p);
  VectorXd d(p), g = VectorXd::Ones(p);  // g: growth of each column so far, over 2^exponent
  EntryErrors change(p, chain.joined);
  InverseSquares invert(p);
  int exponent = 0;
  for (Index i = 0; i < N; ++i) {
    const auto cell = [&](const MatrixXd& all) { return all.data() + entries * i; };
    for (Index k = 0; k < entries; ++k) before(k) = X(k) * X(k) + Y(k) * Y(k);
    multiply(p, cell(chain.factors), X.data(), next_X.data());
    multiply(p, cell(chain.factors), Y.data(), next_Y.data());
    for (Index j = 0; j < p; ++j) {
      d(j) = std::sqrt(next_X.col(j).squaredNorm() + next_Y.col(j).squaredNorm());
      X.col(j) = next_X.col(j) / d(j);
      Y.col(j) = next_Y.col(j) / d(j);
    }
    invert(X, Y, inverse);
    // |F_i^-1|^2 |dD_i|^2 |F_(i-1)|^2 of rounding, |F_i^-1| |dD_i| |F_(i-1)| of coefficients
    multiply(p, inverse.data(), cell(chain.rounding), part.data());
    multiply(p, part.data(), before.data(), variance.data());
    if (!exact) {
      for (Index k = 0; k < entries; ++k) {
        before(k) = std::sqrt(before(k));
        inverse(k) = std::sqrt(inverse(k));
      }
      multiply(p, inverse.data(), cell(chain.given), part.data());
      multiply(p, part.data(), before.data(), given.data());
    }
    change.carry(d, g, variance, given);
    for (Index j = 0; j < p; ++j) g(j) *= d(j);
    const double largest = g.maxCoeff();
    if (!(largest > 0 && std::isfinite(largest))) return std::nullopt;
    int e = 0;
    std::frexp(largest, &e);
    g *= std::ldexp(1.0, -e);
    change.divide(std::ldexp(1.0, e));
    exponent += e;
  }
  MatrixXcd F(p, p);
  F.real() = X;
  F.imag() = Y;
  const MatrixXcd back = dense::inverse(V), turned = back * (chain.closing * F) * g.asDiagonal();
  change.variance += multiplied * multiplied * double(p) * back.rowwise().squaredNorm() * g.cwiseAbs2().transpose();
  std::vector<bool> real(static_cast<std::size_t>(p));
  for (Index j = 0; j < p; ++j) real[std::size_t(j)] = V.col(j).imag().isZero(0);
  std::optional<InexactEigenvalues> result = nearly_diagonal(turned, change.total(real));
  if (!result) return std::nullopt;
  pair_up(*result);
  const double factor = std::exp(exponent * std::numbers::ln2 - log_size);
  result->value *= factor;
  result->radius *= factor;
  if (!result->radius.allFinite()) return std::nullopt;
  return result;
}

// Pairs of neighbours as one factor each, D_2 D_1.
CellChain in_pairs(const CellChain& chain) {
  const Index p = chain.size(), N = chain.num_cells() / 2, entries = p * p;
  const bool rounded = chain.rounding.size() > 0, changed = chain.given.size() > 0 && !chain.given.isZero(0);
  CellChain pairs{MatrixXd(p, p * N), MatrixXd(p, rounded ? p * N : 0), {}, chain.closing, 2 * chain.joined};
  if (chain.given.size() > 0) pairs.given = MatrixXd::Zero(p, p * N);
  MatrixXd first(p, p), second(p, p), early(p, p), late(p, p), own(p, p);
  for (Index i = 0; i < N; ++i) {
    const auto cell = [&](const MatrixXd& all, Index k) { return all.data() + entries * k; };
    const double *one = cell(chain.factors, 2 * i), *two = cell(chain.factors, 2 * i + 1);
    multiply(p, two, one, pairs.factors.data() + entries * i);
    if (rounded) {
      for (Index k = 0; k < entries; ++k) first(k) = one[k] * one[k], second(k) = two[k] * two[k];
      multiply(p, second.data(), cell(chain.rounding, 2 * i), early.data());
      multiply(p, cell(chain.rounding, 2 * i + 1), first.data(), late.data());
      multiply(p, second.data(), first.data(), own.data());
      double* rounding = pairs.rounding.data() + entries * i;
      for (Index k = 0; k < entries; ++k)
        rounding[k] = early(k) + 2 * std::sqrt(early(k) * late(k)) + late(k) + multiplied * multiplied * p * own(k);
    }
    if (changed) {
      for (Index k = 0; k < entries; ++k) first(k) = std::abs(one[k]), second(k) = std::abs(two[k]);
      multiply(p, second.data(), cell(chain.given, 2 * i), early.data());
      multiply(p, cell(chain.given, 2 * i + 1), first.data(), late.data());
      pairs.given.middleCols(p * i, p) = early + late;
    }
  }
  return pairs;
}

}  // namespace

CellChain joined(CellChain chain, double damping) {
  constexpr Index most = 4;
  constexpr double most_damping = 4, most_growth = 8;
  while (2 * chain.joined <= most && chain.num_cells() % 2 == 0 && 2 * double(chain.joined) * damping <= most_damping) {
    CellChain pairs = in_pairs(chain);
    const Index p = chain.size();
    for (Index i = 0; i < pairs.num_cells(); ++i)
      if (!(pairs.factors.middleCols(p * i, p).norm() <= most_growth * std::sqrt(double(p)))) return chain;
    chain = std::move(pairs);
  }
  return chain;
}

double CellErrors::total(bool real) const {
  constexpr double deviations = 3;
  const double alike = real ? 0.7 : 0.4;
  return deviations * eps * std::sqrt(variance + alike * alike * deviation * deviation) + given;
}

SizedProduct sized_product(const MatrixXd& factors) {
  const Index p = factors.rows();
  MatrixXd product = factors.leftCols(p), next;
  int exponent = 0;
  for (Index first = p; first < factors.cols(); first += p) {
    multiply_columns(factors, first, product, next);
    exponent += normalised(next);
    product.swap(next);
  }
  const Size total{std::max(product.norm(), 1e-300), exponent};
  return {product / total.value, total.log()};
}

ChainProduct product_of(const CellChain& chain) {
  const Index p = chain.size(), N = chain.num_cells();
  const auto cell = [&](const MatrixXd& all, Index i) { return all.middleCols(p * i, p); };
  // Products of the cells before each, over 2^exponent.
  MatrixXd before(p, p * (N + 1));
  std::vector<int> exponents(std::size_t(N) + 1, 0);
  before.leftCols(p).setIdentity();
  for (Index i = 0; i < N; ++i) {
    auto next = before.middleCols(p * (i + 1), p);
    multiply(p, cell(chain.factors, i).data(), cell(before, i).data(), next.data());
    exponents[std::size_t(i) + 1] = exponents[std::size_t(i)] + normalised(next);
  }
  const Size total{std::max(before.rightCols(p).norm(), 1e-300), exponents.back()};
  MatrixXd behind = MatrixXd::Identity(p, p), next(p, p), turned(p, p);
  int behind_exponent = 0;
  Size bound;
  CellErrors change{.joined = chain.joined}, trace = change;
  for (Index i = N - 1; i >= 0; --i) {
    const auto a = cell(before, i), rounding = cell(chain.rounding, i), given = cell(chain.given, i);
    const double scale = std::ldexp(
        1 / total.value, std::clamp(exponents[std::size_t(i)] + behind_exponent - total.exponent, -1000, 1000));
    const double norms = std::min(a.norm() * scale * behind.norm(), 1e200);
    change.add(norms * norms * rounding.sum(), norms * given.norm());
    multiply(p, a.data(), behind.data(), next.data());
    turned = (scale * next.cwiseAbs()).cwiseMin(1e200).transpose();
    trace.add(turned.cwiseAbs2().cwiseProduct(rounding).sum(), turned.cwiseProduct(given).sum());
    const auto factor = cell(chain.factors, i);
    bound.value *= factor.norm() + 4 * eps * std::sqrt(rounding.sum()) + given.norm();
    bound.normalise();
    multiply(p, behind.data(), factor.data(), next.data());
    behind.swap(next);
    behind_exponent += normalised(behind);
  }
  return {chain.closing * (before.rightCols(p) / total.value),
          total.log(),
          change.total(false),
          trace.total(false),
          trace.total(true),
          bound.log()};
}

std::optional<InexactEigenvalues> framed_eigenvalues(const CellChain& chain, const ChainProduct& product) {
  const std::optional<dense::Eigenpairs> start = dense::eigenpairs(product.M);
  if (!start) return std::nullopt;
  return framed(chain, start->vectors, product.log_size);
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
  VectorXd left(p), right(p);
  v << start.real(), start.imag();
  w << end.real(), end.imag();
  for (Index i = 0; i < N; ++i) {
    before.middleCols(2 * i, 2) = v;
    v = chain.factors.middleCols(p * i, p).lazyProduct(before.middleCols(2 * i, 2));
    v /= v.norm();
  }
  CellErrors change{.joined = chain.joined};
  for (Index i = N - 1; i >= 0; --i) {
    back = chain.factors.middleCols(p * i, p).transpose().lazyProduct(w);
    const auto here = before.middleCols(2 * i, 2);
    const cplx grown(back.col(0).dot(here.col(0)) - back.col(1).dot(here.col(1)),
                     back.col(0).dot(here.col(1)) + back.col(1).dot(here.col(0)));
    left = w.rowwise().squaredNorm();
    right = here.rowwise().squaredNorm();
    const double variance = left.dot(chain.rounding.middleCols(p * i, p).lazyProduct(right));
    left = left.cwiseSqrt();
    right = right.cwiseSqrt();
    const double given = left.dot(chain.given.middleCols(p * i, p).lazyProduct(right));
    change.add(variance / std::norm(grown), given / std::abs(grown));
    w = back / back.norm();
  }
  // The rounding of the eigenvalue of the product.
  change.variance += double(p) / std::pow(at_end * std::abs(mu), 2);
  return change.total(mu.imag() == 0);
}

}  // namespace hb
