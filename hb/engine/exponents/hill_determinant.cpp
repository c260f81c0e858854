#include "hb/engine/exponents/hill_determinant.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "hb/engine/exponents/inexact_roots.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

constexpr Index most_unknowns = 1200;  // of the whole half window, and of the core and a block
constexpr double most_turns = 1e4;  // of the fastest mode: so far are pairs of harmonics looked at
constexpr double settled = 1e-9;
// A root of D nearer to s + ik than this leaves the row's divisor and the product of sines, where the two cancel.
constexpr double near = 0.1;

// ln(2 sinh pi z) without overflow.
cplx log_two_sinh(cplx z) {
  return z.real() >= 0 ? pi * z + std::log(1.0 - std::exp(-2 * pi * z))
                       : -pi * z + std::log(1.0 - std::exp(2 * pi * z)) + cplx(0, pi);
}

// ln(2 sinh(pi z)/z) for small z.
cplx log_two_sinh_over(cplx z) {
  const cplx x2 = pi * pi * z * z;
  return std::log(2 * pi * (1.0 + x2 / 6.0 * (1.0 + x2 / 20.0 * (1.0 + x2 / 42.0 * (1.0 + x2 / 72.0)))));
}

cplx log_determinant(const dense::Lu<cplx>& lu) {
  cplx sum(0, lu.sign() < 0 ? pi : 0);
  for (const cplx& pivot : lu.pivots()) sum += std::log(pivot);
  return sum;
}

// Turns of the fastest mode in one of the crank, about.
double fastest(const VectorXcd& p, const VectorXcd& p_other) {
  return std::max(p.cwiseAbs().maxCoeff(), p_other.cwiseAbs().maxCoeff());
}

}  // namespace

HillDeterminant::HillDeterminant(const ScaledSystem& system)
    : I_(system.num_modes()), P_(system.K.num_harmonics()), K_(system.K), p_(I_), p_other_(I_) {
  if (!system.diagonal_damping) throw std::invalid_argument("HillDeterminant: the damping must be diagonal");
  const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  for (Index i = 0; i < I_; ++i) {
    const cplx root = std::sqrt(cplx(b(i) * b(i) / 4 - w2(i), 0));
    p_(i) = -b(i) / 2 + root;
    p_other_(i) = -b(i) / 2 - root;
    K_.c(i + I_ * i, 0) = 0;  // from here on E, what D leaves of K
  }
}

// The infinite matrix at one s, each row over its divisor.
class HillDeterminant::Matrix {
 public:
  Matrix(const FourierSeries& K, const VectorXcd& p, const VectorXcd& p_other, cplx s, Index P)
      : K_(K), p_(p), p_other_(p_other), s_(s), I_(p.size()), P_(P) {}

  // Harmonics up to it, where the coupling is strong.
  [[nodiscard]] Index core(Index H) const {
    VectorXd pull = VectorXd::Zero(I_);
    for (Index i = 0; i < I_; ++i)
      for (Index j = 0; j < I_; ++j) pull(i) += 2 * K_.c.row(i + I_ * j).cwiseAbs().sum();
    Index core = std::min(P_, H);
    for (Index k = core; k <= H; ++k)
      for (Index i = 0; i < I_; ++i)
        if (pull(i) > 0.5 * std::min(std::abs(D(i, k)), std::abs(D(i, -k)))) core = k;
    return core;
  }

  // Of harmonics up to H: S = A_nn - A_n,n+1 S_{n+1}^-1 A_n+1,n from the outermost harmonics to the core, on both
  // sides. All blocks but the outermost one hold P harmonics, so that none reaches past its neighbour.
  [[nodiscard]] Value window_determinant(Index H, Index core) const {
    cplx log_det = 0;
    MatrixXcd A = block({-core, core}, {-core, core});
    const Index step = std::max<Index>(P_, 1);
    for (const Index side : {1, -1}) {
      const auto rows = [&](Index a, Index b) { return side > 0 ? Range{a, b} : Range{-b, -a}; };
      MatrixXcd S;
      Range outer;  // the block before
      for (Index to = H; to > core;) {
        const Index rest = (to - core) % step, from = to - (rest > 0 ? rest : step) + 1;
        const Range range = rows(from, to);
        MatrixXcd here = block(range, range);
        if (S.size() > 0) log_det += eliminate(S, outer, range, here);
        S = std::move(here);
        outer = range;
        to = from - 1;
      }
      if (S.size() > 0) log_det += eliminate(S, outer, {-core, core}, A);
    }
    const dense::Lu<cplx> lu(A);
    log_det += log_determinant(lu);
    return {log_det, 16 * eps * double(A.rows()) / lu.rcond()};
  }

