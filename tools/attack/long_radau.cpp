#include "tools/attack/long_radau.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace hb::attack {

namespace {

using Eigen::Index;
using Real = long double;

constexpr int stages = 8;
constexpr Real two_pi = 2 * std::numbers::pi_v<Real>;

struct Tableau {
  std::array<Real, stages> c{};
  Eigen::Matrix<Real, stages, stages> A, A2;
};

// P_0 .. P_8 at x.
std::array<Real, stages + 1> legendre(Real x) {
  std::array<Real, stages + 1> p{1, x};
  for (int k = 1; k < stages; ++k)
    p[std::size_t(k) + 1] = ((2 * k + 1) * x * p[std::size_t(k)] - k * p[std::size_t(k) - 1]) / (k + 1);
  return p;
}

// Nodes are the roots of P_8 - P_7; sum_k A_ik c_k^q = c_i^(q+1)/(q+1), q = 0 .. 7, with c^q replaced by Legendre
// polynomials, solved by elimination.
Tableau make_tableau() {
  const auto f = [](Real x) { return legendre(x)[stages] - legendre(x)[stages - 1]; };
  std::array<Real, stages> x{};
  int found = 0;
  constexpr int steps = 4000;
  for (int i = 0; i < steps && found < stages - 1; ++i) {
    Real a = -1 + Real(1.9999) * i / steps, b = -1 + Real(1.9999) * (i + 1) / steps;
    if ((f(a) < 0) == (f(b) < 0)) continue;
    for (int bisection = 0; bisection < 70; ++bisection) {
      const Real middle = (a + b) / 2;
      ((f(a) < 0) == (f(middle) < 0) ? a : b) = middle;
    }
    x[std::size_t(found++)] = (a + b) / 2;
  }
  x[stages - 1] = 1;
  Eigen::Matrix<Real, stages, stages> P, integrals;  // P_q(x_k), int_{-1}^{x_i} P_q / 2
  for (int k = 0; k < stages; ++k) {
    const auto p = legendre(x[std::size_t(k)]);
    for (int q = 0; q < stages; ++q) {
      P(q, k) = p[std::size_t(q)];
      integrals(q, k) =
          q == 0 ? (x[std::size_t(k)] + 1) / 2 : (p[std::size_t(q) + 1] - p[std::size_t(q) - 1]) / (4 * q + 2);
    }
  }
  // A P^T = integrals^T
  for (int k = 0; k < stages; ++k) {
    int pivot = k;
    for (int i = k + 1; i < stages; ++i)
      if (std::abs(P(i, k)) > std::abs(P(pivot, k))) pivot = i;
    P.row(k).swap(P.row(pivot));
    integrals.row(k).swap(integrals.row(pivot));
    for (int i = 0; i < stages; ++i) {
      if (i == k) continue;
      const Real l = P(i, k) / P(k, k);
      P.row(i) -= l * P.row(k);
      integrals.row(i) -= l * integrals.row(k);
    }
  }
  Tableau t;
  for (int k = 0; k < stages; ++k) {
    t.c[std::size_t(k)] = (x[std::size_t(k)] + 1) / 2;
    t.A.col(k) = integrals.row(k).transpose() / P(k, k);
  }
  t.A2 = t.A * t.A;
  return t;
}

// Column-major m x m at an angle.
LongMatrix value(const FourierSeries& series, Index m, Real tau) {
  LongMatrix result(m, m);
  for (Index q = 0; q < m * m; ++q) {
    Real sum = series.c(q, 0).real();
    for (Index k = 1; k < series.c.cols(); ++k)
      sum += 2 * (series.c(q, k).real() * std::cos(Real(k) * tau) - series.c(q, k).imag() * std::sin(Real(k) * tau));
    result(q) = sum;
  }
  return result;
}

// A X = B by elimination with row pivots; X takes the place of B.
void solve(LongMatrix& A, LongMatrix& B) {
  const Index n = A.rows();
  for (Index k = 0; k < n; ++k) {
    Index pivot = 0;
    A.col(k).tail(n - k).cwiseAbs().maxCoeff(&pivot);
    A.row(k).swap(A.row(k + pivot));
    B.row(k).swap(B.row(k + pivot));
    for (Index i = k + 1; i < n; ++i) {
      const Real l = A(i, k) / A(k, k);
      if (l == 0) continue;
      A.row(i).tail(n - k - 1) -= l * A.row(k).tail(n - k - 1);
      B.row(i) -= l * B.row(k);
    }
  }
  for (Index i = n - 1; i >= 0; --i) {
    for (Index k = i + 1; k < n; ++k) B.row(i) -= A(i, k) * B.row(k);
    B.row(i) /= A(i, i);
  }
}

}  // namespace

// k_i + beta_i h sum_j A_ij k_j + alpha_i h^2 sum_j (A^2)_ij k_j = -beta_i v_0 - alpha_i (x_0 + c_i h v_0)
std::vector<LongMatrix> long_radau_turn(const FourierSeries& alpha, const FourierSeries& beta, Index num_cells,
                                        const Eigen::VectorXd& scale) {
  static const Tableau tableau = make_tableau();
  const auto& [c, A, A2] = tableau;
  const Index m = scale.size();
  const Real h = two_pi / Real(num_cells);
  const auto W = scale.cast<Real>().eval();
  std::vector<LongMatrix> maps;
  for (Index n = 0; n < num_cells; ++n) {
    LongMatrix system(stages * m, stages * m), k(stages * m, 2 * m);
    for (int i = 0; i < stages; ++i) {
      const Real tau = (Real(n) + c[std::size_t(i)]) * h;
      const LongMatrix a = value(alpha, m, tau), b = value(beta, m, tau);
      for (int j = 0; j < stages; ++j) system.block(i * m, j * m, m, m) = h * A(i, j) * b + h * h * A2(i, j) * a;
      system.block(i * m, i * m, m, m).diagonal().array() += 1;
      k.block(i * m, 0, m, m) = -a;
      k.block(i * m, m, m, m) = -b - c[std::size_t(i)] * h * a;
    }
    solve(system, k);
    LongMatrix map = LongMatrix::Identity(2 * m, 2 * m);
    map.topRightCorner(m, m).diagonal().setConstant(h);
    for (int j = 0; j < stages; ++j) {
      map.topRows(m) += h * h * A2(stages - 1, j) * k.middleRows(j * m, m);
      map.bottomRows(m) += h * A(stages - 1, j) * k.middleRows(j * m, m);
    }
    map.topRows(m) = W.asDiagonal() * map.topRows(m);
    map.leftCols(m) = map.leftCols(m) * W.cwiseInverse().asDiagonal();
    maps.push_back(std::move(map));
  }
  return maps;
}

}  // namespace hb::attack
