#include "hb/engine/exponents/turn_exponents.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "hb/engine/exponents/cell_chain.hpp"
#include "hb/engine/exponents/qr_sweep.hpp"
#include "hb/engine/exponents/small_matrix.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

// One mode, two exponents: with the determinant known (Liouville), s = -b/2 +- acosh(disc)/(2 pi),
// disc = tr Phi/(2 sqrt(det Phi)) and det Phi = exp(-2 pi b), whatever the size of the multipliers.
TurnExponents discriminant(const ChainProduct& product, double damping) {
  const double mean = -damping / 2, trace = product.M.trace(), log_size = product.log_size;
  const double log_disc = std::log(std::max(std::abs(trace / 2), 1e-300)) + log_size - two_pi * mean;
  const double trace_change = log_disc > 0 ? product.real_trace_change : product.trace_change;
  const double mean_error = 2 * eps * std::abs(mean);
  // Rounding of the logarithms and of what is taken from them.
  const double relative = eps * (2 + std::abs(log_size) + std::abs(two_pi * mean));
  if (log_disc > 20) {  // acosh(x) = ln 2x to rounding
    const double growth = (log_disc + std::numbers::ln2) / two_pi, angle = trace < 0 ? 0.5 : 0;
    const double error = mean_error + (trace_change / std::abs(trace) + relative) / two_pi;
    return {{{mean + growth, angle}, {mean - growth, angle}}, {error, error}, -HUGE_VAL, {}};
  }
  const double scale = std::exp(log_size - two_pi * mean);
  const double disc = trace / 2 * scale, error = trace_change / 2 * scale + relative * std::abs(disc);
  const double size = std::abs(disc), angle = disc < 0 ? 0.5 : 0;
  TurnExponents result;
  if (size <= 1) {
    const double turn = std::acos(std::clamp(disc, -1.0, 1.0)) / two_pi;
    // Within `error` of +-1 the pair may as well be real.
    const double slack = (std::acos(std::max(size - error, -1.0)) - std::acos(size)) / two_pi;
    const double growth = size + error > 1 ? std::acosh(std::max(1.0, size + error)) / two_pi : 0;
    const double bar = mean_error + slack + growth + 0.5 * eps;
    result.s = {{mean, -turn}, {mean, turn}};
    result.error = {bar, bar};
  } else {
    const double growth = std::acosh(size) / two_pi;
    const double up = std::acosh(size + error) / two_pi - growth;
    const double down = growth - std::acosh(std::max(1.0, size - error)) / two_pi;
    const double turn = size - error < 1 ? std::acos(std::max(size - error, -1.0)) / two_pi : 0;
    const double bar = mean_error + std::max(up, down) + turn + eps * growth;
    result.s = {{mean + growth, angle}, {mean - growth, angle}};
    result.error = {bar, bar};
  }
  return result;
}

// Variances of the rounding of one cell's map, n x n: half the terms that each entry is the sum of, which cannot be
// larger than the map where damping is strong (E11).
void rounding_variance(const TurnMaps& maps, Index cell, double* variance) {
  const Index n = maps.num_states();
  const double largest = maps.cells.middleCols(n * cell, n).norm();
  for (Index k = 0; k < n * n; ++k) {
    const double rounding = 0.5 * std::min(maps.terms(k), largest);
    variance[k] = rounding * rounding;
  }
}

// The whole maps as one chain.
CellChain whole_chain(const TurnMaps& maps, const MatrixXd& given) {
  const Index n = maps.num_states(), N = maps.num_cells;
  CellChain chain{maps.cells, MatrixXd(n, n * N), given.replicate(1, N), MatrixXd::Identity(n, n)};
  for (Index i = 0; i < N; ++i) rounding_variance(maps, i, chain.rounding.data() + n * n * i);
  return chain;
}