  // -1/2 sum E_ij,m E_ji,-m / (D_i(k) D_j(k - m)) over pairs of harmonics that are not both inside; D ~ -k^2 beyond all
  // resonances.
  [[nodiscard]] cplx beyond_window(Index H) const {
    const Index far = std::max(4 * H, Index(4 * fastest(p_, p_other_))), all = far + P_;
    MatrixXcd inverse(2 * all + 1, I_);  // 1/D_i(k), k = -all..all
    for (Index i = 0; i < I_; ++i)
      for (Index k = -all; k <= all; ++k) inverse(k + all, i) = 1.0 / D(i, k);
    // Of harmonics from..to.
    const auto sum = [&](Index i, Index j, Index m, Index from, Index to) -> cplx {
      if (to < from) return 0;
      const Index count = to - from + 1;
      return inverse.col(i)
          .segment(from + all, count)
          .cwiseProduct(inverse.col(j).segment(from - m + all, count))
          .sum();
    };
    cplx second = 0;
    double trace = 0;
    for (Index m = 0; m <= P_; ++m) {
      end_if_wished();
      const double both = m > 0 ? 2 : 1;  // i, j, m and j, i, -m are the same pairs
      for (Index i = 0; i < I_; ++i)
        for (Index j = 0; j < I_; ++j) {
          const cplx product = both * E(i, j, m) * E(j, i, -m);
          if (product == 0.0) continue;
          // k - m <= H and k >= -H inside.
          second -= 0.5 * product * (sum(i, j, m, -far, m - H - 1) + sum(i, j, m, H + 1, far));
          trace += product.real();
        }
    }
    return second - trace / (3 * std::pow(double(far) + 0.5, 3));
  }

  // ln of the product of all 2 sinh pi (s - p_j), over the divisors of the rows.
  [[nodiscard]] cplx sines() const {
    cplx sum = 0;
    for (Index i = 0; i < I_; ++i)
      for (const cplx p : {p_(i), p_other_(i)}) {
        // s - p + ik with the k that makes it smallest: sinh pi (s - p) = (-1)^k sinh pi (s - p + ik).
        const double k = -std::round((s_ - p).imag());
        const cplx rest = s_ - p + cplx(0, k);
        sum += cplx(0, pi * k) + (std::abs(rest) > near ? log_two_sinh(rest) : log_two_sinh_over(rest));
      }
    return sum;
  }

 private:
  // Harmonics.
  struct Range {
    Index from = 0, to = 0;
  };

  [[nodiscard]] cplx E(Index i, Index j, Index m) const {
    const cplx c = K_.c(i + I_ * j, std::abs(m));
    return m >= 0 ? c : std::conj(c);
  }
  [[nodiscard]] cplx D(Index i, Index k) const {
    const cplx z = s_ + cplx(0, double(k));
    return (z - p_(i)) * (z - p_other_(i));
  }
  // D without the roots that are near.
  [[nodiscard]] cplx divisor(Index i, Index k) const {
    const cplx z = s_ + cplx(0, double(k));
    cplx d = 1;
    for (const cplx p : {p_(i), p_other_(i)})
      if (std::abs(z - p) > near) d *= z - p;
    return d;
  }

