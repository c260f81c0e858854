#include "hb/engine/exponents/slaving_iteration.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/anderson.hpp"
#include "hb/engine/exponents/growth_bound.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/modulus.hpp"
#include "lib/stop_wish.hpp"

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
      A1_(A_.data() + A_.size(), N_, n_ * m_),
      C_(A1_.data() + A_.size(), N_, n_ * m_),
      C1_(C_.data() + A_.size(), N_, n_ * m_),
      P_(forward_.samples().data(), N_, n_ * m_),
      R_(P_.data() + P_.size(), N_, n_ * m_),
      x_(VectorXd::Zero(n_ * m_ * 2 * 2 * (H_ + 1))) {
  alpha_.setZero();
  beta_.setZero();
  P_.setZero();
  R_.setZero();
  const VectorXd w2 = system.mean_diagonal(), b = system.damping_diagonal();
  for (const Index s : S_) weight_.push_back(std::max(1.0, std::abs(root(b(s), w2(s)))));
  // kappa: what an error of A does to alpha.
  for (Index s = 0; s < m_; ++s) {
    double sum = 0;
    for (Index j = 0; j < n_; ++j) sum += largest_K(S_[s], F_[j]) + std::abs(G_(S_[s], F_[j])) * H_;
    kappa_ = std::max(kappa_, sum);
  }
  residual_ = MatrixXd::Zero(2, n_ * m_);
  // Inverse of the constant part per (j, l, k); see below.
  inverse_.resize(std::size_t(n_ * m_ * (H_ + 1)));
  for (Index l = 0; l < m_; ++l)
    for (Index j = 0; j < n_; ++j)
      for (Index k = 0; k <= H_; ++k) {
        const double wg = w2(S_[l]), bg = b(S_[l]), wj = w2(F_[j]), bj = b(F_[j]);
        const cplx ik(0, double(k));
        // P = ik a - wg c, R = a + (ik - bg) c:
        //   (ik + bj) P - wg R + wj a = -r1,   P + (ik - bg + bj) R + wj c = -r2.
        Eigen::Matrix2cd A;
        A << (ik + bj) * ik - wg + wj, -(ik + bj) * wg - wg * (ik - bg),  //
            ik + (ik - bg + bj), -wg + (ik - bg + bj) * (ik - bg) + wj;
        const cplx factor = -1.0 / (A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0));
        inverse_[slot(j, l, k)] << factor * A(1, 1), -factor * A(0, 1), -factor * A(1, 0), factor * A(0, 0);
      }
  const auto all = Eigen::Map<const Eigen::VectorXcd>(inverse_.data()->data(), 4 * Index(inverse_.size()));
  inverse_moduli_.resize(4, Index(inverse_.size()));
  inverse_moduli_.reshaped() = moduli(all);
  weigh_residuals();
}

