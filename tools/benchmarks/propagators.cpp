// What propagates a turn best: growth rate from the maps over equal cells by several methods, error against time, as
// CSV on standard output. The engine's Radau IIA collocation (cells in SIMD lanes) beside dense code of one kind for
// all others: Radau IIA and Gauss collocation of eight stages, Magnus of order 4, Taylor series of order 20.
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "cases.hpp"
#include "hb/engine/exponents/radau_turn.hpp"
#include "hb/engine/exponents/stability.hpp"
#include "hb/engine/exponents/turn_exponents.hpp"
#include "hb/engine/system/scaled_system.hpp"
#include "timing.hpp"

namespace hb::benchmarks {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// x'' + beta x' + alpha(tau) x = 0 in states (W x, x').
struct Equation {
  FourierSeries alpha;  // m*m components
  MatrixXd beta;
  VectorXd W;

  explicit Equation(const ScaledSystem& system) : alpha(system.K), beta(system.G), W(system.num_modes()) {
    for (Index i = 0; i < W.size(); ++i) W(i) = std::max(1.0, std::sqrt(std::abs(alpha.c(i + W.size() * i, 0))));
  }
  Index num_modes() const { return W.size(); }
  MatrixXd stiffness(double tau) const { return fourier::evaluate(alpha, tau).reshaped(num_modes(), num_modes()); }
  // d^j alpha/dtau^j / j! at tau, j = 0..order.
  std::vector<MatrixXd> stiffness_series(double tau, int order) const {
    std::vector<MatrixXd> terms;
    FourierSeries term = alpha;
    for (int j = 0; j <= order; ++j) {
      if (j > 0) {
        term = fourier::derivative(term);
        term.c /= j;
      }
      terms.push_back(fourier::evaluate(term, tau).reshaped(num_modes(), num_modes()));
    }
    return terms;
  }
  MatrixXd first_order(double tau) const {
    const Index m = num_modes();
    MatrixXd A = MatrixXd::Zero(2 * m, 2 * m);
    A.topRightCorner(m, m) = W.asDiagonal();
    A.bottomLeftCorner(m, m) = -stiffness(tau) * W.cwiseInverse().asDiagonal();
    A.bottomRightCorner(m, m) = -beta;
    return A;
  }
  MatrixXd scaled(MatrixXd map) const {
    const Index m = num_modes();
    map.topRows(m) = (W.asDiagonal() * map.topRows(m)).eval();
    map.leftCols(m) = (map.leftCols(m) * W.cwiseInverse().asDiagonal()).eval();
    return map;
  }
};

constexpr int stages = 8;

// Nodes in (0, 1], A integrates the interpolating polynomial to the nodes, b to 1; A^2 and b A for positions.
struct Tableau {
  Eigen::Matrix<double, stages, 1> c;
  Eigen::Matrix<double, stages, stages> A;
  Eigen::Matrix<double, 1, stages> b;
};

double legendre(int n, double x) {
  double last = 0, p = 1;
  for (int k = 0; k < n; ++k) {
    const double next = ((2 * k + 1) * x * p - k * last) / (k + 1);
    last = p;
    p = next;
  }
  return p;
}

// Roots of `polynomial` of degree `stages` on (-1, 1], all simple.
Tableau tableau(const std::function<double(double)>& polynomial) {
  Tableau t;
  int found = 0;
  constexpr int steps = 4001;
  for (int i = 0; i < steps && found < stages; ++i) {
    double low = -1 + 2.0 * i / steps + 1e-9, high = -1 + 2.0 * (i + 1) / steps + 1e-9;
    if ((polynomial(low) < 0) == (polynomial(high) < 0)) continue;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (low + high);
      ((polynomial(low) < 0) == (polynomial(middle) < 0) ? low : high) = middle;
    }
    t.c(found++) = 0.25 * (low + high) + 0.5;
  }
  // int_{-1}^x P_j = (P_(j+1) - P_(j-1))/(2j + 1)
  const auto integral = [](int j, double x) {
    return j == 0 ? x + 1 : (legendre(j + 1, x) - legendre(j - 1, x)) / (2 * j + 1);
  };
  Eigen::Matrix<double, stages, stages> V, integrals;
  Eigen::Matrix<double, 1, stages> whole;
  for (int j = 0; j < stages; ++j) {
    for (int i = 0; i < stages; ++i) {
      V(i, j) = legendre(j, 2 * t.c(i) - 1);
      integrals(i, j) = integral(j, 2 * t.c(i) - 1);
    }
    whole(j) = integral(j, 1);
  }
  const Eigen::Matrix<double, stages, stages> inverse = V.inverse();
  t.A = integrals * inverse / 2;
  t.b = whole * inverse / 2;
  return t;
}

// k_i + h beta sum_j A_ij k_j + h^2 alpha_i sum_j (A^2)_ij k_j = -beta v - alpha_i (x + c_i h v)
MatrixXd collocation(const Equation& e, const Tableau& t, double tau, double h) {
  const Index m = e.num_modes();
  const Eigen::Matrix<double, stages, stages> A2 = t.A * t.A;
  const Eigen::Matrix<double, 1, stages> bA = t.b * t.A;
  MatrixXd system = MatrixXd::Identity(stages * m, stages * m), right(stages * m, 2 * m);
  for (int i = 0; i < stages; ++i) {
    const MatrixXd alpha = e.stiffness(tau + t.c(i) * h);
    for (int j = 0; j < stages; ++j)
      system.block(i * m, j * m, m, m) += h * t.A(i, j) * e.beta + h * h * A2(i, j) * alpha;
    right.block(i * m, 0, m, m) = -alpha;
    right.block(i * m, m, m, m) = -e.beta - t.c(i) * h * alpha;
  }
  const MatrixXd k = system.partialPivLu().solve(right);
  MatrixXd map = MatrixXd::Identity(2 * m, 2 * m);
  map.topRightCorner(m, m).diagonal().setConstant(h);
  for (int j = 0; j < stages; ++j) {
    map.topRows(m) += h * h * bA(j) * k.middleRows(j * m, m);
    map.bottomRows(m) += h * t.b(j) * k.middleRows(j * m, m);
  }
  return e.scaled(map);
}

