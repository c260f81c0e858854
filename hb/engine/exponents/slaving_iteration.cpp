#include "hb/engine/exponents/slaving_iteration.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/anderson.hpp"
#include "hb/engine/exponents/growth_bound.hpp"
#include "hb/engine/exponents/neighbouring_numbers.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"

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
  for (Index i = 0; i < I; ++i)
    if (std::find(p.S.begin(), p.S.end(), i) == p.S.end()) p.F.push_back(i);
  return p;
}

void drop_tail(FourierSeries& series, MatrixXd& error) {
  Index H = series.num_harmonics();
  VectorXd sum = VectorXd::Zero(error.size()), more(error.size());
  for (; H > 0; --H) {
    more = sum + 2 * series.c.col(H).cwiseAbs2().cwiseSqrt();
    if (!(more.array() <= 0.1 * error.reshaped().array()).all()) break;
    sum.swap(more);
  }
  series = fourier::resized(series, H);
  error += sum.reshaped(error.rows(), error.cols());
}

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
      alpha_(N_, m_ * m_),
      beta_(N_, m_ * m_),
      back_(N_, 4 * n_ * m_),
      forward_(N_, 4 * n_ * m_),
      A_(back_.samples().data(), N_, n_ * m_),
      C_(A_.data() + A_.size(), N_, n_ * m_),
      A1_(C_.data() + A_.size(), N_, n_ * m_),
      C1_(A1_.data() + A_.size(), N_, n_ * m_),
      P_(forward_.samples().data(), N_, n_ * m_),
      R_(P_.data() + P_.size(), N_, n_ * m_),
      x_(VectorXd::Zero(4 * n_ * m_ * (H_ + 1))),
      changed_(x_.size()) {
  if (!diagonal_damping_) {  // what alpha and beta, which depend on P and R, are found from first
    alpha_.setZero();
    beta_.setZero();
    P_.setZero();
    R_.setZero();
  }
  const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  for (const Index s : S_) weight_.push_back(std::max(1.0, std::abs(root(b(s), w2(s)))));
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
  residual_ = MatrixXd::Zero(n_ * m_, 2);
  scale_ = Eigen::ArrayXd::Ones(2 * n_ * m_);
  for (Index q = 0; q < n_ * m_; ++q) scale_(n_ * m_ + q) = 1 / weight_[std::size_t(q / n_)];
  invert_constant_part(w2, b);
  weigh_residuals();
}

// With P = ik a - wg c, R = a + (ik - bg) c:
//   (ik + bj) P - wg R + wj a = -r1,   P + (ik - bg + bj) R + wj c = -r2,
// for every harmonic k: in a and c
//   a11 = wj - wg - k^2 + ik bj,   a12 = -wg ((bj - bg) + 2 ik),   a21 = (bj - bg) + 2 ik,
//   a22 = wj - wg - k^2 - bg (bj - bg) + ik (bj - 2 bg).
void Iteration::invert_constant_part(const VectorXd& w2, const VectorXd& b) {
  const Index nm = n_ * m_;
  Eigen::ArrayXXd numbers(nm, 5);
  auto wg = numbers.col(0), bg = numbers.col(1), wj = numbers.col(2), bj = numbers.col(3), weight = numbers.col(4);
  for (Index q = 0; q < nm; ++q) {
    const Index slow = S_[std::size_t(q / n_)], fast = F_[std::size_t(q % n_)];
    wg(q) = w2(slow), bg(q) = b(slow), wj(q) = w2(fast), bj(q) = b(fast);
    weight(q) = weight_[std::size_t(q / n_)];
  }
  inverse_.resize(8 * nm, H_ + 1);
  inverse_size_.resize(2 * nm, H_ + 1);
  for (Index k = 0; k <= H_; ++k) {
    const double n = double(k);
    double *M = inverse_.col(k).data(), *size = inverse_size_.col(k).data();
    in_groups(nm, [&]<int width>(std::integral_constant<int, width>, Index q) {
      using V = Numbers<width>;
      const auto of = [q](const auto& column) { return at<width>(column.data() + q); };
      const V apart = of(bj) - of(bg), near = of(wj) - of(wg) - n * n, v = of(weight);
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
      at<width>(size + q) = (M11.square() + N11.square()).sqrt() + (M21.square() + N21.square()).sqrt();
      at<width>(size + nm + q) = (M12.square() + N12.square()).sqrt() + (M22.square() + N22.square()).sqrt();
    });
  }
}

