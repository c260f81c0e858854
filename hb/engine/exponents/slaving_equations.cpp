// The invariance equations at samples of the turn: hb/engine/README.md (E4), (E5), and what their residuals change.
#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/neighbouring_numbers.hpp"
#include "hb/engine/exponents/slaving_iteration.hpp"
#include "lib/constants.hpp"
#include "lib/stop_wish.hpp"

namespace hb::slaving {

using Eigen::Index;
using Eigen::MatrixXd;

void Iteration::sample() {
  auto re = back_.re(), im = back_.im();
  in_groups(n_ * m_, [&]<int width>(std::integral_constant<int, width>, Index q) {
    const Index nm = n_ * m_, last = H_;  // in registers
    const Numbers<width> scale = at<width>(scale_.data() + nm + q);
    for (Index k = 0; k <= last; ++k) {
      const double n = double(k);
      const double* const from = x_.data() + 4 * nm * k + q;
      double* const real = &re(q, k);
      double* const imaginary = &im(q, k);
      const Numbers<width> c = scale * at<width>(from + nm), d = scale * at<width>(from + 3 * nm);
      at<width>(real) = at<width>(from);
      at<width>(imaginary) = at<width>(from + 2 * nm);
      at<width>(real + nm) = c;
      at<width>(imaginary + nm) = d;
      at<width>(real + 2 * nm) = -n * d;
      at<width>(imaginary + 2 * nm) = n * c;
      if (diagonal_damping_) continue;
      at<width>(real + 3 * nm) = -n * at<width>(from + 2 * nm);
      at<width>(imaginary + 3 * nm) = n * at<width>(from);
    }
  });
  re.rightCols(N_ / 2 - H_).setZero();
  im.rightCols(N_ / 2 - H_).setZero();
  back_.backward();
}

// Where damping couples, alpha and beta depend on P and R, which depend on them.
bool Iteration::reduce() {
  constexpr int most_passes = 40;
  for (int pass = 0; pass < most_passes; ++pass) {
    const MatrixXd last_alpha = diagonal_damping_ ? MatrixXd() : alpha_;
    const MatrixXd last_beta = diagonal_damping_ ? MatrixXd() : beta_;
    sample_slow();
    sample_rates();
    if (diagonal_damping_) return true;
    const auto settled = [](const MatrixXd& now, const MatrixXd& last) {
      return (now - last).cwiseAbs().maxCoeff() <= 4 * eps * now.cwiseAbs().maxCoeff();
    };
    if (settled(alpha_, last_alpha) && settled(beta_, last_beta)) return true;
  }
  return false;
}

void Iteration::sample_slow() {
  for (Index l = 0; l < m_; ++l)
    for (Index s = 0; s < m_; ++s) {
      const double *alone = K(S_[s], S_[l]).data(), *A = A_.col(n_ * l).data(), *C = C_.col(n_ * l).data(),
                   *P = P_.col(n_ * l).data(), *R = R_.col(n_ * l).data();
      double *to_alpha = alpha_.col(s + m_ * l).data(), *to_beta = beta_.col(s + m_ * l).data();
      const double* const* K_s = K_F_.data() + n_ * s;
      in_groups(N_, [&]<int width>(std::integral_constant<int, width>, Index t) {
        using V = Numbers<width>;
        V alpha = at<width>(alone + t), beta = V::Constant(G_(S_[s], S_[l]));
        for (Index j = 0, at_j = t; j < n_; ++j, at_j += N_) {
          const V k = at<width>(K_s[j] + t);
          alpha += k * at<width>(A + at_j);
          beta += k * at<width>(C + at_j);
        }
        for (Index j = 0, at_j = t; j < n_ && !diagonal_damping_; ++j, at_j += N_) {
          alpha += G_(S_[s], F_[j]) * at<width>(P + at_j);
          beta += G_(S_[s], F_[j]) * at<width>(R + at_j);
        }
        at<width>(to_alpha + t) = alpha;
        at<width>(to_beta + t) = beta;
      });
    }
}

void Iteration::sample_rates() {
  for (Index l = 0; l < m_; ++l)
    for (Index j = 0; j < n_; ++j) {
      const Index own = j + n_ * l;
      const double* const A1 = diagonal_damping_ ? nullptr : A1_.col(own).data();
      const double *A = A_.col(own).data(), *C1 = C1_.col(own).data(), *C = C_.col(j).data(),
                   *alpha = alpha_.col(m_ * l).data(), *beta = beta_.col(m_ * l).data();
      double *to_P = P_.col(own).data(), *to_R = R_.col(own).data();
      in_groups(N_, [&]<int width>(std::integral_constant<int, width>, Index t) {
        Numbers<width> P = Numbers<width>::Zero(), R = at<width>(A + t) + at<width>(C1 + t);
        if (A1 != nullptr) P = at<width>(A1 + t);
        for (Index s = 0; s < m_; ++s) {
          const Numbers<width> C_js = at<width>(C + N_ * n_ * s + t);
          P -= C_js * at<width>(alpha + N_ * s + t);
          R -= C_js * at<width>(beta + N_ * s + t);
        }
        at<width>(to_P + t) = P;
        at<width>(to_R + t) = R;
      });
    }
}

// With A = C = 0, the residuals are what couples to the slow modes: K_FS and G_FS.
void Iteration::sample_nothing() {
  back_.samples().setZero();
  auto re = forward_.re(), im = forward_.im();
  re.setZero();
  im.setZero();
  const Index nm = n_ * m_, harmonics = std::min(H_ + 1, given_.c.cols());
  for (Index l = 0; l < m_; ++l)
    for (Index j = 0; j < n_; ++j) {
      const auto K_jl = given_.c.row(F_[j] + I_ * S_[l]).head(harmonics);
      re.row(2 * nm + j + n_ * l).head(harmonics) = K_jl.real();
      im.row(2 * nm + j + n_ * l).head(harmonics) = K_jl.imag();
      re(3 * nm + j + n_ * l, 0) = G_(F_[j], S_[l]);
    }
}

void Iteration::correction() {
  end_if_wished();
  const bool from_nothing = x_.isZero(0);
  if (from_nothing)
    sample_nothing();
  else
    sample();
  if (!reduce()) {
    f_.setConstant(HUGE_VAL);
    residual_.setConstant(HUGE_VAL);
    return;
  }
  if (!from_nothing) {
    sample_residual();
    forward_.forward();
  }
  push_through();
}

// But for what is linear in P and R of the same mode.
void Iteration::sample_residual() {
  double *out1 = forward_.samples().col(2 * n_ * m_).data(), *out2 = forward_.samples().col(3 * n_ * m_).data();
  for (Index l = 0; l < m_; ++l)
    for (Index j = 0; j < n_; ++j, out1 += N_, out2 += N_) {
      const double across = G_(F_[j], S_[l]);
      const double *alone = K(F_[j], S_[l]).data(), *A = A_.col(n_ * l).data(), *C = C_.col(n_ * l).data(),
                   *P = P_.col(n_ * l).data(), *R = R_.col(n_ * l).data(), *R_j = R_.col(j).data(),
                   *alpha = alpha_.col(m_ * l).data(), *beta = beta_.col(m_ * l).data();
      const double* const* K_j = K_F_.data() + n_ * (m_ + j);
      in_groups(N_, [&]<int width>(std::integral_constant<int, width>, Index t) {
        using V = Numbers<width>;
        V r1 = at<width>(alone + t), r2 = V::Constant(across);
        for (Index s = 0; s < m_; ++s) {
          const V R_js = at<width>(R_j + N_ * n_ * s + t);
          r1 -= R_js * at<width>(alpha + N_ * s + t);
          r2 -= R_js * at<width>(beta + N_ * s + t);
        }
        for (Index i = 0, at_i = t; i < n_; ++i, at_i += N_) {
          const V k = at<width>(K_j[i] + t);
          r1 += k * at<width>(A + at_i);
          r2 += k * at<width>(C + at_i);
        }
        for (Index i = 0, at_i = t; i < n_ && !diagonal_damping_; ++i, at_i += N_) {
          const double damping = i == j ? 0 : G_(F_[j], F_[i]);
          r1 += damping * at<width>(P + at_i);
          r2 += damping * at<width>(R + at_i);
        }
        at<width>(out1 + t) = r1;
        at<width>(out2 + t) = r2;
      });
    }
}

// Of harmonic k, with what samples leave out, r1 = r1 + (G_jj + ik) P, r2 = r2 + P + (G_jj + ik) R, P = P + ik A.
void Iteration::push_through() {
  auto re = forward_.re(), im = forward_.im();
  in_groups(n_ * m_, [&]<int width>(std::integral_constant<int, width>, Index q) {
    using V = Numbers<width>;
    const Index nm = n_ * m_, last = H_;  // in registers
    const V own = at<width>(&damping_(q));
    V sum1 = V::Zero(), sum2 = V::Zero();
    for (Index k = 0; k <= last; ++k) {
      const double n = double(k), signs = k > 0 ? 2 : 1, left_out = diagonal_damping_ ? n : 0;
      double* const re_k = re.col(k).data() + q;
      double* const im_k = im.col(k).data() + q;
      double* const f_k = f_.data() + 4 * nm * k + q;
      const double* const x_k = x_.data() + 4 * nm * k + q;
      const double* const M_k = inverse_.col(k).data() + q;
      const auto x = [&](Index column) { return at<width>(re_k + nm * column); };
      const auto y = [&](Index column) { return at<width>(im_k + nm * column); };
      const auto A = [&](Index part) { return at<width>(x_k + nm * part); };
      const auto M = [&](Index entry) { return at<width>(M_k + nm * entry); };
      const auto to = [&](Index part) { return at<width>(f_k + nm * part); };
      const V px = x(0) - left_out * A(2), py = y(0) + left_out * A(0);
      const V x1 = x(2) + own * px - n * py, y1 = y(2) + own * py + n * px;
      const V x2 = x(3) + px + own * x(1) - n * y(1), y2 = y(3) + py + own * y(1) + n * x(1);
      x(2) = x1, y(2) = y1, x(3) = x2, y(3) = y2;
      sum1 += signs * (x1.square() + y1.square()).sqrt();
      sum2 += signs * (x2.square() + y2.square()).sqrt();
      to(0) = M(0) * x1 - M(1) * y1 + M(2) * x2 - M(3) * y2;
      to(1) = M(4) * x1 - M(5) * y1 + M(6) * x2 - M(7) * y2;
      to(2) = M(0) * y1 + M(1) * x1 + M(2) * y2 + M(3) * x2;
      to(3) = M(4) * y1 + M(5) * x1 + M(6) * y2 + M(7) * x2;
    }
    at<width>(&residual_(q)) = sum1;
    at<width>(&residual_(nm + q)) = sum2;
  });
}

}  // namespace hb::slaving