// What leading subspaces have not come back by, to first order (E20).
void close_turn(const QrSweep& sweep, const SubspaceBases& bases, std::vector<CellChain>& chains) {
  const Index n = sweep.R.rows();
  MatrixXd below = sweep.turned;
  Index begin = 0;
  for (const Index end : sweep.ends) {
    below.topRows(end).rightCols(n - begin).setZero();
    begin = end;
  }
  const MatrixXd start = dense::inverse(MatrixXd(bases.right.leftCols(n)));
  const MatrixXd end = dense::inverse(MatrixXd(bases.left.rightCols(n)));
  const MatrixXd change = start * below * end, size = start.cwiseAbs() * below.cwiseAbs() * end.cwiseAbs();
  constexpr double known_to = 0.1;  // of the bases
  begin = 0;
  for (CellChain& chain : chains) {
    const Index p = chain.size();
    chain.closing += change.block(begin, begin, p, p);
    // As a change of the last cell's factor.
    chain.given.rightCols(p) += known_to * chain.closing.transpose().cwiseAbs() * size.block(begin, begin, p, p) *
                                chain.factors.rightCols(p).cwiseAbs();
    begin += p;
  }
}

// One cell's numbers on their way, n x n each.
struct CellChanges {
  std::vector<double> left, right, part, frame;

  explicit CellChanges(Index n) : left(std::size_t(n * n)), right(left), part(left), frame(left) {}
};

// How the rounding of a cell's map, of variances `cell`, and of its sweep, `swept` an entry, and a bound `given` on its
// error change W_i Q_i^T E_i Q_(i-1) V_(i-1): variances and bound. Q: Q_(i-1), Q_i.
template <class Length>
void carry_changes(Length n, const double* Q, const double* W, const double* V, const double* cell, double swept,
                   const double* given, CellChanges& work, double* __restrict rounding, double* __restrict changed) {
  const Index entries = Index(n) * Index(n);
  double* __restrict left = work.left.data();
  double* __restrict right = work.right.data();
  double* __restrict frame = work.frame.data();
  for (Index r = 0; r < n; ++r)
    for (Index c = 0; c < n; ++c) frame[r + n * c] = Q[entries + c + n * r];
  multiply(n, W, frame, left);
  multiply(n, Q, V, right);
  for (Index k = 0; k < entries; ++k) left[k] = std::abs(left[k]), right[k] = std::abs(right[k]);
  if (given) {
    multiply(n, left, given, work.part.data());
    multiply(n, work.part.data(), right, changed);
  }
  for (Index k = 0; k < entries; ++k) left[k] *= left[k], right[k] *= right[k];
  multiply(n, left, cell, work.part.data());
  multiply(n, work.part.data(), right, rounding);
  // |rows of W|^2 |columns of V|^2
  for (Index r = 0; r < n; ++r) {
    double sum = 0;
    for (Index k = 0; k < n; ++k) sum += W[r + n * k] * W[r + n * k];
    left[r] = swept * sum;
  }
  for (Index c = 0; c < n; ++c) {
    double sum = 0;
    for (Index k = 0; k < n; ++k) sum += V[k + n * c] * V[k + n * c];
    for (Index r = 0; r < n; ++r) rounding[r + n * c] += left[r] * sum;
  }
}

// The diagonal blocks of R; errors are still to come.
std::vector<CellChain> blocks_of(const QrSweep& sweep) {
  const Index n = sweep.R.rows(), N = sweep.R.cols() / n;
  std::vector<CellChain> chains;
  Index begin = 0;
  for (const Index end : sweep.ends) {
    const Index p = end - begin;
    CellChain& chain = chains.emplace_back();
    chain.factors.resize(p, p * N);
    chain.closing = sweep.turned.block(begin, begin, p, p);
    for (Index i = 0; i < N; ++i) chain.factors.middleCols(p * i, p) = sweep.R.block(begin, n * i + begin, p, p);
    begin = end;
  }
  return chains;
}

