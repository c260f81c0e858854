#include "hb/engine/nonlinear/harmonic_balance.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace hb::nonlinear {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

VectorXd to_unknowns(const FourierSeries& q, Index num_harmonics) {
  const Index n = q.num_components();
  VectorXd u = VectorXd::Zero(n * (2 * num_harmonics + 1));
  u.head(n) = q.c.col(0).real();
  for (Index k = 1; k <= std::min(num_harmonics, q.num_harmonics()); ++k) {
    u.segment(n * (2 * k - 1), n) = q.c.col(k).real();
    u.segment(n * 2 * k, n) = q.c.col(k).imag();
  }
  return u;
}

FourierSeries to_series(const Eigen::Ref<const VectorXd>& u, Index num_components) {
  const Index n = num_components, H = (u.size() / n - 1) / 2;
  FourierSeries q(n, H);
  q.c.col(0).real() = u.head(n);
  for (Index k = 1; k <= H; ++k) {
    q.c.col(k).real() = u.segment(n * (2 * k - 1), n);
    q.c.col(k).imag() = u.segment(n * 2 * k, n);
  }
  return q;
}

VectorXd sizes(const Eigen::Ref<const VectorXd>& u, Index num_components) {
  const Index n = num_components, H = (u.size() / n - 1) / 2;
  VectorXd size = u.head(n).cwiseAbs();
  for (Index k = 1; k <= H; ++k)
    for (Index i = 0; i < n; ++i) size(i) += 2 * std::hypot(u(n * (2 * k - 1) + i), u(n * 2 * k + i));
  return size;
}

double mean_product(const Eigen::Ref<const VectorXd>& a, const Eigen::Ref<const VectorXd>& b, Index num_components) {
  return 2 * a.dot(b) - a.head(num_components).dot(b.head(num_components));
}

Index samples_for(Index num_harmonics, Index oversampling) {
  return fourier::fast_length(oversampling * (4 * num_harmonics + 2));
}

HarmonicBalance::HarmonicBalance(const NonlinearSystem& system, int turns, Index num_harmonics, Index num_samples)
    : system_(&system), turns_(turns), n_(system.num_unknowns), H_(num_harmonics), N_(num_samples) {
  if (N_ <= 2 * H_ || N_ % 2 != 0) throw std::invalid_argument("HarmonicBalance: too few samples for its harmonics");
}

MotionSamples HarmonicBalance::motion(const VectorXd& u, double p) const {
  const double omega = base_frequency(p);
  const FourierSeries q = to_series(u, n_);
  MotionSamples motion;
  motion.angle = VectorXd::LinSpaced(N_, 0, 2 * std::numbers::pi * turns_ * double(N_ - 1) / double(N_));
  fourier::RealTransform& transform = fourier::thread_transform(N_, 3 * n_);
  auto spectrum = transform.spectrum();
  spectrum.setZero();
  for (Index k = 0; k < q.c.cols(); ++k) {
    const double w = double(k) * omega;
    spectrum.row(k).head(n_) = q.c.col(k).transpose();
    spectrum.row(k).segment(n_, n_) = cplx(0, w) * q.c.col(k).transpose();
    spectrum.row(k).tail(n_) = -w * w * q.c.col(k).transpose();
  }
  transform.backward();
  const auto samples = transform.samples();
  motion.q = samples.leftCols(n_).transpose();
  motion.v = samples.middleCols(n_, n_).transpose();
  motion.a = samples.rightCols(n_).transpose();
  return motion;
}

VectorXd HarmonicBalance::coefficients(const MatrixXd& r) const {
  fourier::RealTransform& transform = fourier::thread_transform(N_, n_);
  transform.samples() = r.transpose();
  transform.forward();
  const auto spectrum = transform.spectrum();
  VectorXd R(num_unknowns());
  R.head(n_) = spectrum.row(0).real().transpose();
  for (Index k = 1; k <= H_; ++k) {
    R.segment(n_ * (2 * k - 1), n_) = spectrum.row(k).real().transpose();
    R.segment(n_ * 2 * k, n_) = spectrum.row(k).imag().transpose();
  }
  return R;
}

std::optional<EvaluationFailure> HarmonicBalance::evaluate(const VectorXd& u, double p, Derivatives wanted,
                                                           ResidualSamples& samples) {
  evaluated_ += N_;
  const MotionSamples along = motion(u, p);
  if (auto failure = system_->evaluate(p, along, wanted, samples)) return failure;
  if (!samples.r.allFinite()) {
    for (Index j = 0; j < N_; ++j)
      if (!samples.r.col(j).allFinite()) return EvaluationFailure{"the residual is not finite", along.angle(j)};
  }
  return std::nullopt;
}

