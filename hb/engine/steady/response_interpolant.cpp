#include "hb/engine/steady/response_interpolant.hpp"

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index N = ResponseInterpolant::num_places;
constexpr double rounding = 32 * eps;  // of a response, relative
constexpr Index num_last = 2;  // coefficients that the square is fitted by

// Roots of T_N.
VectorXd roots() {
  VectorXd t(N);
  for (Index j = 0; j < N; ++j) t(j) = std::cos(pi * (2 * static_cast<double>(j) + 1) / (2 * N));
  return t;
}

// Values at the roots times this: coefficients of T_0 .. T_(N-1).
MatrixXd to_coefficients() {
  MatrixXd A(N, N);
  for (Index j = 0; j < N; ++j)
    for (Index k = 0; k < N; ++k)
      A(j, k) =
          (k == 0 ? 1.0 : 2.0) / N * std::cos(pi * static_cast<double>(k) * (2 * static_cast<double>(j) + 1) / (2 * N));
  return A;
}

// 1 + d_1 t + d_2 t^2 for which the last coefficients of its product with the values are least, by Gram and Schmidt;
// what that gains in rounding alone is not looked for, nor a second zero where one explains all.
Eigen::Vector3d fitted_square(const MatrixXcd& values, const VectorXd& t, const MatrixXd& A) {
  constexpr double gained = 1e-12, told = 1e-9;
  const auto last = [&](const MatrixXcd& product) { return MatrixXcd(product * A.rightCols(num_last)); };
  const auto product = [](const MatrixXcd& a, const MatrixXcd& b) {
    return a.conjugate().cwiseProduct(b).sum().real();
  };
  const MatrixXcd none = last(values), first = last(values * t.asDiagonal());
  MatrixXcd second = last(values * t.cwiseAbs2().asDiagonal());
  const double least = gained * values.norm(), square = product(first, first);
  if (!(std::sqrt(square) > least)) return {1, 0, 0};
  const double before = second.norm(), along = product(first, second) / square;
  second -= along * first;
  const bool two = second.norm() > std::max(least, told * before);
  const double d2 = two ? -product(second, none) / second.squaredNorm() : 0,
               d1 = -product(first, none) / square - along * d2;
  return {1, d1, d2};
}

double value_at(const Eigen::Vector3d& d, double t) { return d(0) + t * (d(1) + t * d(2)); }

// The zero in [-1, 1] that is nearest to the middle.
std::optional<double> zero_of(const Eigen::Vector3d& d) {
  const double radicand = d(1) * d(1) - 4 * d(0) * d(2);
  if (radicand < 0) return std::nullopt;
  const double zero = -2 * d(0) / (d(1) + std::copysign(std::sqrt(radicand), d(1)));
  if (!(std::abs(zero) <= 1)) return std::nullopt;
  return zero;
}

// So deep that what is divided by it is not told from a pole, and rounding would show.
bool is_deep(const Eigen::Vector3d& d) {
  constexpr double least = 0.03;
  const double bottom = d(2) == 0 ? 1 : std::clamp(-d(1) / (2 * d(2)), -1.0, 1.0);
  const double low = std::min({value_at(d, -1), value_at(d, 1), value_at(d, bottom)}),
               high = std::max({value_at(d, -1), value_at(d, 1), d(0)});
  return !(low > least * high);
}

// T_k(t) and T_k'(t) = k U_(k-1)(t), k < N.
struct Chebyshev {
  VectorXd value = VectorXd::Ones(N), slope = VectorXd::Zero(N);

  explicit Chebyshev(double t) {
    value(1) = t;
    slope(1) = 1;
    for (Index k = 2; k < N; ++k) {
      value(k) = 2 * t * value(k - 1) - value(k - 2);
      slope(k) = 2 * value(k - 1) + 2 * t * slope(k - 1) - slope(k - 2);
    }
  }
};

FourierSeries series(const Eigen::VectorXcd& harmonics) { return FourierSeries(MatrixXcd(harmonics.transpose())); }

}  // namespace

VectorXd ResponseInterpolant::places(double c, double r) { return (c + r * roots().array()).matrix(); }

ResponseInterpolant::ResponseInterpolant(double c, double r, std::span<const FourierSeries> responses) : c_(c), r_(r) {
  Index H = 0;
  for (const FourierSeries& q : responses) H = std::max(H, q.num_harmonics());
  MatrixXcd values(H + 1, N);
  for (Index j = 0; j < N; ++j)
    values.col(j) = fourier::resized(responses[static_cast<std::size_t>(j)], H).c.row(0).transpose();
  const VectorXd t = roots();
  const MatrixXd A = to_coefficients();
  const Eigen::Vector3d fitted = fitted_square(values, t, A);
  if (const std::optional<double> zero = zero_of(fitted)) pole_ = c + r * *zero;
  if (!is_deep(fitted)) denominator_ = fitted;
  const VectorXd d = t.unaryExpr([&](double place) { return value_at(denominator_, place); });
  coefficients_ = values * d.asDiagonal() * A;
}

FourierSeries ResponseInterpolant::operator()(double x) const {
  const double t = at(x);
  return series(coefficients_ * (Chebyshev(t).value / value_at(denominator_, t)));
}

FourierSeries ResponseInterpolant::slope(double x) const {
  const double t = at(x), d = value_at(denominator_, t), rise = denominator_(1) + 2 * denominator_(2) * t;
  const Chebyshev T(t);
  return series(coefficients_ * ((T.slope - T.value * (rise / d)) / (d * r_)));
}

// What is left out is nearly in proportion to T_N, which is 1 or -1 at c; each value has an error of its own.
double ResponseInterpolant::error(const FourierSeries& at_c) const {
  constexpr double own = 4;
  const FourierSeries off = fourier::difference((*this)(c_), at_c);
  return own * fourier::wiener_norm(off, 0) + rounding * fourier::wiener_norm(at_c, 0);
}

double ResponseInterpolant::better_radius(double error, const FourierSeries& at_c) const {
  return r_ * std::clamp(std::pow(rounding * fourier::wiener_norm(at_c, 0) / error, 1.0 / N), 0.1, 0.7);
}

// |T_N'| <= N/sqrt(1 - t^2), N^2.
double ResponseInterpolant::slope_error(double x, double error) const {
  const double t = at(x), n = static_cast<double>(N);
  return error / r_ * std::min(n / std::sqrt(std::max(1 - t * t, 1e-300)), n * n);
}

}  // namespace hb