// What a residual of the invariance equations does to alpha, hb/engine/README.md (E7): with the constant part's
// inverse M_k at its largest, whatever the harmonic that the residual is in, and the way through other fast modes,
//     |d alpha| <= sum_j l_j g_j |r_j|,      l = kappa (1 - g |K_FF|)^-1,   kappa_j = max_s |K_sj|.
// A residual in another harmonic than the resonant one is carried there by the modulation of the mode itself, so that
// |M_k r_k| alone, which is what the iteration changes by, would be too small where M is large in one harmonic only.
void Iteration::weigh_residuals() {
  const Index nm = n_ * m_;
  Eigen::ArrayXd weight(2 * nm);
  for (Index q = 0; q < 2 * nm; ++q) weight(q) = weight_[std::size_t(q % nm / n_)];
  // Of A, C and of their rates of change.
  Eigen::ArrayXd gain = Eigen::ArrayXd::Zero(2 * nm), rate = gain;
  for (Index k = 0; k <= H_; ++k) {
    const auto size = inverse_size_.col(k).array();
    gain = gain.max(size);
    rate = rate.max(size * (double(k) + weight));
  }
  MatrixXd through = MatrixXd::Identity(n_, n_);  // 1 - g |K_FF| off the diagonal
  VectorXd direct = VectorXd::Zero(n_), damped = VectorXd::Zero(n_);
  for (Index j = 0; j < n_; ++j) {
    double largest = 0;
    for (Index l = 0; l < m_; ++l) largest = std::max(largest, gain(j + n_ * l));
    for (Index i = 0; i < n_; ++i)
      if (i != j) through(j, i) = -largest * largest_K(F_[j], F_[i]);
    for (Index s = 0; s < m_; ++s) {
      direct(j) = std::max(direct(j), largest_K(S_[s], F_[j]));
      damped(j) = std::max(damped(j), std::abs(G_(S_[s], F_[j])));
    }
  }
  VectorXd l = dense::Lu<double>(MatrixXd(through.transpose())).solve(direct);
  if (!(l.minCoeff() >= 0 && l.allFinite())) l.setConstant(direct.maxCoeff());
  l = l.cwiseMax(direct);
  effect_.resize(nm, 2);
  for (Index q = 0; q < 2 * nm; ++q)
    effect_(q % nm, q / nm) = (l(q % n_) * gain(q) + damped(q % n_) * rate(q)) * double(m_);
}

void Iteration::start_from(const Iteration& coarse) {
  amplification_ = coarse.amplification_;
  change_ = coarse.change_;
  changed_ = coarse.changed_;
  x_.head(coarse.x_.size()) = coarse.x_;
}

void Iteration::start_from(const SlavingStart& start) {
  if (start.solution.size() == 0) return;
  amplification_ = start.amplification;
  enough_ = 4 * start.change;
  changed_ = start.solution.size();
  x_.head(changed_) = start.solution;
}

bool Iteration::solved_by_start(double tolerance) {
  VectorXd f(x_.size());
  correction(x_, f);
  const double change = alpha_change(), scale = alpha_.cwiseAbs().maxCoeff() + 1;
  const bool solved = change <= std::max(std::max(1e-13, tolerance) * scale, 4 * change_);
  change_ = change;
  if (!solved) changed_ = x_.size();
  return solved;
}

