#include "tests/support/long_double_floquet.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hb::reference {

namespace {

using RealMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

constexpr int stages = 12;

struct Tableau {
  std::array<Real, stages> c;
  RealMatrix A;
};

// Nodes: roots of P_s - P_(s-1) on (-1, 1]; weights of the interpolating polynomials by their moments.
Tableau make_tableau() {
  const auto legendre = [](int n, Real x) {
    Real before = 1, now = x;
    if (n == 0) return before;
    for (int k = 1; k < n; ++k) {
      const Real next = ((2 * k + 1) * x * now - k * before) / (k + 1);
      before = now;
      now = next;
    }
    return now;
  };
  const auto f = [&](Real x) { return legendre(stages, x) - legendre(stages - 1, x); };
  Tableau tableau;
  int found = 0;
  const int steps = 4000;
  for (int i = 0; i < steps; ++i) {
    // Denser towards the ends, where the nodes are.
    const auto at = [&](int j) { return -std::cos(std::numbers::pi_v<Real> * (Real(j) + 0.01L) / (steps + 0.5L)); };
    Real a = at(i), b = at(i + 1);
    if ((f(a) < 0) == (f(b) < 0)) continue;
    for (int bisection = 0; bisection < 100; ++bisection) {
      const Real middle = (a + b) / 2;
      ((f(a) < 0) == (f(middle) < 0) ? a : b) = middle;
    }
    if (found < stages - 1) tableau.c[std::size_t(found++)] = (a + b) / 2;
  }
  tableau.c[stages - 1] = 1;
  RealMatrix V(stages, stages), W(stages, stages);
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) {
      const Real x = tableau.c[std::size_t(i)];
      V(i, j) = legendre(j, x);
      W(i, j) = j == 0 ? x + 1 : (legendre(j + 1, x) - legendre(j - 1, x)) / (2 * j + 1);
    }
  tableau.A = W * V.fullPivLu().inverse() / 2;
  for (Real& c : tableau.c) c = (c + 1) / 2;
  return tableau;
}

const Tableau& tableau() {
  static const Tableau t = make_tableau();
  return t;
}

// x'' + G x' + K(tau) x = 0 with x = D q, D^2 = diag M.
struct Equation {
  Eigen::Index I;
  RealMatrix G;
  std::vector<RealMatrix> cosine, sine;  // K = sum_k cosine_k cos k tau + sine_k sin k tau
  RealMatrix at(Real tau) const {
    RealMatrix K = cosine[0];
    for (std::size_t k = 1; k < cosine.size(); ++k)
      K += std::cos(Real(k) * tau) * cosine[k] + std::sin(Real(k) * tau) * sine[k];
    return K;
  }
};

Equation equation(const HillSystem& system, double speed) {
  const Eigen::Index I = system.num_modes();
  const Real Omega = speed;
  const Eigen::Matrix<Real, Eigen::Dynamic, 1> D = system.mass.diagonal().cast<Real>().cwiseAbs().cwiseSqrt();
  const RealMatrix left = D.asDiagonal() * RealMatrix(system.mass.cast<Real>().fullPivLu().inverse());
  const RealMatrix right = D.cwiseInverse().asDiagonal();
  Equation e;
  e.I = I;
  e.G = left * system.damping.cast<Real>() * right / Omega;
  Eigen::Index P = 0;
  for (const FourierSeries& part : system.stiffness) P = std::max(P, part.num_harmonics());
  for (Eigen::Index k = 0; k <= P; ++k) {
    RealMatrix c = RealMatrix::Zero(I, I), s = c;
    Real factor = 1 / (Omega * Omega);
    for (const FourierSeries& part : system.stiffness) {
      if (k < part.c.cols())
        for (Eigen::Index i = 0; i < I * I; ++i) {
          c(i % I, i / I) += factor * Real(part.c(i, k).real()) * (k > 0 ? 2 : 1);
          if (k > 0) s(i % I, i / I) -= factor * 2 * Real(part.c(i, k).imag());
        }
      factor *= Omega;
    }
    e.cosine.push_back(left * c * right);
    e.sine.push_back(left * s * right);
  }
  return e;
}

