#include "lib/fourier/periodic_samples.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>

#include "lib/constants.hpp"

namespace hb {

namespace {

FourierSeries without_rounding(const FourierSeries& series) {
  return fourier::resized(series, fourier::significant_harmonics(series, eps / 4));
}

// Solves a_j x_{j-1} + b_j x_j + a_{j+1} x_{j+1} = r_j, indices modulo n, diagonally dominant: elimination of the
// tridiagonal part and one rank-1 correction (Sherman-Morrison) for the two corners.
Eigen::VectorXd solve_cyclic(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& r) {
  const Eigen::Index n = b.size();
  // A = T + u v', u = (g, 0, .., a_0), v = (1, 0, .., a_0/g), with g = -b_0 so that T stays dominant.
  const double corner = a(0), g = -b(0);
  Eigen::VectorXd d = b;
  d(0) -= g;
  d(n - 1) -= corner * corner / g;
  Eigen::MatrixXd X = Eigen::MatrixXd::Zero(n, 2);
  X.col(0) = r;
  X(0, 1) = g;
  X(n - 1, 1) += corner;
  for (Eigen::Index j = 1; j < n; ++j) {
    const double factor = a(j) / d(j - 1);
    d(j) -= factor * a(j);
    X.row(j) -= factor * X.row(j - 1);
  }
  X.row(n - 1) /= d(n - 1);
  for (Eigen::Index j = n - 2; j >= 0; --j) X.row(j) = (X.row(j) - a(j + 1) * X.row(j + 1)) / d(j);
  const auto v_times = [&](Eigen::Index column) { return X(0, column) + corner / g * X(n - 1, column); };
  return X.col(0) - v_times(0) / (1 + v_times(1)) * X.col(1);
}

}  // namespace

FourierSeries interpolate(const Eigen::Ref<const Eigen::MatrixXd>& samples, double first) {
  const Eigen::Index N = samples.cols();
  FourierSeries series = fourier::analyse(samples);
  if (N % 2 == 0) {
    // (1/N) sum (-1)^j f_j is the amplitude of cos(N (tau - first)/2): half of it at +N/2, half at -N/2.
    Eigen::VectorXd nyquist = Eigen::VectorXd::Zero(samples.rows());
    for (Eigen::Index j = 0; j < N; ++j) nyquist += (j % 2 ? -1.0 : 1.0) * samples.col(j);
    series = fourier::resized(series, N / 2);
    series.c.col(N / 2) = (nyquist / (2.0 * double(N))).cast<std::complex<double>>();
  }
  if (first != 0) {
    for (Eigen::Index k = 1; k < series.c.cols(); ++k) series.c.col(k) *= std::polar(1.0, -double(k) * first);
  }
  return without_rounding(series);
}

// On [tau_j, tau_j+1], h = tau_j+1 - tau_j, the spline with second derivatives m_j has
//     third derivative (m_j+1 - m_j)/h,    integral h (f_j + f_j+1)/2 - h^3 (m_j + m_j+1)/24,
// and the continuous first derivative gives, with e_j = (f_j+1 - f_j)/h_j,
//     h_j-1 m_j-1 + 2 (h_j-1 + h_j) m_j + h_j m_j+1 = 6 (e_j - e_j-1).
// s'''' is a sum of impulses J_j (jumps of s''') at tau_j, hence
//     c_k = sum_j J_j e^{-i k tau_j} / (2 pi k^4),   k != 0.
FourierSeries spline_series(const Eigen::Ref<const Eigen::VectorXd>& angles,
                            const Eigen::Ref<const Eigen::VectorXd>& values) {
  const Eigen::Index n = angles.size();
  assert(n >= 3 && values.size() == n);
  const auto next = [n](Eigen::Index j) { return j + 1 == n ? 0 : j + 1; };
  const auto previous = [n](Eigen::Index j) { return j == 0 ? n - 1 : j - 1; };

  Eigen::VectorXd h(n), slope(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    h(j) = angles(next(j)) - angles(j) + (j + 1 == n ? 2 * pi : 0);
    slope(j) = (values(next(j)) - values(j)) / h(j);
  }
  Eigen::VectorXd a(n), b(n), r(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    a(j) = h(previous(j));
    b(j) = 2 * (h(previous(j)) + h(j));
    r(j) = 6 * (slope(j) - slope(previous(j)));
  }
  const Eigen::VectorXd m = solve_cyclic(a, b, r);

  Eigen::VectorXd third(n), jump(n);
  double mean = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    third(j) = (m(next(j)) - m(j)) / h(j);
    mean += h(j) * (values(j) + values(next(j))) / 2 - h(j) * h(j) * h(j) * (m(j) + m(next(j))) / 24;
  }
  mean /= 2 * pi;
  for (Eigen::Index j = 0; j < n; ++j) jump(j) = third(j) - third(previous(j));

  // Cut at H: 2 sum_{k>H} |c_k| <= sum |J| / (pi 3 H^3).
  const double largest = values.cwiseAbs().maxCoeff();
  const double wanted = std::cbrt(jump.cwiseAbs().sum() / (3 * pi * 1e-10 * largest));
  const Eigen::Index H = largest > 0 ? static_cast<Eigen::Index>(std::clamp(std::ceil(wanted), 1.0, 4096.0)) : 0;
  FourierSeries series(1, H);
  series.c(0, 0) = mean;
  // e^{-i k tau_j} by repeated multiplication, taken afresh every 64 harmonics.
  Eigen::ArrayXcd step(n), power(n);
  for (Eigen::Index j = 0; j < n; ++j) step(j) = std::polar(1.0, -angles(j));
  for (Eigen::Index k = 1; k <= H; ++k) {
    if (k % 64 == 1) {
      for (Eigen::Index j = 0; j < n; ++j) power(j) = std::polar(1.0, -double(k) * angles(j));
    } else {
      power *= step;
    }
    series.c(0, k) = (power * jump.array()).sum() / (2 * pi * std::pow(double(k), 4));
  }
  return without_rounding(series);
}

}  // namespace hb
