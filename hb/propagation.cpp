#include "hb/propagation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "hb/eigenvalue_radius.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

constexpr double eps = 2.220446049250313e-16;
constexpr double two_pi = 2 * std::numbers::pi;
constexpr int stages = 8;

struct Radau {
  Eigen::Matrix<double, stages, 1> c;
  Eigen::Matrix<double, stages, stages> A, A2;  // A2 = A A: positions from accelerations
};

// Legendre P_0..P_n at x.
template <int n>
std::array<long double, n + 1> legendre(long double x) {
  std::array<long double, n + 1> p{};
  p[0] = 1;
  p[1] = x;
  for (int k = 1; k < n; ++k) p[k + 1] = ((2 * k + 1) * x * p[k] - k * p[k - 1]) / (k + 1);
  return p;
}

// Nodes: roots of P_s - P_(s-1), mapped to (0, 1]. A integrates the interpolating polynomial: with
// V_ij = P_j(x_i) and int_{-1}^{x} P_j = (P_(j+1) - P_(j-1))/(2j+1), A = (1/2) W V^-1.
Radau make_radau() {
  constexpr int s = stages;
  std::array<long double, s> x{};
  const auto f = [](long double t) {
    const auto p = legendre<s>(t);
    return p[s] - p[s - 1];
  };
  int found = 0;
  const int steps = 2000;
  for (int i = 0; i < steps && found < s - 1; ++i) {
    long double a = -1 + 1.9999L * i / steps, b = -1 + 1.9999L * (i + 1) / steps;
    if ((f(a) < 0) == (f(b) < 0)) continue;
    for (int bisection = 0; bisection < 80; ++bisection) {
      const long double middle = (a + b) / 2;
      ((f(a) < 0) == (f(middle) < 0) ? a : b) = middle;
    }
    x[std::size_t(found++)] = (a + b) / 2;
  }
  x[s - 1] = 1;
  Eigen::Matrix<long double, s, s> V, W;
  for (int i = 0; i < s; ++i) {
    const auto p = legendre<s>(x[std::size_t(i)]);
    for (int j = 0; j < s; ++j) {
      V(i, j) = p[std::size_t(j)];
      W(i, j) = j == 0 ? x[std::size_t(i)] + 1 : (p[std::size_t(j + 1)] - p[std::size_t(j - 1)]) / (2 * j + 1);
    }
  }
  const Eigen::Matrix<long double, s, s> A = W * V.inverse() / 2;
  Radau radau;
  for (int i = 0; i < s; ++i) radau.c(i) = double((x[std::size_t(i)] + 1) / 2);
  radau.A = A.cast<double>();
  radau.A2 = (A * A).cast<double>();
  return radau;
}

const Radau& radau() {
  static const Radau tableau = make_radau();
  return tableau;
}

// Basis (1, 2 cos k tau, -2 sin k tau) at all stage angles tau = (n + c_i) h, h = 2 pi/num_cells; kept per thread,
// since neighbouring points of a sweep use the same one.
const MatrixXd& stage_basis(Index num_cells, Index H) {
  thread_local std::map<std::pair<Index, Index>, MatrixXd> kept;
  const auto key = std::pair(num_cells, H);
  if (const auto found = kept.find(key); found != kept.end()) return found->second;
  if (kept.size() > 64) kept.clear();
  MatrixXd basis(2 * H + 1, num_cells * stages);
  for (Index n = 0; n < num_cells; ++n)
    for (int i = 0; i < stages; ++i) {
      const double tau = two_pi * (double(n) + radau().c(i)) / double(num_cells);
      auto column = basis.col(n * stages + i);
      column(0) = 1;
      for (Index k = 1; k <= H; ++k) {
        column(2 * k - 1) = 2 * std::cos(double(k) * tau);
        column(2 * k) = -2 * std::sin(double(k) * tau);
      }
    }
  return kept.emplace(key, std::move(basis)).first->second;
}