// Over the turn that begins at the angle `start`.
std::vector<Complex> turn(const Equation& e, Eigen::Index cells, Real start = 0) {
  const Eigen::Index I = e.I, s = stages;
  const auto& [c, A] = tableau();
  const RealMatrix A2 = A * A;
  const Real h = 2 * std::numbers::pi_v<Real> / Real(cells);
  RealMatrix W = RealMatrix::Identity(I, I);
  for (Eigen::Index i = 0; i < I; ++i) W(i, i) = std::max<Real>(1, std::sqrt(std::abs(e.cosine[0](i, i))));
  RealMatrix product = RealMatrix::Identity(2 * I, 2 * I), M(s * I, s * I), right(s * I, 2 * I);
  Real log_size = 0;
  for (Eigen::Index n = 0; n < cells; ++n) {
    for (Eigen::Index i = 0; i < s; ++i) {
      const RealMatrix K = e.at(start + (Real(n) + c[std::size_t(i)]) * h);
      for (Eigen::Index j = 0; j < s; ++j) M.block(i * I, j * I, I, I) = h * A(i, j) * e.G + h * h * A2(i, j) * K;
      M.block(i * I, i * I, I, I).diagonal().array() += 1;
      right.block(i * I, 0, I, I) = -K;
      right.block(i * I, I, I, I) = -e.G - c[std::size_t(i)] * h * K;
    }
    const RealMatrix k = M.partialPivLu().solve(right);
    RealMatrix map = RealMatrix::Identity(2 * I, 2 * I);
    map.topRightCorner(I, I).diagonal().setConstant(h);
    for (Eigen::Index j = 0; j < s; ++j) {
      map.topRows(I) += h * h * A2(s - 1, j) * k.middleRows(j * I, I);
      map.bottomRows(I) += h * A(s - 1, j) * k.middleRows(j * I, I);
    }
    map.topRows(I) = W * map.topRows(I);
    map.leftCols(I) = map.leftCols(I) * W.inverse();
    product = (map * product).eval();
    const Real size = product.norm();
    product /= size;
    log_size += std::log(size);
  }
  const Eigen::EigenSolver<RealMatrix> eigen(product, false);
  std::vector<Complex> s_values;
  for (Eigen::Index i = 0; i < 2 * I; ++i) {
    const Complex mu = eigen.eigenvalues()(i);
    s_values.emplace_back(
        (std::log(std::max<Real>(std::abs(mu), 1e-4000L)) + log_size) / (2 * std::numbers::pi_v<Real>),
        std::arg(mu) / (2 * std::numbers::pi_v<Real>));
  }
  return s_values;
}

// Imaginary parts modulo 1.
Real distance(Complex a, Complex b) {
  Real turn = std::fmod(std::abs(a.imag() - b.imag()), Real(1));
  return std::hypot(a.real() - b.real(), std::min(turn, 1 - turn));
}

}  // namespace

std::vector<FloquetExponent> floquet_exponents(const HillSystem& system, double speed) {
  const Equation e = equation(system, speed);
  Real fastest = 1;
  for (Eigen::Index i = 0; i < e.I; ++i) {
    Real row = 0;
    for (Eigen::Index j = 0; j < e.I; ++j)
      for (std::size_t k = 0; k < e.cosine.size(); ++k)
        row += std::sqrt(std::abs((std::abs(e.cosine[k](i, j)) + std::abs(e.sine[k](i, j))) *
                                  (std::abs(e.cosine[k](j, i)) + std::abs(e.sine[k](j, i)))));
    fastest = std::max(fastest, std::sqrt(row));
  }
  const Real bandwidth = Real(e.cosine.size());
  const auto cells = Eigen::Index(std::ceil(1.3L * std::max(fastest, bandwidth / 2))) + 10;
  const Eigen::Index more = cells + cells / 3 + 3;
  const std::vector<Complex> fine = turn(e, more);
  // The same turn begun elsewhere rounds differently.
  const std::array<std::vector<Complex>, 2> others = {turn(e, cells), turn(e, more, 2.5L)};
  Real leading = -HUGE_VALL;
  for (const Complex s : fine) leading = std::max(leading, s.real());
  std::vector<FloquetExponent> result;
  for (const Complex s : fine) {
    if (s.real() < leading - 30 / (2 * std::numbers::pi_v<Real>)) continue;
    Real change = 0;
    for (const std::vector<Complex>& list : others) {
      Real nearest = HUGE_VALL;
      for (const Complex other : list) nearest = std::min(nearest, distance(s, other));
      change = std::max(change, nearest);
    }
    // Rounding of the product, a hundred times epsilon of its largest multiplier; more where both runs differ by more.
    const Real noise = 1e-17L * std::exp(2 * std::numbers::pi_v<Real> * (leading - s.real()));
    result.push_back({s * Real(speed), (2 * change + noise + 1e-18L * std::abs(s)) * Real(speed)});
  }
  std::sort(result.begin(), result.end(),
            [](const FloquetExponent& a, const FloquetExponent& b) { return a.value.real() > b.value.real(); });
  return result;
}

}  // namespace hb::reference