// The diagonal blocks of R as chains: with V_i the bases of the invariant subspaces and W_i = V_i^-1, a change E_i of a
// cell's map is a change W_i E_i V_(i-1) of the blocks, to first order.
std::vector<CellChain> block_chains(const CellChain& whole, const QrSweep& sweep) {
  const Index n = whole.size(), N = whole.num_cells();
  const std::optional<SubspaceBases> bases = subspace_bases(sweep);
  std::vector<CellChain> chains = blocks_of(sweep);
  for (CellChain& chain : chains) {
    chain.rounding = chain.given = MatrixXd::Constant(chain.size(), chain.factors.cols(), HUGE_VAL);
    chain.joined = whole.joined;
  }
  if (!bases) return chains;
  const bool exact = whole.given.isZero(0);
  MatrixXd rounding(n, n), changed = MatrixXd::Zero(n, n);
  CellChanges work(n);
  constexpr Index often = 64;  // cells between looks
  for (Index i = 0; i < N; ++i) {
    if (i % often == 0) end_if_wished();
    // The sweep's own rounding knows no entries (E11).
    constexpr double per_entry = 0.6;
    const double swept = per_entry * sweep.R.middleCols(n * i, n).norm() * std::sqrt(double(whole.joined) / double(n));
    with_size(n, [&](auto size) {
      const auto cell = [&](const MatrixXd& all) { return all.data() + n * n * i; };
      carry_changes(size, cell(sweep.frames), cell(bases->left), cell(bases->right), cell(whole.rounding),
                    swept * swept, exact ? nullptr : cell(whole.given), work, rounding.data(), changed.data());
    });
    Index begin = 0;
    for (std::size_t b = 0; b < chains.size(); ++b) {
      const Index p = chains[b].size();
      chains[b].rounding.middleCols(p * i, p) = rounding.block(begin, begin, p, p);
      chains[b].given.middleCols(p * i, p) = changed.block(begin, begin, p, p);
      begin += p;
    }
  }
  close_turn(sweep, *bases, chains);
  return chains;
}

// Exponents of one chain; what is below its rounding is bounded.
class Collector {
 public:
  void add(cplx mu, double radius, double log_size) {
    const double modulus = std::abs(mu);
    if (!(radius < 0.5 * modulus)) return lose((std::log(modulus + radius) + log_size) / two_pi);
    double argument = std::arg(mu);
    if (argument <= -std::numbers::pi) argument = std::numbers::pi;
    const cplx s((std::log(modulus) + log_size) / two_pi, argument / two_pi);
    found_.s.push_back(s);
    // ln and arg of mu (1 + e), |e| <= radius/modulus; rounding of s.
    found_.error.push_back(-std::log1p(-radius / modulus) / two_pi + eps * (std::abs(log_size) / two_pi + std::abs(s)));
  }
  void lose(double bound) { found_.others_below = std::isnan(bound) ? HUGE_VAL : std::max(found_.others_below, bound); }
  TurnExponents sorted() && {
    std::vector<std::size_t> order(found_.s.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      if (found_.s[i].real() != found_.s[j].real()) return found_.s[i].real() > found_.s[j].real();
      return found_.s[i].imag() < found_.s[j].imag();
    });
    TurnExponents result;
    result.others_below = found_.others_below;
    for (const std::size_t i : order) {
      result.s.push_back(found_.s[i]);
      result.error.push_back(found_.error[i]);
    }
    return result;
  }

 private:
  TurnExponents found_;
};

// One exponent: ln of the product of all d_i, taken to twice the digits, (high + low) 2^exponent; with its error or
// without.
void add_single(const CellChain& chain, bool with_errors, Collector& collector) {
  double high = chain.closing(0), low = 0;
  int exponent = 0;
  CellErrors relative{.joined = chain.joined};
  for (Index i = 0; i < chain.num_cells(); ++i) {
    const double d = chain.factors(i), product = high * d;
    low = std::fma(high, d, -product) + low * d;
    int e = 0;
    high = std::frexp(product, &e);
    low = std::ldexp(low, -e);
    exponent += e;
    if (with_errors) relative.add(chain.rounding(i) / (d * d), chain.given(i) / std::abs(d));
  }
  const double radius = relative.total(true), size = std::abs(high);
  const double log = size > 0 ? std::log(size) + low / high + exponent * std::numbers::ln2 : -HUGE_VAL;
  collector.add(high < 0 ? -1 : 1, std::isfinite(log + radius) ? radius : HUGE_VAL, log);
}

// Whether the disc of one eigenvalue is small and touches no other one.
bool apart(const InexactEigenvalues& mu, Index one) {
  for (Index j = 0; j < mu.value.size(); ++j)
    if (j != one && !(std::abs(mu.value(j) - mu.value(one)) > mu.radius(j) + 10 * mu.radius(one))) return false;
  return mu.radius(one) < 0.1 * std::abs(mu.value(one));
}