// Components x nodes: the series at all stage angles as one matrix product.
MatrixXd at_stages(const FourierSeries& series, Index num_cells) {
  const Index H = series.num_harmonics();
  MatrixXd coefficients(series.num_components(), 2 * H + 1);
  coefficients.col(0) = series.c.col(0).real();
  for (Index k = 1; k <= H; ++k) {
    coefficients.col(2 * k - 1) = series.c.col(k).real();
    coefficients.col(2 * k) = series.c.col(k).imag();
  }
  return coefficients * stage_basis(num_cells, H);
}

// Fixed at compile time for one mode, where allocation would cost more than the arithmetic.
template <int size>
TurnMaps turn(const FourierSeries& alpha, const FourierSeries& beta, Index m, Index num_cells) {
  constexpr int rows = size == Eigen::Dynamic ? Eigen::Dynamic : stages * size;
  constexpr int states = size == Eigen::Dynamic ? Eigen::Dynamic : 2 * size;
  using Block = Eigen::Matrix<double, size, size>;
  const MatrixXd a = at_stages(alpha, num_cells), b = at_stages(beta, num_cells);
  const double h = two_pi / double(num_cells);
  const auto& [c, A, A2] = radau();

  TurnMaps maps;
  for (Index i = 0; i < m; ++i) maps.damping_trace += beta.c(i + m * i, 0).real();
  maps.scale = VectorXd::Ones(m);
  for (Index i = 0; i < m; ++i) maps.scale(i) = std::max(1.0, std::sqrt(std::abs(alpha.c(i + m * i, 0).real())));
  maps.cells.reserve(std::size_t(num_cells));
  Eigen::Matrix<double, rows, rows> system(stages * m, stages * m);
  Eigen::Matrix<double, rows, states> right(stages * m, 2 * m);
  for (Index n = 0; n < num_cells; ++n) {
    // k_i + beta_i h sum_j A_ij k_j + alpha_i h^2 sum_j (A^2)_ij k_j = -beta_i v_0 - alpha_i (x_0 + c_i h v_0)
    for (int i = 0; i < stages; ++i) {
      const Eigen::Map<const Block> alpha_i(a.col(n * stages + i).data(), m, m);
      const Eigen::Map<const Block> beta_i(b.col(n * stages + i).data(), m, m);
      for (int j = 0; j < stages; ++j)
        system.block(i * m, j * m, m, m) = h * A(i, j) * beta_i + h * h * A2(i, j) * alpha_i;
      system.block(i * m, i * m, m, m).diagonal().array() += 1;
      right.block(i * m, 0, m, m) = -alpha_i;
      right.block(i * m, m, m, m) = -beta_i - c(i) * h * alpha_i;
    }
    const Eigen::Matrix<double, rows, states> k = system.partialPivLu().solve(right);
    // Stiffly accurate: the last stage is the end of the cell.
    MatrixXd map = MatrixXd::Zero(2 * m, 2 * m);
    map.topLeftCorner(m, m).setIdentity();
    map.topRightCorner(m, m).diagonal().setConstant(h);
    map.bottomRightCorner(m, m).setIdentity();
    for (int j = 0; j < stages; ++j) {
      map.topRows(m) += h * h * A2(stages - 1, j) * k.middleRows(j * m, m);
      map.bottomRows(m) += h * A(stages - 1, j) * k.middleRows(j * m, m);
    }
    map.topRows(m) = maps.scale.asDiagonal() * map.topRows(m);
    map.leftCols(m) = map.leftCols(m) * maps.scale.cwiseInverse().asDiagonal();
    maps.cells.push_back(map);
  }
  return maps;
}

