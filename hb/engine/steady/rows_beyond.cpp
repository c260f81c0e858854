#include "hb/engine/steady/rows_beyond.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/modulus.hpp"
#include "lib/stop_wish.hpp"

namespace hb::steady {

namespace {

using Index = Eigen::Index;

// Last harmonic at or below k of mode i where |D_i|^2 = (w^2 - k^2)^2 + (k G)^2 is least.
Index below_resonance(const WeightedSystem& s, Index i) {
  constexpr double most = 1e12;
  return static_cast<Index>(std::min(std::sqrt(std::max(s.mean(i) - 0.5 * s.G(i, i) * s.G(i, i), 0.0)), most));
}

// What coupling moves w_i^2 by at harmonic k, at most and to second order, m = 1..P and j != i,
//     sum_j |B_ij B_ji|/|D_j(k)| + sum_m (|K_m,ii|^2 |1/D_i(k+m) + 1/D_i(k-m)|
//                                         + sum_j |K_m,ij|^2 (1/|D_j(k+m)| + 1/|D_j(k-m)|)).
double moved(const WeightedSystem& s, Index i, Index k) {
  const double trifling = 1e-8 * s.coupling(i) * s.coupling(i);
  double sum = 0;
  const auto within = [&](Index to, Index from) {
    return std::complex<double>(s.K(to + s.I * from, 0).real(), static_cast<double>(k) * s.G_off(to, from));
  };
  for (Index j = 0; j < s.I; ++j)
    if (const double strength = modulus(within(i, j)) * modulus(within(j, i)); j != i && strength > 0)
      sum += strength / std::max(modulus(s.D(j, k)), 32 * eps * s.magnitude(j, k));
  for (Index m = 1; m <= s.P; ++m)
    for (Index j = 0; j < s.I; ++j) {
      const double strength = std::norm(s.K(i + s.I * j, m));
      if (strength <= trifling) continue;
      const std::complex<double> up = s.D(j, k + m), down = s.D(j, std::abs(k - m));
      const double sizes = modulus(up) * modulus(down);
      sum += strength / sizes * (j == i ? modulus(up + down) : modulus(up) + modulus(down));
    }
  return sum;
}

// |D_i(k)|, about its least less twice what coupling moves it by, down to the damping, rounding, or a millionth of what
// it is moved by: no nearer do systems come that were not sought for it.
double stiffness(const WeightedSystem& s, Index i, Index k) {
  constexpr double as_near = 1e-6;
  const Index above = k - below_resonance(s, i);
  const double d = modulus(s.D(i, k));
  if (above < 0 || above > 1) return d;
  const double by = 2 * moved(s, i, k);
  return std::max({d - by, as_near * by, static_cast<double>(k) * std::abs(s.G(i, i)), 32 * eps * s.magnitude(i, k)});
}

// Largest c_i/|D_i(k)| over k >= first, c_i all that couples row k of mode i to others.
double largest_answer(const WeightedSystem& s, Index i, Index first) {
  const Index k = std::max(below_resonance(s, i), first);
  const auto answer = [&](Index n) {
    return (s.coupling(i) + static_cast<double>(n) * s.across(i)) / stiffness(s, i, n);
  };
  return std::max(answer(k), answer(k + 1));
}

// The rows before, the next ones after them, and what all of them add up to, moduli of both signs together.
class Rows {
 public:
  Rows(const WeightedSystem& s, const Spectrum& x, const Spectrum& rest, const Spectrum& r, Index H, double known,
       const Eigen::MatrixXd& T)
      : s_(s),
        r_(r),
        T_(T),
        sums_(s.I, s.I * s.P),
        last_(Eigen::VectorXd::Zero(s.I * s.P)),
        total_(Eigen::VectorXd::Zero(s.I)),
        answer_(s.I) {
    const Index I = s.I, P = s.P, R = x.rows() - 1;
    // Coefficients of a_k-1, a_k-2, ..., a_k-P one below the other, as `last` has them.
    for (Index m = 1; m <= P; ++m) sums_.middleCols(I * (m - 1), I) = moduli(s.K.col(m)).reshaped(I, I);
    Eigen::VectorXd before = Eigen::VectorXd::Zero(I);
    for (Index k = H + 1; k <= R; ++k)
      for (Index i = 0; i < I; ++i) {
        const double here = modulus(x(k, i)) + (rest(k, i) == 0.0 ? 0 : modulus(rest(k, i)) / modulus(s.D(i, k)));
        if (R - k < P) last_(I * (R - k) + i) = here;
        before(i) += here;
      }
    if (const double size = weigh(before, T); size > 0) last_ *= known / size;
  }

