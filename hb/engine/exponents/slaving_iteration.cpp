#include "hb/engine/exponents/slaving_iteration.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "hb/engine/exponents/anderson.hpp"
#include "hb/engine/exponents/growth_bound.hpp"
#include "hb/engine/exponents/neighbouring_numbers.hpp"
#include "lib/constants.hpp"
#include "lib/modulus.hpp"
#include "lib/workspace.hpp"

namespace hb::slaving {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

cplx root(double b, double w2) {
  const cplx r = std::sqrt(cplx(b * b / 4 - w2, 0));
  return b >= 0 && r.imag() == 0 ? cplx(-w2 / (b / 2 + r.real()), 0) : -b / 2 + r;
}

Partition partition(Index I, std::span<const Index> slow) {
  Partition p{{slow.begin(), slow.end()}, {}};
  p.F.reserve(std::size_t(I));
  for (Index i = 0; i < I; ++i)
    if (std::find(p.S.begin(), p.S.end(), i) == p.S.end()) p.F.push_back(i);
  return p;
}

FourierSeries without_tail(const Eigen::Ref<const Eigen::MatrixXcd>& harmonics, MatrixXd& error) {
  const Index last = harmonics.rows() - 1;
  Index H = 0;
  for (Index i = 0; i < error.size(); ++i) {
    Index k = last;
    for (double sum = 0; k > H; --k) {
      sum += 2 * modulus(harmonics(k, i));
      if (!(sum <= 0.1 * error(i))) break;
    }
    H = std::max(H, k);
  }
  for (Index i = 0; i < error.size(); ++i) {
    double sum = 0;
    for (Index k = last; k > H; --k) sum += 2 * modulus(harmonics(k, i));
    error(i) += sum;
  }
  return FourierSeries(harmonics.topRows(H + 1).transpose());
}

namespace {

Eigen::Map<MatrixXd> kept_room(Index rows, Index columns) {
  thread_local Workspace kept;
  return kept.matrix(rows, columns);
}

}  // namespace

Iteration::Iteration(const ScaledSystem& system, const SampledStiffness::Samples& samples, const Partition& p,
                     Index num_samples)
    : S_(p.S),
      F_(p.F),
      m_(Index(p.S.size())),
      n_(Index(p.F.size())),
      N_(num_samples),
      H_((num_samples - 1) / 2),
      G_(system.G),
      rounding_(system.K_rounding),
      G_error_(system.G_error),
      given_(system.K),
      diagonal_damping_(system.diagonal_damping),
      I_(system.num_modes()),
      samples_(samples),
      back_(N_, (diagonal_damping_ ? 3 : 4) * n_ * m_),
      forward_(N_, 4 * n_ * m_),
      A_(back_.samples().data(), N_, n_ * m_),
      C_(A_.data() + A_.size(), N_, n_ * m_),
      C1_(C_.data() + A_.size(), N_, n_ * m_),
      A1_(diagonal_damping_ ? nullptr : C1_.data() + A_.size(), diagonal_damping_ ? 0 : N_, n_ * m_),
      P_(forward_.samples().data(), N_, n_ * m_),
      R_(P_.data() + P_.size(), N_, n_ * m_),
      room_(kept_room(2 * (H_ + 1), 15 * n_ * m_ + 2 * m_ * m_)),
      alpha_(room_.data(), N_, m_ * m_),
      beta_(alpha_.data() + alpha_.size(), N_, m_ * m_),
      x_(beta_.data() + beta_.size(), 4 * n_ * m_ * (H_ + 1)),
      f_(x_.data() + x_.size(), x_.size()),
      step_(f_.data() + x_.size(), x_.size()),
      last_x_(step_.data() + x_.size(), x_.size()),
      last_f_(last_x_.data() + x_.size(), x_.size()),
      changed_(x_.size()),
      inverse_(last_f_.data() + x_.size(), 8 * n_ * m_, H_ + 1),
      inverse_size_(inverse_.data() + inverse_.size(), 2 * n_ * m_, H_ + 1),
      columns_(2 * n_ * m_, 7),
      weight_(&columns_(0, 0), columns_.rows()),
      scale_(&columns_(0, 1), columns_.rows()),
      gain_(&columns_(0, 2), columns_.rows()),
      rate_(&columns_(0, 3), columns_.rows()),
      residual_(&columns_(0, 4), columns_.rows()),
      effect_(&columns_(0, 5), columns_.rows()),
      damping_(&columns_(0, 6), columns_.rows()) {
  assert(N_ == 2 * (H_ + 1));
  if (!diagonal_damping_) {  // what alpha and beta, which depend on P and R, are found from first
    alpha_.setZero();
    beta_.setZero();
    P_.setZero();
    R_.setZero();
  }
  const Index nm = n_ * m_;
  for (Index l = 0; l < m_; ++l) {
    const double weight = std::max(1.0, std::abs(root(b(S_[l]), w2(S_[l]))));
    weight_.segment(n_ * l, n_).setConstant(weight);
    scale_.segment(n_ * l, n_).setConstant(1);
    scale_.segment(nm + n_ * l, n_).setConstant(1 / weight);
  }
  weight_.tail(nm) = weight_.head(nm);
  for (Index q = 0; q < 2 * nm; ++q) damping_(q) = b(F_[std::size_t(q % n_)]);
  // kappa: what an error of A does to alpha.
  for (Index s = 0; s < m_; ++s) {
    double sum = 0;
    for (Index j = 0; j < n_; ++j) sum += largest_K(S_[s], F_[j]) + std::abs(G_(S_[s], F_[j])) * H_;
    kappa_ = std::max(kappa_, sum);
  }
  K_F_.reserve(std::size_t(n_ * I_));
  for (const std::vector<Index>* rows : {&S_, &F_})
    for (const Index i : *rows)
      for (const Index j : F_) K_F_.push_back(K(i, j).data());
  invert_constant_part();
  weigh_residuals();
}

// With P = ik a - wg c, R = a + (ik - bg) c:
//   (ik + bj) P - wg R + wj a = -r1,   P + (ik - bg + bj) R + wj c = -r2,
// for every harmonic k: in a and c
//   a11 = wj - wg - k^2 + ik bj,   a12 = -wg ((bj - bg) + 2 ik),   a21 = (bj - bg) + 2 ik,
//   a22 = wj - wg - k^2 - bg (bj - bg) + ik (bj - 2 bg).
void Iteration::invert_constant_part() {
  const Index nm = n_ * m_;
  thread_local Workspace kept;
  auto numbers = kept.matrix(nm, 4);
  auto wg = numbers.col(0), bg = numbers.col(1), wj = numbers.col(2), bj = numbers.col(3);
  for (Index q = 0; q < nm; ++q) {
    const Index slow = S_[std::size_t(q / n_)], fast = F_[std::size_t(q % n_)];
    wg(q) = w2(slow), bg(q) = b(slow), wj(q) = w2(fast), bj(q) = b(fast);
  }
  gain_.setZero();
  rate_.setZero();
  for (Index k = 0; k <= H_; ++k) {
    const double n = double(k);
    double *M = inverse_.col(k).data(), *size = inverse_size_.col(k).data();
    in_groups(nm, [&]<int width>(std::integral_constant<int, width>, Index q) {
      using V = Numbers<width>;
      const auto of = [q](const auto& column) { return at<width>(column.data() + q); };
      const V apart = of(bj) - of(bg), near = of(wj) - of(wg) - n * n, v = of(weight_);
      const V y11 = n * of(bj), x12 = -of(wg) * apart, y12 = -2 * n * of(wg);
      const double y21 = 2 * n;
      const V x22 = near - of(bg) * apart, y22 = n * (of(bj) - 2 * of(bg));
      const V x = near * x22 - y11 * y22 - (x12 * apart - y12 * y21);
      const V y = near * y22 + y11 * x22 - (x12 * y21 + y12 * apart);
      const V norm = x * x + y * y, fx = -x / norm, fy = y / norm;  // -1/determinant
      const V M11 = fx * x22 - fy * y22, N11 = fx * y22 + fy * x22;
      const V M12 = fy * y12 - fx * x12, N12 = -fx * y12 - fy * x12;
      const V M21 = v * (fy * y21 - fx * apart), N21 = v * (-fx * y21 - fy * apart);
      const V M22 = v * (fx * near - fy * y11), N22 = v * (fx * y11 + fy * near);
      Index entry = 0;
      for (const V* part : {&M11, &N11, &M12, &N12, &M21, &N21, &M22, &N22}) at<width>(M + nm * entry++ + q) = *part;
      const auto add_size = [&](Index first, const V& M1, const V& N1, const V& M2, const V& N2) {
        const V s = (M1.square() + N1.square()).sqrt() + (M2.square() + N2.square()).sqrt();
        at<width>(size + first) = s;
        at<width>(&gain_(first)) = at<width>(&gain_(first)).max(s);
        at<width>(&rate_(first)) = at<width>(&rate_(first)).max(s * (n + v));
      };
      add_size(q, M11, N11, M21, N21);
      add_size(nm + q, M12, N12, M22, N22);
    });
  }
}

namespace {

// Solves A x = b in place of both, without interchanges: where A has no positive entry off the diagonal and A^-1 >= 0
// all pivots are > 0 (A. Berman, R. J. Plemmons, Nonnegative Matrices in the Mathematical Sciences, theorem 6.2.3).
template <class Matrix, class Vector>
void eliminate_in_place(Matrix& A, Vector& x) {
  const Index n = A.rows();
  for (Index k = 0; k < n; ++k)
    for (Index i = k + 1; i < n; ++i) {
      const double factor = A(i, k) / A(k, k);
      for (Index j = k + 1; j < n; ++j) A(i, j) -= factor * A(k, j);
      x(i) -= factor * x(k);
    }
  for (Index k = n; k-- > 0;) {
    for (Index j = k + 1; j < n; ++j) x(k) -= A(k, j) * x(j);
    x(k) /= A(k, k);
  }
}

}  // namespace

// What a residual of the invariance equations does to alpha, hb/engine/README.md (E7): with the constant part's
// inverse M_k at its largest, whatever the harmonic that the residual is in, and the way through other fast modes,
//     |d alpha| <= sum_j l_j g_j |r_j|,      l = kappa (1 - g |K_FF|)^-1,   kappa_j = max_s |K_sj|.
// A residual in another harmonic than the resonant one is carried there by the modulation of the mode itself, so that
// |M_k r_k| alone, which is what the iteration changes by, would be too small where M is large in one harmonic only.
void Iteration::weigh_residuals() {
  thread_local Workspace kept;
  auto room = kept.matrix(n_, n_ + 3);
  auto through = room.leftCols(n_);  // (1 - g |K_FF|)^T
  auto direct = room.col(n_), damped = room.col(n_ + 1), l = room.col(n_ + 2);
  for (Index j = 0; j < n_; ++j) {
    double largest = 0;
    for (Index s = 0; s < m_; ++s) largest = std::max(largest, gain_(j + n_ * s));
    for (Index i = 0; i < n_; ++i) through(i, j) = i == j ? 1 : -largest * largest_K(F_[j], F_[i]);
    direct(j) = damped(j) = 0;
    for (Index s = 0; s < m_; ++s) {
      direct(j) = std::max(direct(j), largest_K(S_[s], F_[j]));
      damped(j) = std::max(damped(j), std::abs(G_(S_[s], F_[j])));
    }
  }
  l = direct;
  eliminate_in_place(through, l);
  if (!(l.minCoeff() >= 0 && l.allFinite())) l.setConstant(direct.maxCoeff());
  l = l.cwiseMax(direct);
  for (Index q = 0; q < effect_.size(); ++q)
    effect_(q) = (l(q % n_) * gain_(q) + damped(q % n_) * rate_(q)) * double(m_);
}

void Iteration::refine(const SlavingStart& coarse) {
  amplification_ = coarse.amplification;
  change_ = coarse.change;
  changed_ = coarse.solution.size();
  x_.head(changed_) = coarse.solution;
  x_.tail(x_.size() - changed_).setZero();
}

void Iteration::start_from(const SlavingStart& start) {
  const Index given = start.solution.size();
  x_.head(given) = start.solution;
  x_.tail(x_.size() - given).setZero();
  if (given == 0) return;
  amplification_ = start.amplification;
  if (start.rough) return;
  enough_ = 4 * start.change;
  changed_ = given;
}

bool Iteration::solved_by_start(double tolerance) {
  correction();
  const double change = alpha_change(), scale = alpha_.cwiseAbs().maxCoeff() + 1;
  const bool solved = change <= std::max(std::max(1e-13, tolerance) * scale, 4 * change_);
  change_ = change;
  if (!solved) changed_ = x_.size();
  return solved;
}

bool Iteration::run(double tolerance, int& iterations, int most_iterations) {
  constexpr int window = 8;
  constexpr std::size_t few = 6;
  Anderson anderson;
  bool mixing = false;
  std::optional<PairInverse> pairs;
  double previous = HUGE_VAL, best = HUGE_VAL;
  // Of the last steps, in turn.
  std::array<double, few> secants{};
  std::array<double, window> bests{};
  std::size_t num_secants = 0;
  int stalled = 0;
  for (int iteration = 1; iteration <= most_iterations; ++iteration) {
    ++iterations;
    correction();
    if (!std::isfinite(f_.sum())) return false;
    f_.tail(f_.size() - changed_).setZero();
    const double change = alpha_change();
    const double scale = alpha_.cwiseAbs().maxCoeff() + 1;
    const double goal = std::max(std::max(2 * eps, tolerance) * scale, enough_);
    const double rho = change / previous;
    stalled = change < 0.9 * best ? 0 : stalled + 1;
    best = std::min(best, change);
    // What a residual f means for x: |dx|/|df| of the last steps, as far as they stand above rounding.
    if (iteration > 1) {
      const double df = distance(f_, last_f_);
      if (kappa_ * df > 100 * eps * scale) secants[num_secants++ % few] = distance(x_, last_x_) / df;
    }
    // Rounding reached: nothing is left to gain.
    if (change <= goal || (stalled >= 5 && change <= 4 * best && best <= 1e-11 * scale)) {
      for (const double secant : secants) amplification_ = std::max(amplification_, secant);
      change_ = change;
      return true;
    }
    if (!(change <= 1e3 * scale * weight_max() * weight_max()) || stalled > 15) return false;
    // At the pace of the last iterations it would not arrive; the first ones only show divergence.
    double& earlier = bests[std::size_t(iteration % window)];
    if (iteration > window) {
      const double pace = std::log(best / earlier) / window;
      if (!(pace < -0.1)) return false;
      if (iteration > 2 * window && iteration + std::log(goal / best) / pace > most_iterations) return false;
    }
    earlier = best;
    last_x_ = x_;
    last_f_ = f_;
    // Worth it where more than a few steps would be to come (choices by experience).
    constexpr double far = 1e3, slow = 0.1, slower = 0.2;
    if (!pairs && iteration < most_iterations && (iteration == 1 ? change > far * goal : rho > slow))
      pairs = inverse_of(own_equations());
    if (iteration >= 3 && rho > slower) mixing = true;
    if (pairs) push_through(*pairs);
    const Column& step = pairs ? step_ : f_;
    if (mixing)
      x_ = anderson.step(x_, step);
    else
      x_ += step;
    previous = change;
  }
  return false;
}

PairInverse::Equations Iteration::own_equations() const {
  constexpr Index count = PairInverse::band + 1;
  const Index nm = n_ * m_;
  PairInverse::Equations of{MatrixXd::Zero(nm, 2 * count), MatrixXd(nm, 2 * count), damping_.head(nm), VectorXd(nm)};
  fourier::RealTransform& transform = fourier::thread_transform(N_, m_);
  for (Index l = 0; l < m_; ++l) transform.samples().col(l) = alpha_.col(l + m_ * l);
  transform.forward();
  for (Index l = 0; l < m_; ++l) {
    const double damping = beta_.col(l + m_ * l).mean();
    for (Index j = 0; j < n_; ++j) {
      const Index q = j + n_ * l, known = std::min(count, given_.c.cols());
      const auto fast = given_.c.row(F_[j] + I_ * F_[j]).head(known);
      of.fast.row(q).head(known) = fast.real();
      of.fast.row(q).segment(count, known) = fast.imag();
      of.slow.row(q).head(count) = transform.spectrum().col(l).head(count).real();
      of.slow.row(q).tail(count) = transform.spectrum().col(l).head(count).imag();
      of.slow_damping(q) = damping;
    }
  }
  return of;
}

PairInverse Iteration::inverse_of(const PairInverse::Equations& own) const {
  PairInverse pairs(n_ * m_, H_);
  pairs.factorise(own);
  return pairs;
}

void Iteration::push_through(const PairInverse& pairs) {
  const auto re = forward_.re(), im = forward_.im();
  const Index first = 2 * n_ * m_;
  pairs.solve({&re(first, 0), &im(first, 0), re.rows()}, weight_.data(), step_.data());
  step_.tail(step_.size() - changed_).setZero();
}

// t of (E29), T = |M_k U_m| on (A, weight C).
double Iteration::resonance_shift(const PairInverse::Equations& own) const {
  constexpr Index band = PairInverse::band;
  const Index nm = n_ * m_;
  double largest = 0;
  in_groups(nm, [&]<int width>(std::integral_constant<int, width>, Index q) {
    using V = Numbers<width>;
    const V per_weight = at<width>(&weight_(q)).inverse();
    std::array<V, band> between, slow;
    for (Index m = 1; m <= band; ++m) {
      const auto part = [&](const MatrixXd& of, Index column) { return at<width>(&of(q, column)); };
      const V re = part(own.slow, m), im = part(own.slow, band + 1 + m);
      between[std::size_t(m - 1)] =
          ((part(own.fast, m) - re).square() + (part(own.fast, band + 1 + m) - im).square()).sqrt();
      slow[std::size_t(m - 1)] = (re.square() + im.square()).sqrt() * per_weight;
    }
    const V damping = (at<width>(&own.fast_damping(q)) - at<width>(&own.slow_damping(q))).abs();
    const auto T = [&](Index k, Index m) -> V {
      const double* const size = inverse_size_.col(k).data() + q;
      const V& mu = between[std::size_t(m - 1)];
      const V across = slow[std::size_t(m - 1)] * (damping + double(2 * k + m));
      return at<width>(size) * mu.max(across) + at<width>(size + nm) * mu * per_weight;
    };
    V most = V::Zero();
    for (Index k = 0; k <= H_; ++k) {
      V sum = V::Zero();
      for (Index m = 1; m <= band; ++m) {
        V beside = T(std::abs(k - m), m);
        if (k + m <= H_) beside += T(k + m, m);
        sum += T(k, m) * beside;
      }
      most = most.max(sum);
    }
    largest = std::max(largest, most.maxCoeff());
  });
  return largest;
}

void Iteration::see_shifted_resonances() {
  constexpr double small = 0.5;
  const PairInverse::Equations own = own_equations();
  if (const double t = resonance_shift(own); t <= small) {
    amplification_ = std::max(amplification_, 1 / (1 - t));
    return;
  }
  push_through(inverse_of(own));
  const double through_constant_part = length(f_);
  if (through_constant_part > 0) amplification_ = std::max(amplification_, length(step_) / through_constant_part);
}

ReducedSystem Iteration::result(bool bounds_others) {
  ReducedSystem reduced;
  reduced.converged = true;
  reduced.num_modes = m_;
  fourier::RealTransform& transform = fourier::thread_transform(N_, m_ * m_);
  const auto harmonics = transform.spectrum().topRows(H_ + 1);
  const auto errors = [&](const Columns& samples, double iteration, double of_fast) {
    MatrixXd error(m_, m_);
    for (Index q = 0; q < error.size(); ++q)
      error(q) = iteration + 2 * eps * (samples.col(q).cwiseAbs().maxCoeff() + kappa_ * of_fast);
    return error;
  };
  transform.samples() = alpha_;
  transform.forward();
  // Harmonic by harmonic where the bound of the iteration is more than rounding.
  const double rounding = 4 * eps * alpha_.cwiseAbs().maxCoeff();
  const double iteration = amplification_ * (2 * change_ <= rounding ? 2 * change_ : carried_change(harmonics));
  reduced.alpha_error = errors(alpha_, iteration, A_.cwiseAbs().maxCoeff());
  reduced.beta_error = errors(beta_, iteration / weight_max(), C_.cwiseAbs().maxCoeff());
  for (Index l = 0; l < m_; ++l)
    for (Index s = 0; s < m_; ++s) {
      reduced.alpha_error(s, l) += given_rounding * rounding_(S_[s], S_[l]);
      reduced.beta_error(s, l) += G_error_(S_[s], S_[l]);
    }
  reduced.iteration_share = std::max((iteration / reduced.alpha_error.array()).maxCoeff(),
                                     (iteration / weight_max() / reduced.beta_error.array()).maxCoeff());
  reduced.alpha = without_tail(harmonics, reduced.alpha_error);
  transform.samples() = beta_;
  transform.forward();
  reduced.beta = without_tail(harmonics, reduced.beta_error);
  if (bounds_others) reduced.others_below = others_below();
  reduced.start = start();
  reduced.solved = solved();
  return reduced;
}

// What the split leaves for y = x_F - A x_S - C x_S':
//     y1' = y2 + (C K_SF) y1,   y2' = -(K_FF - R K_SF) y1 - G_F y2.
double Iteration::others_below() const {
  if (!diagonal_damping_) return HUGE_VAL;
  SampledSystem rest{MatrixXd(N_, n_ * n_), MatrixXd::Zero(N_, n_ * n_), VectorXd(n_)};
  for (Index i = 0; i < n_; ++i) {
    rest.damping(i) = G_(F_[i], F_[i]);
    for (Index j = 0; j < n_; ++j) {
      auto k = rest.stiffness.col(j + n_ * i).array();
      k = K(F_[j], F_[i]);
      for (Index s = 0; s < m_; ++s) {
        k -= R_.col(j + n_ * s).array() * K(S_[s], F_[i]);
        rest.cross.col(j + n_ * i).array() += C_.col(j + n_ * s).array() * K(S_[s], F_[i]);
      }
    }
  }
  return growth_bound(rest);
}

// At tau = 0: x_F = A x_S + C x_S', x_F' = P x_S + R x_S'.
MatrixXd Iteration::start() const {
  MatrixXd states = MatrixXd::Zero(2 * I_, 2 * m_);
  const auto left_out = [&](Index q) {  // A'
    double sum = 0;
    for (Index k = 1; k <= H_ && diagonal_damping_; ++k) sum -= 2 * double(k) * x_(n_ * m_ * (4 * k + 2) + q);
    return sum;
  };
  for (Index l = 0; l < m_; ++l) {
    states(S_[l], l) = 1;
    states(I_ + S_[l], m_ + l) = 1;
    for (Index j = 0; j < n_; ++j) {
      states(F_[j], l) = A_(0, j + n_ * l);
      states(F_[j], m_ + l) = C_(0, j + n_ * l);
      states(I_ + F_[j], l) = P_(0, j + n_ * l) + left_out(j + n_ * l);
      states(I_ + F_[j], m_ + l) = R_(0, j + n_ * l);
    }
  }
  return states;
}

template <class Part>
double Iteration::largest_pair(const Part& part) const {
  const Index nm = n_ * m_;
  double largest = 0;
  in_groups(nm, [&]<int width>(std::integral_constant<int, width> together, Index q) {
    Numbers<width> sum = Numbers<width>::Zero();
    for (Index k = 0; k <= H_; ++k)
      for (Index half = 0; half < 2; ++half) {
        const Index real = nm * (4 * k + half) + q, imaginary = real + 2 * nm;
        sum += (part(together, real).square() + part(together, imaginary).square()).sqrt();
      }
    largest = std::max(largest, 2 * sum.maxCoeff());
  });
  return largest;
}

double Iteration::length(const Column& x) const {
  return largest_pair([&]<int width>(std::integral_constant<int, width>, Index i) { return at<width>(&x(i)); });
}

double Iteration::distance(const Column& x, const Column& y) const {
  return largest_pair(
      [&]<int width>(std::integral_constant<int, width>, Index i) { return at<width>(&x(i)) - at<width>(&y(i)); });
}

}  // namespace hb::slaving
