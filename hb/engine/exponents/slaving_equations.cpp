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
  const Index both = 2 * n_ * m_;
  auto re = back_.re(), im = back_.im();
  in_groups(both, [&]<int width>(std::integral_constant<int, width>, Index q) {
    const Numbers<width> scale = at<width>(scale_.data() + q);
    for (Index k = 0; k <= H_; ++k) {
      const double* from = x_.data() + 2 * both * k + q;
      double *real = &re(q, k), *imaginary = &im(q, k);
      const Numbers<width> a = scale * at<width>(from), b = scale * at<width>(from + both);
      at<width>(real) = a;
      at<width>(imaginary) = b;
      at<width>(real + both) = -double(k) * b;
      at<width>(imaginary + both) = double(k) * a;
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
      const double *A = A_.col(own).data(), *A1 = A1_.col(own).data(), *C1 = C1_.col(own).data(), *C = C_.col(j).data(),
                   *alpha = alpha_.col(m_ * l).data(), *beta = beta_.col(m_ * l).data();
      double *to_P = P_.col(own).data(), *to_R = R_.col(own).data();
      in_groups(N_, [&]<int width>(std::integral_constant<int, width>, Index t) {
        Numbers<width> P = at<width>(A1 + t), R = at<width>(A + t) + at<width>(C1 + t);
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

void Iteration::sample_residual() {
  double *out1 = forward_.samples().col(2 * n_ * m_).data(), *out2 = forward_.samples().col(3 * n_ * m_).data();
  for (Index l = 0; l < m_; ++l)
    for (Index j = 0; j < n_; ++j, out1 += N_, out2 += N_) {
      const double own = G_(F_[j], F_[j]), across = G_(F_[j], S_[l]);
      const double *alone = K(F_[j], S_[l]).data(), *A = A_.col(n_ * l).data(), *C = C_.col(n_ * l).data(),
                   *P = P_.col(n_ * l).data(), *R = R_.col(n_ * l).data(), *R_j = R_.col(j).data(),
                   *alpha = alpha_.col(m_ * l).data(), *beta = beta_.col(m_ * l).data();
      const double* const* K_j = K_F_.data() + n_ * (m_ + j);
      in_groups(N_, [&]<int width>(std::integral_constant<int, width>, Index t) {
        using V = Numbers<width>;
        const V P_jl = at<width>(P + N_ * j + t), R_jl = at<width>(R + N_ * j + t);
        V r1 = at<width>(alone + t) + own * P_jl, r2 = P_jl + across + own * R_jl;
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

void Iteration::push_through() {
  const Index nm = n_ * m_;
  const auto re = forward_.re(), im = forward_.im();
  in_groups(nm, [&]<int width>(std::integral_constant<int, width>, Index q) {
    using V = Numbers<width>;
    V sum1 = V::Zero(), sum2 = V::Zero();
    for (Index k = 0; k <= H_; ++k) {
      const double n = double(k), signs = k > 0 ? 2 : 1;
      const auto x = [&](Index column) { return at<width>(&re(nm * column + q, k)); };
      const auto y = [&](Index column) { return at<width>(&im(nm * column + q, k)); };
      const auto M = [&](Index entry) { return at<width>(&inverse_(nm * entry + q, k)); };
      const auto to = [&](Index part) { return at<width>(&f_(nm * (4 * k + part) + q)); };
      const V x1 = x(2) - n * y(0), y1 = y(2) + n * x(0), x2 = x(3) - n * y(1), y2 = y(3) + n * x(1);
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