// One mode, two exponents: with the determinant known (Liouville), s = -b/2 +- acosh(disc)/(2 pi),
// disc = tr Phi/(2 sqrt(det Phi)) and det Phi = exp(-2 pi b), whatever the size of the multipliers.
TurnExponents discriminant(const Eigen::Matrix2d& M, double log_size, double change, double damping) {
  const double mean = -damping / 2;
  const double log_disc = std::log(std::max(std::abs(M.trace() / 2), 1e-300)) + log_size - two_pi * mean;
  if (log_disc > 20) {  // acosh(x) = ln 2x to rounding
    const double growth = (log_disc + std::numbers::ln2) / two_pi, angle = M.trace() < 0 ? 0.5 : 0;
    const double error = 2 * change / std::abs(M.trace() / 2) / two_pi;
    return {{{mean + growth, angle}, {mean - growth, angle}}, {error, error}};
  }
  const double scale = std::exp(log_size - two_pi * mean);
  const double disc = M.trace() / 2 * scale, error = change * scale;
  const double mean_error = 4 * eps * std::abs(mean);
  const double size = std::abs(disc), angle = disc < 0 ? 0.5 : 0;
  TurnExponents result;
  if (size <= 1) {
    const double turn = std::acos(std::clamp(disc, -1.0, 1.0)) / two_pi;
    // Within `error` of +-1 the pair may as well be real.
    const double slack = (std::acos(std::max(size - error, -1.0)) - std::acos(size)) / two_pi;
    const double growth = size + error > 1 ? std::acosh(std::max(1.0, size + error)) / two_pi : 0;
    result.s = {{mean, -turn}, {mean, turn}};
    result.error = {mean_error + slack + growth, mean_error + slack + growth};
  } else {
    const double growth = std::acosh(size) / two_pi;
    const double up = std::acosh(size + error) / two_pi - growth;
    const double down = growth - std::acosh(std::max(1.0, size - error)) / two_pi;
    const double turn = size - error < 1 ? std::acos(std::max(size - error, -1.0)) / two_pi : 0;
    result.s = {{mean + growth, angle}, {mean - growth, angle}};
    result.error = {mean_error + std::max(up, down) + turn, mean_error + std::max(up, down) + turn};
  }
  return result;
}

}  // namespace

TurnMaps radau_turn(const FourierSeries& alpha, const FourierSeries& beta, Index num_modes, Index num_cells) {
  return num_modes == 1 ? turn<1>(alpha, beta, 1, num_cells) : turn<Eigen::Dynamic>(alpha, beta, num_modes, num_cells);
}