std::optional<EvaluationFailure> HarmonicBalance::residual(const VectorXd& u, double p, VectorXd& R) {
  if (auto failure = evaluate(u, p, Derivatives::none, samples_)) return failure;
  R = coefficients(samples_.r);
  return std::nullopt;
}

namespace {

FourierSeries series_of(const MatrixXd& samples) {
  const Index N = samples.cols();
  fourier::RealTransform& transform = fourier::thread_transform(N, samples.rows());
  transform.samples() = samples.transpose();
  transform.forward();
  return FourierSeries(transform.spectrum().topRows(N / 2).transpose());
}

}  // namespace

std::optional<EvaluationFailure> HarmonicBalance::linearise(const VectorXd& u, double p, VectorXd& R,
                                                            Linearisation& linear) {
  if (auto failure = evaluate(u, p, Derivatives::state, linear.samples)) return failure;
  R = coefficients(linear.samples.r);
  linear.mass = series_of(linear.samples.da);
  linear.damping = series_of(linear.samples.dv);
  linear.stiffness = series_of(linear.samples.dq);
  return std::nullopt;
}

// R_k = sum over l of both signs of A_kl c_l, so with A_k,-l acting on conj(c_l)
//     dR_k/d Re c_l = A_kl + A_k,-l,      dR_k/d Im c_l = i (A_kl - A_k,-l).
MatrixXd HarmonicBalance::jacobian(const Linearisation& linear, double p) const {
  assert(N_ > 4 * H_);
  const double omega = base_frequency(p);
  const Index n = n_, nn = n * n;
  MatrixXd J(num_unknowns(), num_unknowns());
  const auto row = [n](Index k) { return k == 0 ? 0 : n * (2 * k - 1); };
  using Block = Eigen::Map<const Eigen::MatrixXcd>;
  Eigen::VectorXcd A(nn), conjugate(nn);
  // Coefficient k - l of both signs.
  const auto block = [&](Index difference, double w, Eigen::VectorXcd& result) {
    const Index d = std::abs(difference);
    result = linear.stiffness.c.col(d) - w * w * linear.mass.c.col(d);
    // For a negative difference the conjugate of each coefficient, but not of i w.
    if (difference < 0)
      result = result.conjugate() + cplx(0, w) * linear.damping.c.col(d).conjugate();
    else
      result += cplx(0, w) * linear.damping.c.col(d);
  };
  for (Index l = 0; l <= H_; ++l)
    for (Index k = 0; k <= H_; ++k) {
      const double w = double(l) * omega;
      block(k - l, w, A);
      const Block plus(A.data(), n, n);
      if (l == 0) {
        J.block(row(k), 0, n, n) = plus.real();
        if (k > 0) J.block(row(k) + n, 0, n, n) = plus.imag();
        continue;
      }
      block(k + l, -w, conjugate);
      const Block minus(conjugate.data(), n, n);
      J.block(row(k), row(l), n, n) = plus.real() + minus.real();
      J.block(row(k), row(l) + n, n, n) = minus.imag() - plus.imag();
      if (k == 0) continue;
      J.block(row(k) + n, row(l), n, n) = plus.imag() + minus.imag();
      J.block(row(k) + n, row(l) + n, n, n) = plus.real() - minus.real();
    }
  return J;
}

std::optional<EvaluationFailure> HarmonicBalance::parameter_derivative(const VectorXd& u, double p, double p_scale,
                                                                       const Linearisation& linear, VectorXd& Rp) {
  const double step = 1e-4 * p_scale;
  if (linear.samples.dp.size() > 0) {
    const double omega = base_frequency(p);
    const double slope = (base_frequency(p + step) - base_frequency(p - step)) / (2 * step);
    const MotionSamples along = motion(u, p);
    MatrixXd total = linear.samples.dp;
    if (slope != 0)
      for (Index j = 0; j < N_; ++j) {
        const Eigen::Map<const MatrixXd> M(linear.samples.da.col(j).data(), n_, n_);
        const Eigen::Map<const MatrixXd> B(linear.samples.dv.col(j).data(), n_, n_);
        total.col(j) += slope / omega * (B * along.v.col(j) + 2 * M * along.a.col(j));
      }
    Rp = coefficients(total);
    return std::nullopt;
  }
  VectorXd before;
  if (auto failure = residual(u, p - step, before)) return failure;
  if (auto failure = residual(u, p + step, Rp)) return failure;
  Rp = (Rp - before) / (2 * step);
  return std::nullopt;
}

Eigen::MatrixXcd HarmonicBalance::mean_block(const Linearisation& linear, double p, Index k) const {
  const double w = double(k) * base_frequency(p);
  const Eigen::VectorXcd A =
      linear.stiffness.c.col(0) + cplx(0, w) * linear.damping.c.col(0) - w * w * linear.mass.c.col(0);
  return Eigen::Map<const Eigen::MatrixXcd>(A.data(), n_, n_);
}

}  // namespace hb::nonlinear
