#include "lib/rod/rod_shapes.hpp"

#include <cmath>

#include "lib/constants.hpp"
#include "lib/fourier/waves.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;

WavePolynomial derivative(const WavePolynomial& y) {
  WavePolynomial d{.K = y.K};
  for (std::size_t j = 0; j + 1 < y.A.size(); ++j) d.A[j] = static_cast<double>(j + 1) * y.A[j + 1];
  for (std::size_t j = 0; j < 3; ++j)
    d.P[j] = Complex(0, y.K) * y.P[j] + (j < 2 ? static_cast<double>(j + 1) * y.P[j + 1] : Complex(0));
  return d;
}

// y - factor m.
WavePolynomial less(WavePolynomial y, double factor, const WavePolynomial& m) {
  for (std::size_t j = 0; j < y.A.size(); ++j) y.A[j] -= factor * m.A[j];
  for (std::size_t j = 0; j < y.P.size(); ++j) y.P[j] -= factor * m.P[j];
  return y;
}

// m'' = p with m(0) = m(1) = 0. Of the wave part, (P'' + 2iK P' - K^2 P) = R, highest power first; of the polynomial,
// two integrations (its degree stays below 6); then the straight line that makes the ends zero.
WavePolynomial integrated_twice(const WavePolynomial& p) {
  WavePolynomial m{.K = p.K};
  if (p.K > 0) {
    for (std::size_t j = 3; j-- > 0;) {
      const double n = static_cast<double>(j);
      const Complex P1 = j < 2 ? (n + 1) * m.P[j + 1] : Complex(0);
      const Complex P2 = j < 1 ? (n + 2) * (n + 1) * m.P[j + 2] : Complex(0);
      m.P[j] = (P2 + Complex(0, 2 * p.K) * P1 - p.P[j]) / (p.K * p.K);
    }
  }
  for (std::size_t j = 0; j + 2 < p.A.size(); ++j) m.A[j + 2] = p.A[j] / static_cast<double>((j + 1) * (j + 2));
  m.A[0] = -m(0);
  m.A[1] = -m(1);
  return m;
}

}  // namespace

RodShapes::RodShapes(double length, Eigen::Index num_modes, double flexibility)
    : l_(length), I_(num_modes), flexibility_(flexibility), tail_(num_modes, num_static()) {
  add({.A = {-1}});
  add({.A = {0, -l_}});
  for (Eigen::Index k = 1; k <= I_; ++k) {
    const double K = static_cast<double>(k) * pi;
    // x w' = x K/l cos, (x w')' = (1/l) (K cos - K^2 s sin)
    add({.P = {Complex(0, K / l_), Complex(-K * K / l_)}, .K = K});
  }
  for (Eigen::Index k = 1; k <= I_; ++k) {
    const double K = static_cast<double>(k) * pi;
    // -(x^2/2 w')' + w = (K^2 s^2/2 + 1) sin - K s cos
    add({.P = {Complex(1), Complex(0, -K), Complex(K * K / 2)}, .K = K});
  }
  for (Eigen::Index i = 1; i <= I_; ++i) fill_sine_terms(i);
}

Eigen::MatrixXd RodShapes::values(double x, int first, int count) const {
  const double s = x / l_;
  std::vector<Complex> wave(static_cast<std::size_t>(I_) + 1, Complex(1));  // e^{i k pi s}
  fourier::Waves next(pi * s);
  Eigen::MatrixXd rows(count, size());
  for (Eigen::Index k = 1; k <= I_; ++k) {
    const double K = static_cast<double>(k) * pi;
    const Complex z = wave[static_cast<std::size_t>(k)] = next.next();
    const std::array<double, 4> cycle = {z.imag(), z.real(), -z.imag(), -z.real()};
    double power = std::pow(K / l_, first);
    for (int r = 0; r < count; ++r, power *= K / l_)
      rows(r, k - 1) = power * cycle[static_cast<std::size_t>((first + r) % 4)];
  }
  // Two without a wave, then those of each mode twice.
  double factor = std::pow(l_, -first);
  for (int r = 0; r < count; ++r, factor /= l_)
    for (Eigen::Index j = 0; j < num_static(); ++j)
      rows(r, I_ + j) = factor * static_[static_cast<std::size_t>(j)][static_cast<std::size_t>(first + r)].at(
                                     s, wave[static_cast<std::size_t>(j < 2 ? 0 : (j - 2) % I_ + 1)]);
  for (Eigen::Index j = 0; j < num_static(); ++j)
    for (Eigen::Index i = 0; i < I_; ++i)
      for (int r = 0; r < count; ++r) rows(r, I_ + j) -= tail_(i, j) * rows(r, i);
  return rows;
}

// Static deflection under the load p(s) (per EJ): y'''' = l^4 p over s; that of shear is -y''/(S l^2).
void RodShapes::add(WavePolynomial p) {
  const double l4 = std::pow(l_, 4);
  for (double& a : p.A) a *= l4;
  for (Complex& c : p.P) c *= l4;
  std::array<WavePolynomial, 5> y;
  y[2] = integrated_twice(p);
  y[0] = integrated_twice(y[2]);
  y[1] = derivative(y[0]);
  y[3] = derivative(y[2]);
  y[4] = p;
  if (flexibility_ > 0) {
    y[0] = less(y[0], flexibility_ / (l_ * l_), y[2]);
    for (std::size_t order = 1; order < 5; ++order) y[order] = derivative(y[order - 1]);
  }
  static_.push_back(y);
}

// Row i: sine coefficient of each static load over (i pi/l)^4; the load's are -c_ik and h_i of (3.11), (3.12).
void RodShapes::fill_sine_terms(Eigen::Index i) {
  const double n = static_cast<double>(i), stiffness = std::pow(n * pi / l_, 4);
  auto row = tail_.row(i - 1);
  row(0) = i % 2 == 1 ? -4 / (pi * n) : 0.0;
  row(1) = (i % 2 == 1 ? -1 : 1) * 2 * l_ / (pi * n);
  for (Eigen::Index k = 1; k <= I_; ++k) {
    const double m = static_cast<double>(k);
    const double a = i == k ? 0 : n * m * (1 / ((n - m) * (n - m)) + 1 / ((n + m) * (n + m)));
    const bool odd = (i + k) % 2 == 1;
    row(1 + k) = i == k ? -n * n * pi * pi / (2 * l_) : odd ? 2 * a / l_ : 0.0;
    row(1 + I_ + k) = i == k ? 1.25 + n * n * pi * pi / 6 : odd ? -a : a;
  }
  row /= stiffness;
  if (flexibility_ > 0) row *= 1 + flexibility_ * std::pow(n * pi / l_, 2);
}

}  // namespace hb