// The largest multiplier, and where it is real the next one, which it may be locked to.
std::vector<Index> leading(const Eigen::VectorXcd& value) {
  Index first = 0;
  value.cwiseAbs().maxCoeff(&first);
  if (value(first).imag() != 0) return {first};
  Index second = first;
  for (Index j = 0; j < value.size(); ++j)
    if (j != first && (second == first || std::abs(value(j)) > std::abs(value(second)))) second = j;
  return {first, second};
}

// Several exponents of like size, or with `leading_only` all: only those near the largest are sought then.
void add_several(const CellChain& chain, bool leading_only, Collector& collector) {
  const ChainProduct product = product_of(chain);
  InexactEigenvalues mu;
  if (product.change < 0.5) mu = inexact_eigenvalues(product.M, product.change, leading_only);
  if (!leading_only) {
    const auto framed = framed_eigenvalues(chain, product);
    if (framed && (mu.value.size() == 0 || framed->radius.maxCoeff() < mu.radius.maxCoeff())) mu = *framed;
  } else if (mu.value.size() > 0) {
    for (const Index one : leading(mu.value)) {
      if (!apart(mu, one)) continue;
      const double relative = 1.1 * first_order_change(chain, product, mu.value(one), mu.radius(one));
      const double radius = relative * std::abs(mu.value(one));
      for (Index j = 0; j < mu.value.size(); ++j)
        if ((j == one || mu.value(j) == std::conj(mu.value(one))) && radius < mu.radius(j)) mu.radius(j) = radius;
    }
  }
  if (mu.value.size() == 0) return collector.lose(product.log_bound / two_pi);
  for (Index j = 0; j < mu.value.size(); ++j) collector.add(mu.value(j), mu.radius(j), product.log_size);
}

// Several exponents of closing D_N .. D_1 without their errors, but for those lost in the rounding of the product.
void add_values(const MatrixXd& factors, const MatrixXd& closing, Collector& collector) {
  constexpr double lost = 1e-12;
  const SizedProduct product = sized_product(factors);
  const Eigen::VectorXcd values = dense::eigenvalues(closing * product.M);
  for (const cplx mu : values) collector.add(mu, lost, product.log_size);
}

}  // namespace

TurnExponents turn_values(const TurnMaps& maps, bool leading_only) {
  const Index n = maps.num_states();
  TurnExponents result;
  if (n == 2) {
    const SizedProduct product = sized_product(maps.cells);
    result = discriminant({product.M, product.log_size, 0, 0, 0, 0}, maps.damping_trace);
  } else {
    Collector collector;
    QrSweep sweep;
    const CellChain whole = joined({maps.cells, {}, {}, MatrixXd::Identity(n, n)}, maps.damping);
    if (leading_only) {
      add_values(whole.factors, whole.closing, collector);
    } else {
      sweep = qr_sweep(whole.factors, {});
      for (const CellChain& chain : blocks_of(sweep))
        chain.size() == 1 ? add_single(chain, false, collector) : add_values(chain.factors, chain.closing, collector);
    }
    result = std::move(collector).sorted();
    if (!leading_only) result.subspaces = sweep.frames.rightCols(n);
  }
  result.error.assign(result.s.size(), HUGE_VAL);
  result.others_below = HUGE_VAL;
  return result;
}

TurnExponents turn_exponents(const TurnMaps& maps, const MatrixXd& given, bool leading_only,
                             const MatrixXd& subspaces) {
  CellChain whole = whole_chain(maps, given);
  if (maps.num_states() == 2) return discriminant(product_of(whole), maps.damping_trace);
  whole = joined(std::move(whole), maps.damping);
  Collector collector;
  if (leading_only) {
    add_several(whole, true, collector);
    return std::move(collector).sorted();
  }
  const QrSweep sweep = qr_sweep(whole.factors, subspaces);
  for (const CellChain& chain : block_chains(whole, sweep))
    chain.size() == 1 ? add_single(chain, true, collector) : add_several(chain, false, collector);
  TurnExponents result = std::move(collector).sorted();
  result.subspaces = sweep.frames.rightCols(maps.num_states());
  return result;
}

}  // namespace hb