  [[nodiscard]] MatrixXcd block(Range rows, Range columns) const {
    MatrixXcd A = MatrixXcd::Zero((rows.to - rows.from + 1) * I_, (columns.to - columns.from + 1) * I_);
    for (Index k = rows.from; k <= rows.to; ++k)
      for (Index i = 0; i < I_; ++i) {
        const Index row = (k - rows.from) * I_ + i;
        const cplx inverse = 1.0 / divisor(i, k);
        for (Index l = std::max(columns.from, k - P_); l <= std::min(columns.to, k + P_); ++l)
          for (Index j = 0; j < I_; ++j) A(row, (l - columns.from) * I_ + j) = inverse * E(i, j, k - l);
        if (columns.from <= k && k <= columns.to) A(row, (k - columns.from) * I_ + i) += inverse * D(i, k);
      }
    return A;
  }

  // Takes what the harmonics `outer`, reduced to S, add to `A` of the harmonics `inner`; ln det S.
  [[nodiscard]] cplx eliminate(const MatrixXcd& S, Range outer, Range inner, MatrixXcd& A) const {
    const dense::Lu<cplx> lu(S);
    A -= block(inner, outer) * lu.solve(block(outer, inner));
    return log_determinant(lu);
  }

  const FourierSeries& K_;
  const VectorXcd &p_, &p_other_;
  cplx s_;
  Index I_, P_;
};

HillDeterminant::Value HillDeterminant::truncated(cplx s, Index H) const {
  end_if_wished();
  const Matrix matrix(K_, p_, p_other_, s, P_);
  const Index core = matrix.core(H);
  if ((2 * core + 1) * I_ > most_unknowns || P_ * I_ > most_unknowns) return {0, HUGE_VAL};
  const Value inside = matrix.window_determinant(H, core);
  return {inside.log + matrix.beyond_window(H) + matrix.sines(), inside.error};
}

HillDeterminant::Values HillDeterminant::settled_values(const VectorXcd& s, bool but_for_a_factor) const {
  Values values;
  Index H = std::max<Index>(P_ + P_ / 2, 16);
  if (H * I_ > most_unknowns || !(fastest(p_, p_other_) <= most_turns)) return values;
  VectorXcd log(s.size()), change(s.size());
  VectorXd rounding(s.size());
  // False where there is no value.
  const auto take = [&](Index window) {
    for (Index m = 0; m < s.size(); ++m) {
      const Value value = truncated(s(m), window);
      if (!std::isfinite(value.error)) return false;
      const cplx step = value.log - log(m);
      change(m) = cplx(step.real(), std::remainder(step.imag(), 2 * pi));
      log(m) = value.log;
      rounding(m) = value.error;
    }
    return true;
  };
  log.setZero();
  if (!take(H)) return values;
  double size = 0;
  do {
    H *= 2;
    if (H * I_ > most_unknowns || !take(H)) return values;
    if (but_for_a_factor) change.array() -= change.mean();
    const double before = size;
    size = change.cwiseAbs().maxCoeff();
    values.error = rounding.array() + left_by(size, before, H);
  } while (size > settled && 2 * H * I_ <= most_unknowns);
  if (std::isfinite(size)) values.log = log;
  return values;
}

// Terms of third order fall like H^-5 beyond all resonances: what is left is a small part of the change. Before that
// they fall slowly.
double HillDeterminant::left_by(double change, double before, Index H) const {
  constexpr double beyond = 1.5, slowly = 10;
  return double(H) >= beyond * fastest(p_, p_other_) ? change : slowly * std::max(change, before);
}

HillDeterminant::Value HillDeterminant::operator()(cplx s) const {
  const Values values = settled_values(VectorXcd::Constant(1, s), false);
  return values.log.size() > 0 ? Value{values.log(0), values.error(0)} : Value{0, HUGE_VAL};
}

