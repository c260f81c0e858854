#include "hb/engine/steady/steady_bound.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "hb/engine/steady/rows_beyond.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/modulus.hpp"

namespace hb::steady {

namespace {

using Index = Eigen::Index;

// Two solves estimate the norm of the inverse from below; this factor is a choice, its coverage is tested, not proved.
constexpr double safety = 3;
// In the one direction that gains most, next to a resonance, three inverse iterations found 6 times the estimate.
constexpr double worst_case = 20;
// Cap on the amplification granted to omitted rows that are coupled more strongly than their diagonal: a choice.
constexpr double most_tail_slack = 30;

// Of moduli, an expression.
template <class Moduli>
Eigen::VectorXd wiener(const Moduli& moduli) {
  Eigen::VectorXd norms(moduli.cols());
  for (Index i = 0; i < norms.size(); ++i) norms(i) = 2 * moduli.col(i).sum() - moduli(0, i);
  return norms;
}

// Numbers between -1 and 1 at random, the same ones every time; the first few are kept.
class RandomNumbers {
 public:
  double operator()() {
    if (next_ < kept().size()) return kept()[next_++];
    if (!further_) further_.emplace(seed).discard(kept().size());
    return number(*further_);
  }

 private:
  static constexpr unsigned seed = 12345;
  static double number(std::mt19937& random) { return 2.0 / 4294967295.0 * static_cast<double>(random()) - 1; }
  static const std::array<double, 1024>& kept() {
    static const std::array<double, 1024> numbers = [] {
      std::mt19937 random(seed);
      std::array<double, 1024> first{};
      for (double& value : first) value = number(random);
      return first;
    }();
    return numbers;
  }
  std::size_t next_ = 0;
  std::optional<std::mt19937> further_;
};

// What one harmonic of size 1 in all components makes of the sum over k of |(E e)_k/D(k)| at most, per component: of
// the window on rows H+1..R (`out`), of rows beyond it there (`among`) and, by |D| without cancellation, on the window
// (`back`).
struct Passages {
  Eigen::VectorXd out, among, back;
  Passages(const Operator& A, Index R);
};

// With c_m at least sum_j |(E_m)_ij| and falling: from harmonic h to k and -k at most c_|k-h| + c_(k+h).
Passages::Passages(const Operator& A, Index R) : out(Eigen::VectorXd::Zero(A.num_modes())), among(out), back(out) {
  const WeightedSystem& s = A.system();
  const Index H = A.num_harmonics(), I = s.I, last = std::max(2 * H + 1, R);
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(I, last + 2);
  Eigen::MatrixXd sizes(I, I);
  for (Index m = std::min(last, s.P); m > 0; --m) {
    sizes.reshaped() = moduli(s.K.col(m));
    c.col(m) = c.col(m + 1).cwiseMax(sizes.rowwise().sum());
  }
  for (Index i = 0; i < I; ++i) {
    for (Index k = H + 1; k <= R; ++k) {
      const double size = modulus(s.D(i, k));
      out(i) += (c(i, k - H) + c(i, k)) / size;
      among(i) = std::max(among(i), (s.coupling(i) + static_cast<double>(k) * s.across(i)) / size);
    }
    for (Index k = 0; k <= H; ++k) back(i) += (c(i, H + 1 - k) + c(i, H + 1 + k)) / A.magnitude()(k, i);
  }
}

// What e = A^-1 r is in q beside `tail` = D^-1 r beyond the window, to first order, where r on the window has no
// direction of its own, as rounding has none; infinite where a round from window to tail and back may not shrink.
double directionless(const Operator& A, const Spectrum& r, const Spectrum& tail, double response,
                     const Eigen::MatrixXd& T) {
  constexpr double shrinking = 0.3;
  const Index H = A.num_harmonics();
  const Passages way(A, tail.rows() - 1);
  if (!(safety * response * way.out.maxCoeff() * way.back.maxCoeff() <= shrinking)) return HUGE_VAL;
  if (!(way.among.maxCoeff() <= shrinking)) return HUGE_VAL;
  Eigen::VectorXd beyond = Eigen::VectorXd::Zero(A.num_modes());
  for (Index k = H + 1; k < tail.rows(); ++k) beyond += 2 * moduli(tail.row(k)).transpose();
  const double outside = beyond.maxCoeff();
  const double window =
      amplified(A, moduli(r.topRows(H + 1)), response, T) + worst_case * response * weigh(way.back * outside, T);
  const double component = window / T.cwiseAbs().colwise().maxCoeff().minCoeff();
  return window + weigh(way.out * component + way.among * outside, T);
}

// Size in q of what e has beyond the window.
double size_outside(const WeightedSystem& s, Index H, const Spectrum& r, const Spectrum& tail,
                    const Eigen::MatrixXd& T) {
  const Index R = tail.rows() - 1;
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(s.I);
  for (Index k = H + 1; k <= R; ++k) sizes += 2 * moduli(tail.row(k)).transpose();
  double size = weigh(sizes, T);
  if (r.rows() > R + 1) size += 2 * sizes_of_rows(s, r.bottomRows(r.rows() - R - 1), R + 1, T).sum();
  return size;
}

}  // namespace

double size_in_q(const Spectrum& x, const Eigen::MatrixXd& T) { return weigh(wiener_norms(x), T); }

double response(Operator& A, Inverse& inverse, const Eigen::MatrixXd& T) {
  const Index H = A.num_harmonics(), I = A.num_modes();
  // Phases at random; size falling with k as that of rounding errors does, u = D^-1 rhs.
  RandomNumbers random;
  Spectrum rhs(H + 1, I), z;
  for (Index k = 0; k <= H; ++k)
    for (Index i = 0; i < I; ++i) {
      const double re = random();
      const double im = k > 0 ? random() : 0;
      const double size = (1 + std::abs(A.system().mean(i))) / (A.system().coupling(i) + 1 + static_cast<double>(k));
      rhs(k, i) = {re * size, im * size};
    }
  double largest = 1;
  for (int step = 0; step < 2; ++step) {
    const double size = weigh(wiener(moduli(rhs).cwiseQuotient(A.magnitude())), T);
    // A random load holds the direction nearest to resonance by about 1/sqrt(unknowns): solved to a fifth of that. The
    // second holds it fully.
    inverse.solve(rhs, step == 0 ? 0.2 / std::sqrt(static_cast<double>(I * (2 * H + 1))) : 0.05, z);
    const double gained = size_in_q(z, T) / size;
    if (!std::isfinite(gained)) return std::nan("");
    largest = std::max(largest, gained);
    rhs = z.array() * (A.magnitude() / moduli(z).maxCoeff()).array();
  }
  return largest;
}

double amplified(const Operator& A, const Eigen::MatrixXd& r, double response, const Eigen::MatrixXd& T) {
  return amplified(wiener(r.cwiseQuotient(A.magnitude())), response, T);
}

double amplified(const Eigen::VectorXd& sizes, double response, const Eigen::MatrixXd& T) {
  return safety * response * weigh(sizes, T);
}

// hb/engine/README.md (S6).
Correction correction(Operator& A, Inverse& inverse, const Spectrum& r, double response, const Eigen::MatrixXd& T,
                      double enough, double negligible, double hidden) {
  // What a solve leaves, near resonance in the very direction that matters, grows by the response; the next residual
  // sees what it missed.
  const double accuracy = std::max(0.05 / response, 1e-12);
  constexpr int most_steps = 8;
  const WeightedSystem& s = A.system();
  const Index H = A.num_harmonics(), I = A.num_modes(), R = std::max(H, std::min(A.last_row(), r.rows() - 1));
  Correction result{.window = Spectrum::Zero(H + 1, I), .rest = HUGE_VAL};
  Spectrum rho = Spectrum::Zero(R + 1, I), e = rho, tail = rho, product, z;
  rho.topRows(std::min(R + 1, r.rows())) = r.topRows(std::min(R + 1, r.rows()));
  const auto take = [&](bool window, bool outside) {  // rho -= A e of one part or both
    Spectrum part = e.topRows((outside ? R : H) + 1);
    if (!window) part.topRows(H + 1).setZero();
    A.couple(part, R, product);
    rho -= product;
    rho.topRows(H + 1) -= A.D().cwiseProduct(part.topRows(H + 1));
    for (Index k = H + 1; k < part.rows(); ++k)
      for (Index i = 0; i < I; ++i) rho(k, i) -= s.D(i, k) * part(k, i);
  };
  const auto answer_beyond = [&] {
    for (Index k = H + 1; k <= R; ++k) {
      for (Index i = 0; i < I; ++i) e(k, i) = rho(k, i) == 0.0 ? 0.0 : rho(k, i) / s.D(i, k);
      if (s.coupled_within(k) > 0.01)
        e.row(k) = dense::Lu<std::complex<double>>(s.block(k)).solve(rho.row(k).transpose()).transpose();
    }
    tail.bottomRows(R - H) += e.bottomRows(R - H);
  };
  answer_beyond();
  const double foretold = hidden > 0 ? directionless(A, rho, tail, response, T) : HUGE_VAL;
  const bool told = foretold <= hidden;
  if (told) result.rest = foretold;
  // Contraction of one round, window -> tail -> window, at most.
  double step_out = 0;
  for (Index i = 0; i < I; ++i)
    for (Index k = H + 1; k <= R; ++k) step_out = std::max(step_out, s.coupling(i) / modulus(s.D(i, k)));
  const double round = response * step_out * step_out;
  double previous = 0, before = 0, first_ratio = 0;
  for (int step = 0; step < most_steps && !told; ++step) {
    if (step > 0) answer_beyond();
    // The first time window and tail at once, then one after the other: the tail's answer may be at resonance.
    if (step > 0 && R > H) take(false, true);
    if (!inverse.solve(rho.topRows(H + 1), accuracy, z)) break;
    e.topRows(H + 1) = z;
    result.window += z;
    const double size = size_in_q(e, T);
    if (!std::isfinite(size)) {
      result.rest = HUGE_VAL;
      break;
    }
    // Nothing to shrink against at first.
    const double ratio = step > 0 ? size / previous : HUGE_VAL, last_ratio = step > 1 ? previous / before : HUGE_VAL;
    if (step == 1) first_ratio = ratio;
    const bool shrinking = ratio <= 0.3 && (round <= 0.3 || last_ratio <= 0.3);
    const double rate = std::max(ratio, round <= 0.3 ? 0 : last_ratio);
    if (size == 0) {
      result.rest = 0;
      break;
    }
    if (step == 0 && size <= negligible && round <= 0.3) {
      take(true, true);
      const double left = amplified(A, moduli(rho.topRows(H + 1)), response, T) +
                          (R > H ? 2 * sizes_of_rows(s, rho.bottomRows(R - H), H + 1, T).sum() : 0);
      if (left <= negligible) {
        result.rest = size + left;
        break;
      }
      previous = size;
      continue;
    }
    if (shrinking || (step + 1 == most_steps && rate <= 0.7)) {
      result.rest = size * std::max(1.0, 2 * rate / (1 - rate));
      if (size <= enough) break;
    } else if (std::isfinite(result.rest)) {  // rounding reached
      result.rest += size;
      break;
    }
    before = previous;
    previous = size;
    take(true, step == 0);
  }
  result.outside = size_outside(s, H, r, tail, T);
  // What comes back to the window from rows beyond R grows there as the first step's answer from the tail did.
  const double known = result.outside + result.rest;
  if (known > 0 && std::isfinite(known)) {
    const double answered = answered_beyond(s, tail, rho, r, H, known, T);
    result.beyond = std::max(1.0, first_ratio) * (1 + round) * answered;
    result.resonance_ahead = answered > 0.3 * known;
  }
  return result;
}

Eigen::VectorXd sizes_of_rows(const WeightedSystem& system, const Spectrum& rows, Index first,
                              const Eigen::MatrixXd& T) {
  Eigen::VectorXd result(rows.rows()), sizes(rows.cols());
  for (Index k = 0; k < result.size(); ++k) {
    for (Index i = 0; i < sizes.size(); ++i) {
      const double size = modulus(rows(k, i));
      sizes(i) = size > 0 ? size / modulus(system.D(i, first + k)) : size;
    }
    result(k) = weigh(sizes, T);
  }
  return result;
}

// Coupling E shifts w^2 by about E^2/|D(k +- m)|, |D(k +- m)| >= k.
bool resonant_beyond(const WeightedSystem& system, Index H) {
  for (Index i = 0; i < system.I; ++i) {
    if (!(system.mean(i) > 0 && system.mean(i) < 1e15)) continue;
    const Index k = static_cast<Index>(std::llround(std::sqrt(system.mean(i))));
    if (k <= H) continue;
    const double closest = 32 * eps * system.magnitude(i, k), shift = system.coupling(i) * system.coupling(i);
    if (std::abs(system.D(i, k)) <= closest && shift <= closest * static_cast<double>(k)) return true;
  }
  return false;
}

double tail_slack(const Operator& A, double response) {
  double contraction = 0;
  for (Index k = A.num_harmonics() + 1; k <= A.last_row(); ++k)
    for (Index i = 0; i < A.num_modes(); ++i) {
      const double d = modulus(A.system().D(i, k));
      if (A.system().coupling(i) > 0) contraction = std::max(contraction, A.system().coupling(i) / d);
    }
  const double among = contraction < 1 - 1 / most_tail_slack ? 1 / (1 - contraction) : most_tail_slack;
  return among * response;
}

}  // namespace hb::steady