  void next(Index k) {
    const Index I = s_.I;
    answer_.noalias() = sums_ * last_;
    if (k < r_.rows()) answer_ += 2 * moduli(r_.row(k)).transpose();
    Eigen::VectorXd coupled;
    if (s_.coupled_within(k) > 0.01) coupled = moduli(dense::Lu<std::complex<double>>(s_.block(k)).inverse()) * answer_;
    for (Index i = 0; i < I; ++i) answer_(i) /= stiffness(s_, i, k);
    if (coupled.size() > 0) answer_ = answer_.cwiseMax(coupled);
    total_ += answer_;
    if (s_.P == 0) return;
    std::shift_right(last_.begin(), last_.end(), I);
    last_.head(I) = answer_;
  }

  // What rows R+1, R+2, ... answer comes back to rows before them down to H + 1.
  void back(Index R, Index H) {
    const Index I = s_.I;
    for (Index k = R; k > std::max(H, R - s_.P); --k) {
      answer_.setZero();
      for (Index n = 0; n < first_.cols() && R + 1 + n - k <= s_.P; ++n)
        answer_ += sums_.middleCols(I * (R + n - k), I) * first_.col(n);
      answer(k);
      total_ += answer_;
    }
  }

  double last() const { return s_.P > 0 ? weigh(last_.reshaped(s_.I, s_.P).rowwise().sum(), T_) : 0; }
  double total() const { return weigh(total_, T_); }

 private:
  void answer(Index k) {
    Eigen::VectorXd coupled;
    if (s_.coupled_within(k) > 0.01) coupled = moduli(dense::Lu<std::complex<double>>(s_.block(k)).inverse()) * answer_;
    for (Index i = 0; i < s_.I; ++i) answer_(i) /= stiffness(s_, i, k);
    if (coupled.size() > 0) answer_ = answer_.cwiseMax(coupled);
  }

  const WeightedSystem& s_;
  const Spectrum& r_;
  const Eigen::MatrixXd& T_;
  Eigen::MatrixXd sums_, first_;
  Eigen::VectorXd last_, total_, answer_;
};

}  // namespace

double weigh(const Eigen::VectorXd& sizes, const Eigen::MatrixXd& T) {
  double largest = 0;
  for (Index i = 0; i < T.rows(); ++i) {
    double sum = 0;
    for (Index j = 0; j < T.cols(); ++j) sum += std::abs(T(i, j)) * sizes(j);
    if (!std::isfinite(sum)) return sum;
    largest = std::max(largest, sum);
  }
  return largest;
}

// Row after row until no resonance is ahead and rows shrink, or all that are ahead could not make them count.
double answered_beyond(const WeightedSystem& s, const Spectrum& x, const Spectrum& rest, const Spectrum& r, Index H,
                       double known, const Eigen::MatrixXd& T) {
  constexpr double among = 2, shrinking = 0.3, negligible = 1e-3, no_end = 1e8;
  constexpr Index most_rows = 100000, between_looks = 32;
  const Index R = x.rows() - 1, F = r.rows() - 1;
  double ahead = 0, all = 1;
  const auto look = [&](Index k) {
    ahead = 0, all = s.coupled_within(k) > 0.1 ? HUGE_VAL : 1;
    for (Index i = 0; i < s.I; ++i) {
      const double one = largest_answer(s, i, k);
      ahead = std::max(ahead, one);
      all *= std::max(one, 1.0);
    }
  };
  look(R + 1);
  const bool loaded = F > R && !r.bottomRows(F - R).isZero(0);
  if (ahead <= shrinking && !loaded) return among * known * ahead / (1 - ahead);
  Rows rows(s, x, rest, r, H, known, T);
  for (Index k = R + 1; k <= R + most_rows; ++k) {
    rows.next(k);
    if (k == R + std::max<Index>(s.P, 1)) rows.back(R, H);
    if (k < F || k < R + s.P || ((k - R) % between_looks != 0 && !loaded)) continue;
    end_if_wished();
    look(k + 1);
    const double size = rows.last(), so_far = rows.total();
    if (size == 0) return among * so_far;
    if (ahead <= shrinking) return among * (so_far + size * ahead / (1 - ahead));
    if (size * all <= negligible * known) return among * (so_far + negligible * known);
    if (!(so_far <= no_end * known)) break;
  }
  return HUGE_VAL;
}

}  // namespace hb::steady