// What a residual of the invariance equations does to alpha, hb/engine/README.md (E7): with the constant part's
// inverse M_k at its largest, whatever the harmonic that the residual is in, and the way through other fast modes,
//     |d alpha| <= sum_j l_j g_j |r_j|,      l = kappa (1 - g |K_FF|)^-1,   kappa_j = max_s |K_sj|.
// A residual in another harmonic than the resonant one is carried there by the modulation of the mode itself, so that
// |M_k r_k| alone, which is what the iteration changes by, would be too small where M is large in one harmonic only.
void Iteration::weigh_residuals() {
  MatrixXd gain(2, n_ * m_), rate(2, n_ * m_);  // of A, C and of their rates of change
  for (Index l = 0; l < m_; ++l)
    for (Index j = 0; j < n_; ++j) {
      const Index q = j + n_ * l;
      gain.col(q).setZero();
      rate.col(q).setZero();
      for (Index k = 0; k <= H_; ++k)
        for (Index c = 0; c < 2; ++c) {
          const double size = inverse_size(c, j, l, k);
          gain(c, q) = std::max(gain(c, q), size);
          rate(c, q) = std::max(rate(c, q), size * (double(k) + weight_[std::size_t(l)]));
        }
    }
  MatrixXd through = MatrixXd::Identity(n_, n_);  // 1 - g |K_FF| off the diagonal
  VectorXd direct = VectorXd::Zero(n_), damped = VectorXd::Zero(n_);
  for (Index j = 0; j < n_; ++j) {
    double largest = 0;
    for (Index l = 0; l < m_; ++l) largest = std::max(largest, gain(0, j + n_ * l));
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
  effect_.resize(2, n_ * m_);
  for (Index q = 0; q < n_ * m_; ++q)
    effect_.col(q) = (l(q % n_) * gain.col(q) + damped(q % n_) * rate.col(q)) * double(m_);
}

void Iteration::start_from(const Iteration& coarse) {
  amplification_ = coarse.amplification_;
  change_ = coarse.change_;
  for (Index half = 0; half < 2 * n_ * m_; ++half)
    x_.segment(half * 2 * (H_ + 1), 2 * (coarse.H_ + 1)) =
        coarse.x_.segment(half * 2 * (coarse.H_ + 1), 2 * (coarse.H_ + 1));
}

bool Iteration::solved_by_start(double tolerance) {
  VectorXd f(x_.size());
  correction(x_, f);
  const double change = alpha_change(), scale = alpha_.cwiseAbs().maxCoeff() + 1;
  const bool solved = change <= std::max(std::max(1e-13, tolerance) * scale, 4 * change_);
  change_ = change;
  return solved;
}

bool Iteration::run(double tolerance, int& iterations) {
  constexpr int most_iterations = 80, window = 8;
  VectorXd f(x_.size()), last_x, last_f, difference;
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
    if (!f.allFinite()) return false;
    const double change = alpha_change();
    const double scale = alpha_.cwiseAbs().maxCoeff() + 1;
    const double goal = std::max(2 * eps, tolerance) * scale;
    const double rho = change / previous;
    stalled = change < 0.9 * best ? 0 : stalled + 1;
    best = std::min(best, change);
    // What a residual f means for x: |dx|/|df| of the last steps, as far as they stand above rounding.
    if (last_x.size() > 0) {
      difference = f - last_f;
      const double df = norm(difference);
      difference = x - last_x;
      if (kappa_ * df > 100 * eps * scale) secants.push_back(norm(difference) / df);
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
    if (iteration >= 4 && rho > 0.25) mixing = true;
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

double Iteration::norm(const VectorXd& x) const {
  double largest = 0;
  for (Index part = 0; part < n_ * m_; ++part) {
    double sum = 0;
    for (Index half = 2 * part; half < 2 * part + 2; ++half) {
      const double* z = x.data() + half * 2 * (H_ + 1);
      for (Index k = 0; k <= H_; ++k) sum += std::sqrt(z[2 * k] * z[2 * k] + z[2 * k + 1] * z[2 * k + 1]);
    }
    largest = std::max(largest, 2 * sum);
  }
  return largest;
}

void Iteration::sample(const VectorXd& x) {
  const Index nm = n_ * m_;
  auto spectrum = back_.spectrum();
  spectrum.setZero();
  for (Index q = 0; q < nm; ++q) {
    const double inverse_weight = 1 / weight_[std::size_t(q / n_)];
    const auto a = A_of(x, q), c = C_of(x, q);
    for (Index k = 0; k <= H_; ++k) {
      const double n = double(k);
      const cplx scaled = c(k) * inverse_weight;
      spectrum(k, q) = a(k);
      spectrum(k, nm + q) = {-n * a(k).imag(), n * a(k).real()};
      spectrum(k, 2 * nm + q) = scaled;
      spectrum(k, 3 * nm + q) = {-n * scaled.imag(), n * scaled.real()};
    }
  }
  back_.backward();
}

bool Iteration::reduce() {
  const auto A = [&](Index j, Index l) { return A_.col(j + n_ * l).array(); };
  const auto C = [&](Index j, Index l) {
    return C_.col(j + n_ * l).array();
  };  // Where damping couples, alpha and beta depend on P and R, which depend on them.
  constexpr int most_passes = 40;
  for (int pass = 0; pass < most_passes; ++pass) {
    const MatrixXd last_alpha = diagonal_damping_ ? MatrixXd() : alpha_;
    const MatrixXd last_beta = diagonal_damping_ ? MatrixXd() : beta_;
    for (Index l = 0; l < m_; ++l)
      for (Index s = 0; s < m_; ++s) {
        auto alpha = alpha_.col(s + m_ * l).array();
        auto beta = beta_.col(s + m_ * l).array();
        alpha = K(S_[s], S_[l]);
        beta.setConstant(G_(S_[s], S_[l]));
        for (Index j = 0; j < n_; ++j) {
          alpha += K(S_[s], F_[j]) * A(j, l);
          beta += K(S_[s], F_[j]) * C(j, l);
          if (!diagonal_damping_) {
            alpha += G_(S_[s], F_[j]) * P_.col(j + n_ * l).array();
            beta += G_(S_[s], F_[j]) * R_.col(j + n_ * l).array();
          }
        }
      }
    for (Index l = 0; l < m_; ++l)
      for (Index j = 0; j < n_; ++j) {
        auto P = P_.col(j + n_ * l).array();
        auto R = R_.col(j + n_ * l).array();
        P = A1_.col(j + n_ * l).array();
        R = A(j, l) + C1_.col(j + n_ * l).array();
        for (Index s = 0; s < m_; ++s) {
          P -= C(j, s) * alpha_.col(s + m_ * l).array();
          R -= C(j, s) * beta_.col(s + m_ * l).array();
        }
      }
    if (diagonal_damping_) return true;
    const auto settled = [](const MatrixXd& now, const MatrixXd& last) {
      return (now - last).cwiseAbs().maxCoeff() <= 4 * eps * now.cwiseAbs().maxCoeff();
    };
    if (settled(alpha_, last_alpha) && settled(beta_, last_beta)) return true;
  }
  return false;
}

void Iteration::correction(const VectorXd& x, VectorXd& f) {
  end_if_wished();
  sample(x);
  if (!reduce()) {
    f.setConstant(HUGE_VAL);
    return;
  }
  sample_residual();
  push_through(f);
}

void Iteration::sample_residual() {
  const auto A = [&](Index j, Index l) { return A_.col(j + n_ * l).array(); };
  const auto C = [&](Index j, Index l) { return C_.col(j + n_ * l).array(); };
  const Index nm = n_ * m_;
  auto out = forward_.samples();
  for (Index l = 0; l < m_; ++l)
    for (Index j = 0; j < n_; ++j) {
      auto r1 = out.col(2 * nm + j + n_ * l).array();
      auto r2 = out.col(3 * nm + j + n_ * l).array();
      r1 = K(F_[j], S_[l]) + G_(F_[j], F_[j]) * P_.col(j + n_ * l).array();
      r2 = P_.col(j + n_ * l).array() + G_(F_[j], S_[l]) + G_(F_[j], F_[j]) * R_.col(j + n_ * l).array();
      for (Index s = 0; s < m_; ++s) {
        r1 -= R_.col(j + n_ * s).array() * alpha_.col(s + m_ * l).array();
        r2 -= R_.col(j + n_ * s).array() * beta_.col(s + m_ * l).array();
      }
      for (Index i = 0; i < n_; ++i) {
        r1 += K(F_[j], F_[i]) * A(i, l);
        r2 += K(F_[j], F_[i]) * C(i, l);
        if (!diagonal_damping_ && i != j) {
          r1 += G_(F_[j], F_[i]) * P_.col(i + n_ * l).array();
          r2 += G_(F_[j], F_[i]) * R_.col(i + n_ * l).array();
        }
      }
    }
}

void Iteration::push_through(VectorXd& f) {
  const Index nm = n_ * m_;
  forward_.forward();
  const auto spectrum = forward_.spectrum();

  cplx* data = reinterpret_cast<cplx*>(f.data());
  for (Index l = 0; l < m_; ++l)
    for (Index j = 0; j < n_; ++j) {
      const Index q = j + n_ * l;
      double sum1 = 0, sum2 = 0;
      for (Index k = 0; k <= H_; ++k) {
        const double n = double(k);
        const cplx p = spectrum(k, q), r = spectrum(k, nm + q);
        const cplx r1 = spectrum(k, 2 * nm + q) + cplx(-n * p.imag(), n * p.real());
        const cplx r2 = spectrum(k, 3 * nm + q) + cplx(-n * r.imag(), n * r.real());
        sum1 += (k > 0 ? 2 : 1) * modulus(r1);
        sum2 += (k > 0 ? 2 : 1) * modulus(r2);
        const Eigen::Matrix2cd& M = inverse_[slot(j, l, k)];
        data[q * 2 * (H_ + 1) + k] = M(0, 0) * r1 + M(0, 1) * r2;
        data[(q * 2 + 1) * (H_ + 1) + k] = weight_[std::size_t(l)] * (M(1, 0) * r1 + M(1, 1) * r2);
      }
      residual_.col(q) << sum1, sum2;
    }
}

}  // namespace hb::slaving