// exp(h (A1 + A2)/2 + sqrt(3) h^2/12 [A2, A1]) with A at the two Gauss nodes.
MatrixXd magnus4(const Equation& e, double tau, double h) {
  const double aside = std::sqrt(3.0) / 6;
  const MatrixXd A1 = e.first_order(tau + (0.5 - aside) * h), A2 = e.first_order(tau + (0.5 + aside) * h);
  return (h / 2 * (A1 + A2) + std::sqrt(3.0) * h * h / 12 * (A2 * A1 - A1 * A2)).exp();
}

// x_(n+2) (n+2)(n+1) = -beta (n+1) x_(n+1) - sum_j alpha_j x_(n-j)
MatrixXd taylor(const Equation& e, double tau, double h) {
  constexpr int order = 20;
  const Index m = e.num_modes();
  const std::vector<MatrixXd> alpha = e.stiffness_series(tau, order);
  std::vector<MatrixXd> x(order + 1, MatrixXd::Zero(m, 2 * m));
  x[0].leftCols(m).setIdentity();
  x[1].rightCols(m).setIdentity();
  for (int n = 0; n + 2 <= order; ++n) {
    MatrixXd sum = e.beta * x[std::size_t(n + 1)] * double(n + 1);
    for (int j = 0; j <= n; ++j) sum += alpha[std::size_t(j)] * x[std::size_t(n - j)];
    x[std::size_t(n + 2)] = -sum / double((n + 2) * (n + 1));
  }
  MatrixXd map = MatrixXd::Zero(2 * m, 2 * m);
  for (int n = order; n >= 0; --n) {
    map.topRows(m) = (map.topRows(m) * h + x[std::size_t(n)]).eval();
    if (n > 0) map.bottomRows(m) = (map.bottomRows(m) * h + n * x[std::size_t(n)]).eval();
  }
  return e.scaled(map);
}

using CellMap = std::function<MatrixXd(const Equation&, double tau, double h)>;

TurnMaps turn(const Equation& e, Index cells, const CellMap& map) {
  const Index n = 2 * e.num_modes();
  const double h = 2 * std::numbers::pi / double(cells);
  TurnMaps maps{cells, MatrixXd(n, n * cells), e.W, MatrixXd::Ones(n, n), e.beta.trace()};
  for (Index c = 0; c < cells; ++c) maps.cells.middleCols(n * c, n) = map(e, double(c) * h, h);
  return maps;
}

void rows(const Case& c) {
  const ScaledSystem system = scale_system(c.system, c.speed);
  if (!system.diagonal_damping || system.K.num_harmonics() > 64) return;  // evaluating K would be all that is timed
  const Equation e(system);
  const Index m = e.num_modes();
  const Stability reference = analyse_stability(system, {.tolerance = 1e-12});
  const double exact = reference.growth_rate / system.speed;
  FourierSeries beta(m * m, 0);
  beta.c.col(0) = e.beta.reshaped().cast<std::complex<double>>();
  const Tableau radau = tableau([](double x) { return legendre(stages, x) - legendre(stages - 1, x); });
  const Tableau gauss = tableau([](double x) { return legendre(stages, x); });
  const auto method = [&](const char* name, const std::function<TurnMaps(Index)>& maps) {
    for (const Index cells : {8, 16, 32, 64, 128, 256, 512}) {
      const TurnExponents found = turn_exponents(maps(cells), MatrixXd::Zero(2 * m, 2 * m), true);
      const double error = found.s.empty() ? HUGE_VAL : std::abs(found.s[0].real() - exact);
      const bool sign = !found.s.empty() && (found.s[0].real() > 0) == (exact > 0);
      const Timing timing = timed([&] { (void)maps(cells); }, 1);
      std::printf("%s,%ld,%s,%ld,%.3e,%s,%.4e,%.4e\n", c.name.c_str(), long(m), name, long(cells),
                  error / std::max(1.0, std::abs(exact)), sign ? "right" : "wrong", timing.best, timing.median);
      std::fflush(stdout);
      if (error < 1e-11 || timing.best > 1) break;
    }
  };
  method("radau_in_lanes", [&](Index cells) { return radau_turn(e.alpha, beta, m, radau_cells(cells)); });
  const auto dense = [&](const char* name, const CellMap& map) {
    method(name, [&](Index cells) { return turn(e, cells, map); });
  };
  dense("radau", [&](const Equation& q, double tau, double h) { return collocation(q, radau, tau, h); });
  dense("gauss", [&](const Equation& q, double tau, double h) { return collocation(q, gauss, tau, h); });
  dense("magnus4", magnus4);
  dense("taylor20", taylor);
}

}  // namespace

}  // namespace hb::benchmarks

int main() {
  using namespace hb::benchmarks;
  std::printf("%s\n", header().c_str());
  std::printf("system,modes,method,cells,error,sign,seconds_min,seconds_median\n");
  for (const Case& c : all_cases())
    if (c.system.num_modes() <= 10) rows(c);
}
