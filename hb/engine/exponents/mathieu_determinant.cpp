#include "hb/engine/exponents/mathieu_determinant.hpp"

#include <Eigen/Core>
#include <cmath>

#include "lib/constants.hpp"

namespace hb {

namespace {

using Lanes = Eigen::Array4d;  // even and odd periodic, even and odd antiperiodic

constexpr int most_rows = 2000;

struct Bounded {
  double value, error;
};

Bounded operator*(Bounded a, Bounded b) {
  return {a.value * b.value, std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error +
                                 eps * std::abs(a.value * b.value)};
}

// Rows after which the closed form of the tail is exact to rounding by the orders of what it leaves out:
// 0.03 |a| N^-9 (Euler-Maclaurin), 0.2 q^4 (4 |a| + 9) N^-9 and q^6 N^-11.
int enough_rows(double a, double q) {
  const double size = std::abs(a), q4 = q * q * q * q;
  const double ninth = std::pow((0.03 * size + 0.2 * q4 * (4 * size + 9)) / eps, 1.0 / 9);
  const double eleventh = std::pow(q4 * q * q / eps, 1.0 / 11);
  return int(std::ceil(std::min(std::max({20.0, 4 * std::sqrt(size + 2 * q), ninth, eleventh}), 1e9)));
}

// sum_{n >= 0} (X + 1/2 + n)^-2j by the midpoint form of Euler and Maclaurin.
Lanes zeta_tail(int j, const Lanes& X) {
  const Lanes r = X.square().inverse();
  Lanes power = X;
  for (int i = 0; i < j; ++i) power *= r;
  const double p = 2 * j, c1 = p / 24, c2 = 7 * p * (p + 1) * (p + 2) / 5760,
               c3 = 31 * p * (p + 1) * (p + 2) * (p + 3) * (p + 4) / 967680;
  return power * (1 / (p - 1) - r * (c1 - r * (c2 - r * c3)));
}

// Logarithm of the factor by which the rows k = X + 1/2, X + 3/2, .. change the determinants:
//     sum ln(1 - a/k^2) - e_k - e_k^2/2 - e_k e_{k-1},      e_k = q^2/((k^2 - a)((k - 1)^2 - a)).
// With m = k - 1/2 the denominator of e is m^4 - (2a + 1/2) m^2 + a^2 - a/2 + 1/16.
Lanes tail(double a, double q, const Lanes& X) {
  constexpr int most_terms = 40;
  Lanes sum = Lanes::Zero();
  double power = a;
  for (int j = 1; j < most_terms; ++j) {
    const Lanes term = power / j * zeta_tail(j, X);
    sum -= term;
    if (!(term.abs().maxCoeff() > 0.1 * eps)) break;
    power *= a;
  }
  const Lanes M = X - 0.5;
  double c = q * q, before = 0;
  for (int j = 0; j < most_terms; ++j) {
    const Lanes term = c * zeta_tail(2 + j, M);
    sum -= term;
    if (!(term.abs().maxCoeff() > 0.1 * eps)) break;
    const double next = (2 * a + 0.5) * c - (a * a - a / 2 + 0.0625) * before;
    before = c;
    c = next;
  }
  const double q4 = q * q * q * q;
  return sum - q4 * (0.5 * zeta_tail(4, M) + zeta_tail(4, M - 0.5));
}

}  // namespace

std::optional<ExponentPair> mathieu_exponents(const MathieuEquation& equation) {
  const double b = equation.b, q = equation.q, a = equation.w2 - b * b / 4;
  const double a_error =
      equation.stiffness_error + std::abs(b) / 2 * equation.damping_error + eps * (std::abs(equation.w2) + b * b / 4);
  const int N = enough_rows(a, q);
  if (!(N <= most_rows)) return std::nullopt;

  // p_k = d_k p_{k-1} - e_k p_{k-2},   d_k = 1 - a/k^2,   e_k = q^2/(k^2 (k-1)^2); first rows apart.
  Lanes last(1, 1, 1, 1), p(a, 1, 1 - 4 * (a + q), 1 - 4 * (a - q));
  Lanes last_error = Lanes::Zero();
  Lanes error(a_error, 0, 4 * (a_error + equation.stiffness_error) + eps * (1 + 12 * (std::abs(a) + q)), 0);
  error(3) = error(2);
  Lanes k(1, 1, 1.5, 1.5), before(-2, 0, 4, 4);  // 1/(k - 1)^2; the first two are those of e_1 = -2 q^2 and 0
  const double dq2 = (2 * q + equation.stiffness_error) * equation.stiffness_error;
  for (int row = 1; row <= N; ++row) {
    const Lanes r = k.square().inverse(), d = 1 - a * r, e = q * q * r * before;
    const Lanes grown = d.abs() * error + e.abs() * last_error + (a_error + 2 * eps * std::abs(a)) * r * p.abs() +
                        (dq2 * r * before.abs() + 4 * eps * e.abs()) * last.abs() + 2 * eps * (d * p).abs();
    const Lanes next = d * p - e * last;
    last = p;
    last_error = error;
    p = next;
    error = grown;
    before = r;
    k += 1;
    if (!(error.maxCoeff() < 1e150)) return std::nullopt;
  }
  const Lanes factor = tail(a, q, k - 0.5).exp();
  // What N left out, the series, and what errors of a and q do to them.
  const double tail_error = 16 * eps + 2 * (a_error / N + equation.stiffness_error * q / (double(N) * N * N));
  p *= factor;
  error = error * factor + tail_error * p.abs();

  const Bounded periodic = Bounded{p(0), error(0)} * Bounded{p(1), error(1)};
  const Bounded antiperiodic = Bounded{p(2), error(2)} * Bounded{p(3), error(3)};
  const Bounded sinh2{-pi * pi * periodic.value, pi * pi * periodic.error * (1 + 4 * eps)};
  const Bounded cosh2 = antiperiodic;
  if (!(std::abs(cosh2.value - sinh2.value - 1) <= sinh2.error + cosh2.error + 4 * eps)) return std::nullopt;

  // Of |f| = sin^2 or sinh^2 of pi nu the quantity nu, and its error; near zero it is of the size of sqrt(error).
  const auto root = [](double f, double f_error, auto inverse, double slope) -> Bounded {
    const double x = std::sqrt(f);
    if (f > 4 * f_error) return {inverse(x) / pi, f_error / (x * slope * pi) + 2 * eps * inverse(x)};
    return {inverse(x) / pi, std::sqrt(f + f_error)};
  };
  const auto asin = [](double x) { return std::asin(std::min(x, 1.0)); };
  const auto asinh = [](double x) { return std::asinh(x); };
  std::complex<double> mu;
  double mu_error;
  if (sinh2.value > 0) {
    const Bounded growth = root(sinh2.value, sinh2.error, asinh, std::sqrt(1 + sinh2.value));
    mu = growth.value;
    mu_error = growth.error;
  } else if (cosh2.value < 0) {
    const Bounded growth = root(-cosh2.value, cosh2.error, asinh, std::sqrt(1 - cosh2.value));
    mu = {growth.value, 0.5};
    mu_error = growth.error;
  } else if (-sinh2.value < 0.5) {
    const Bounded turn = root(-sinh2.value, sinh2.error, asin, std::sqrt(std::max(cosh2.value, 0.25)));
    mu = {0, turn.value};
    mu_error = turn.error;
  } else {
    const Bounded turn = root(cosh2.value, cosh2.error, asin, std::sqrt(std::max(-sinh2.value, 0.25)));
    mu = {0, 0.5 - turn.value};
    mu_error = turn.error;
  }
  if (!std::isfinite(mu_error)) return std::nullopt;
  const double bar = mu_error + equation.damping_error / 2 + eps * (std::abs(b) + std::abs(mu));
  // A tongue of half order: both exponents have the imaginary part 1/2.
  const std::complex<double> other = mu.real() != 0 ? std::complex<double>(-mu.real(), mu.imag()) : -mu;
  return ExponentPair{{-b / 2 + mu, -b / 2 + other}, {bar, bar}};
}

}  // namespace hb