bool Iteration::run(double tolerance, int& iterations, int most_iterations) {
  constexpr int window = 8;
  VectorXd f(x_.size()), last_x, last_f;
  VectorXd& x = x_;
  Anderson anderson;
  bool mixing = false;
  double previous = HUGE_VAL, best = HUGE_VAL;
  std::vector<double> secants, bests;  // of the last steps
  secants.reserve(8);
  bests.reserve(window + 1);
  int stalled = 0;
  for (int iteration = 1; iteration <= most_iterations; ++iteration) {
    ++iterations;
    correction(x, f);
    if (!std::isfinite(f.sum())) return false;
    f.tail(f.size() - changed_).setZero();
    const double change = alpha_change();
    const double scale = alpha_.cwiseAbs().maxCoeff() + 1;
    const double goal = std::max(std::max(2 * eps, tolerance) * scale, enough_);
    const double rho = change / previous;
    stalled = change < 0.9 * best ? 0 : stalled + 1;
    best = std::min(best, change);
    // What a residual f means for x: |dx|/|df| of the last steps, as far as they stand above rounding.
    if (last_x.size() > 0) {
      const double df = distance(f, last_f);
      if (kappa_ * df > 100 * eps * scale) secants.push_back(distance(x, last_x) / df);
      if (secants.size() > 6) secants.erase(secants.begin());
    }
    last_x = x;
    last_f = f;
    // Rounding reached: nothing is left to gain.
    if (change <= goal || (stalled >= 5 && change <= 4 * best && best <= 1e-11 * scale)) {
      for (const double secant : secants) amplification_ = std::max(amplification_, secant);
      change_ = change;
      return true;
    }
    if (!(change <= 1e3 * scale * weight_max() * weight_max()) || stalled > 15) return false;
    // At the pace of the last iterations it would not arrive; the first ones only show divergence.
    bests.push_back(best);
    if (bests.size() > window) {
      const double pace = std::log(best / bests.front()) / window;
      bests.erase(bests.begin());
      if (!(pace < -0.1)) return false;
      if (iteration > 2 * window && iteration + std::log(goal / best) / pace > most_iterations) return false;
    }
    if (iteration >= 3 && rho > 0.2) mixing = true;
    if (mixing)
      x = anderson.step(x, f);
    else
      x += f;
    previous = change;
  }
  return false;
}

ReducedSystem Iteration::result(bool bounds_others) {
  ReducedSystem reduced;
  reduced.converged = true;
  reduced.num_modes = m_;
  reduced.alpha = fourier::analyse(alpha_.transpose());
  reduced.beta = fourier::analyse(beta_.transpose());
  // Harmonic by harmonic where the bound of the iteration is more than rounding.
  const double rounding = 4 * eps * alpha_.cwiseAbs().maxCoeff();
  const double iteration = amplification_ * (2 * change_ <= rounding ? 2 * change_ : carried_change(reduced.alpha));
  reduced.alpha_error =
      iteration +
      2 * eps * (alpha_.cwiseAbs().colwise().maxCoeff().array() + kappa_ * A_.cwiseAbs().maxCoeff()).reshaped(m_, m_);
  reduced.beta_error =
      iteration / weight_max() +
      2 * eps * (beta_.cwiseAbs().colwise().maxCoeff().array() + kappa_ * C_.cwiseAbs().maxCoeff()).reshaped(m_, m_);
  for (Index l = 0; l < m_; ++l)
    for (Index s = 0; s < m_; ++s) {
      reduced.alpha_error(s, l) += given_rounding * rounding_(S_[s], S_[l]);
      reduced.beta_error(s, l) += G_error_(S_[s], S_[l]);
    }
  drop_tail(reduced.alpha, reduced.alpha_error);
  drop_tail(reduced.beta, reduced.beta_error);
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
  for (Index l = 0; l < m_; ++l) {
    states(S_[l], l) = 1;
    states(I_ + S_[l], m_ + l) = 1;
    for (Index j = 0; j < n_; ++j) {
      states(F_[j], l) = A_(0, j + n_ * l);
      states(F_[j], m_ + l) = C_(0, j + n_ * l);
      states(I_ + F_[j], l) = P_(0, j + n_ * l);
      states(I_ + F_[j], m_ + l) = R_(0, j + n_ * l);
    }
  }
  return states;
}

double Iteration::distance(const VectorXd& x, const VectorXd& y) const {
  const Index nm = n_ * m_;
  double largest = 0;
  in_groups(nm, [&]<int width>(std::integral_constant<int, width>, Index q) {
    Numbers<width> sum = Numbers<width>::Zero();
    for (Index k = 0; k <= H_; ++k)
      for (Index half = 0; half < 2; ++half) {
        const Index real = nm * (4 * k + half) + q, imaginary = real + 2 * nm;
        sum += ((at<width>(&x(real)) - at<width>(&y(real))).square() +
                (at<width>(&x(imaginary)) - at<width>(&y(imaginary))).square())
                   .sqrt();
      }
    largest = std::max(largest, 2 * sum.maxCoeff());
  });
  return largest;
}

}  // namespace hb::slaving