HillDeterminant::Polynomial HillDeterminant::on_circle(double c) const {
  // e^{2 pi I s} F at s = c + i (m + 1/2)/M, three points more than the polynomial has coefficients.
  const Index degree = 2 * I_, M = degree + 4;
  VectorXcd s(M / 2);
  for (Index m = 0; m < M / 2; ++m) s(m) = cplx(c, (double(m) + 0.5) / double(M));
  const auto [log, error] = settled_values(s, true);
  if (log.size() == 0) return {};
  const VectorXcd log_P = log + cplx(0, 2 * pi * double(I_)) * s.imag();
  const double largest = log_P.real().maxCoeff();
  if (!std::isfinite(largest)) return {};
  const VectorXcd P = (log_P.array() - largest).exp();
  // Values at conjugate points are conjugate: coefficients are real.
  VectorXd a = VectorXd::Zero(M);
  for (Index r = 0; r < M; ++r)
    for (Index m = 0; m < M / 2; ++m)
      a(r) += 2 / double(M) * (P(m) * std::polar(1.0, -2 * pi * double(r) * (double(m) + 0.5) / double(M))).real();
  const double change =
      (P.cwiseAbs().cwiseProduct(error).maxCoeff() + a.tail(M - degree - 1).cwiseAbs().maxCoeff()) * double(degree + 1);
  return {a.head(degree + 1), change, error.maxCoeff()};
}

Exponents HillDeterminant::roots_near(double c, const Polynomial& polynomial) const {
  const auto& [a, change, value_error] = polynomial;
  Exponents result;
  const Index degree = a.size() - 1;
  if (degree < 1 || !(change < 0.1 * std::abs(a(degree)))) return result;
  const InexactRoots roots = inexact_roots(a, 1.2 * change);
  for (Index j = 0; j < degree; ++j) {
    const double size = std::abs(roots.value(j)), radius = roots.radius(j);
    if (std::isfinite(radius))
      result.add({c + std::log(size) / (2 * pi), std::arg(roots.value(j)) / (2 * pi)},
                 radius / (2 * pi * (size - radius)));
  }
  if (roots.rest > 0) result.others_below = c + std::log(roots.rest) / (2 * pi);
  return result;
}

std::optional<int> HillDeterminant::exponents_above(double c) const {
  const auto [a, change, value_error] = on_circle(c);
  if (a.size() == 0) return std::nullopt;
  const Index degree = a.size() - 1;
  const auto P = [&](double angle) {
    const cplx z = std::polar(1.0, angle);
    cplx sum = 0;
    for (Index r = degree; r >= 0; --r) sum = sum * z + a(r);
    return sum;
  };
  double slope = 0;  // largest |dP/d angle|
  for (Index r = 0; r <= degree; ++r) slope += double(r) * std::abs(a(r));
  constexpr Index most_points = Index(1) << 17;
  for (Index N = 64; N <= most_points; N *= 4) {
    // Between neighbours P changes by less than its size: the phase is followed.
    const double step = 2 * pi / double(N);
    double turned = 0;
    bool followed = true;
    cplx before = P(0);
    for (Index n = 1; n <= N && followed; ++n) {
      const cplx here = P(step * double(n));
      followed = std::abs(before) > step * slope + 2 * change;
      turned += std::arg(here / before);
      before = here;
    }
    if (followed) return static_cast<int>(degree - std::lround(turned / (2 * pi)));
  }
  return std::nullopt;
}

Exponents HillDeterminant::exponents() const {
  double c = std::max(p_.real().maxCoeff(), p_other_.real().maxCoeff());
  Exponents result;
  constexpr int most_circles = 6;
  for (int circle = 0, lost = 0; circle < most_circles; ++circle) {
    const Polynomial polynomial = on_circle(c);
    if (polynomial.a.size() == 0) return result;
    result = roots_near(c, polynomial);
    // Values so inexact serve on no circle.
    if (result.s.empty() && !(polynomial.value_error * double(2 * I_ + 1) < 0.1)) return result;
    double leading = result.others_below;
    for (const cplx s : result.s) leading = std::max(leading, s.real());
    if (!std::isfinite(leading)) {
      c += 0.5;  // the leading one lies too far outside
      continue;
    }
    if (std::abs(leading - c) < 0.02 && !result.s.empty()) break;
    if (result.s.empty() && ++lost > 1) break;
    c = leading;
  }
  return result;
}

}  // namespace hb