TurnExponents turn_exponents(const TurnMaps& maps, double cell_error, bool leading_only) {
  const Index n = maps.cells.front().rows(), N = Index(maps.cells.size());

  // QR sweeps: Q_i R_i = Phi_i Q_(i-1); over the turns Q_0 turns into the ordered invariant subspaces.
  MatrixXd Q = MatrixXd::Identity(n, n), start;
  std::vector<MatrixXd> R = maps.cells;
  VectorXd logs(n);
  const double apart = std::log(10.0);
  std::vector<Index> ends;  // of blocks: exclusive
  const int most_sweeps = leading_only || n == 2 ? 0 : 16;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    start = Q;
    logs.setZero();
    for (Index i = 0; i < N; ++i) {
      const Eigen::HouseholderQR<MatrixXd> qr(maps.cells[std::size_t(i)] * Q);
      Q = qr.householderQ();
      R[std::size_t(i)] = qr.matrixQR().triangularView<Eigen::Upper>();
      logs += R[std::size_t(i)].diagonal().cwiseAbs().cwiseMax(1e-300).array().log().matrix();
    }
    // Split where the growth over the turn differs by 10 and the leading subspace has come back onto itself.
    const MatrixXd turned = start.transpose() * Q;
    ends.clear();
    bool settled = true;
    for (Index j = 1; j < n; ++j) {
      if (!(logs(j - 1) - logs(j) > apart)) continue;
      if (turned.bottomLeftCorner(n - j, j).norm() <= 1e-13 * std::sqrt(double(n)))
        ends.push_back(j);
      else
        settled = false;
    }
    ends.push_back(n);
    if (settled && sweep > 0) break;
  }
  if (ends.empty()) {
    start = Q;
    ends.push_back(n);
  }
  const MatrixXd turned = start.transpose() * Q;
  double closing = 0;
  for (const Index end : ends)
    if (end < n) closing = std::max(closing, turned.bottomLeftCorner(n - end, end).norm());

  TurnExponents result;
  const auto lose = [&](double bound) {
    result.others_below = std::isnan(bound) ? HUGE_VAL : std::max(result.others_below, bound);
  };
  Index begin = 0;
  for (const Index end : ends) {
    const Index p = end - begin;
    // Block of the turn's map: product of the diagonal blocks of R, its size kept apart as a logarithm. A cell map
    // known to `cell_error` of its own size, block or not, changes the product by sum_i |behind_i| |Phi_i| |before_i|.
    std::vector<double> before(std::size_t(N) + 1, 0);
    MatrixXd product = MatrixXd::Identity(p, p);
    double log_size = 0;
    for (Index i = 0; i < N; ++i) {
      product = (R[std::size_t(i)].block(begin, begin, p, p) * product).eval();
      const double size = std::max(product.norm(), 1e-300);
      product /= size;
      log_size += std::log(size);
      before[std::size_t(i) + 1] = log_size;
    }
    MatrixXd behind = MatrixXd::Identity(p, p);
    double log_behind = 0, amplification = 0, last_cell = 0, log_bound = 0;
    for (Index i = N - 1; i >= 0; --i) {
      const MatrixXd& cell = R[std::size_t(i)];
      const auto here = cell.block(begin, begin, p, p);
      const double term =
          std::exp(std::min(before[std::size_t(i)] + log_behind + std::log(cell.norm()) - log_size, 600.0));
      amplification += term;
      if (i == N - 1) last_cell = term;
      log_bound += std::log(here.norm() + (cell_error + (i == N - 1 ? closing : 0)) * cell.norm());
      behind = (behind * here).eval();
      const double size = std::max(behind.norm(), 1e-300);
      behind /= size;
      log_behind += std::log(size);
    }

    const MatrixXd M = turned.block(begin, begin, p, p) * product;
    // |M| is 1. A leading subspace that has not quite come back is a change of the last cell.
    const double change = cell_error * amplification + closing * last_cell;
    if (n == 2) return discriminant(M, log_size, change, maps.damping_trace);
    if (!(change < 0.5)) {
      lose(log_bound / two_pi);
      begin = end;
      continue;
    }
    Eigen::VectorXcd mu;
    if (p == 1)
      mu = Eigen::VectorXcd::Constant(1, M(0, 0));
    else
      mu = Eigen::EigenSolver<MatrixXd>(M, false).eigenvalues();
    for (Index j = 0; j < p; ++j) {
      const double radius = eigenvalue_radius(M, mu(j), change);
      const double size = std::abs(mu(j));
      if (!(radius < 0.5 * size)) {
        lose((std::log(size + radius) + log_size) / two_pi);
        continue;
      }
      double argument = std::arg(mu(j));
      if (argument <= -std::numbers::pi) argument = std::numbers::pi;
      result.s.emplace_back((std::log(size) + log_size) / two_pi, argument / two_pi);
      result.error.push_back(1.5 * radius / size / two_pi);
    }
    begin = end;
  }
  std::vector<std::size_t> order(result.s.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    if (result.s[i].real() != result.s[j].real()) return result.s[i].real() > result.s[j].real();
    return result.s[i].imag() < result.s[j].imag();
  });
  TurnExponents sorted;
  sorted.others_below = result.others_below;
  for (const std::size_t i : order) {
    sorted.s.push_back(result.s[i]);
    sorted.error.push_back(result.error[i]);
  }
  return sorted;
}

}  // namespace hb
