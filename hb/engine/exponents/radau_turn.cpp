#include "hb/engine/exponents/radau_turn.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <vector>

#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using cplx = std::complex<double>;

template <int stages>
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

// Nodes: roots of P_s - P_(s-1), mapped to (0, 1]. A integrates the interpolating polynomial: the Gauss-Radau rule of
// the nodes, weights w_k = (1 + x_k)/(s P_(s-1)(x_k))^2 with the end at -1, integrates products of degree 2s - 2
// exactly, so that with int_{-1}^{x} P_j = (P_(j+1) - P_(j-1))/(2j+1)
//     A_ik = (w_k/2) sum_{j<s} (2j+1)/2 P_j(x_k) int_{-1}^{x_i} P_j.
template <int s>
Radau<s> make_radau() {
  std::array<long double, s> x{};
  const auto f = [](long double t) {
    const auto p = legendre<s>(t);
    return p[s] - p[s - 1];
  };
  int found = 0;
  const int steps = 100;  // the roots are at least 0.1 apart
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
  std::array<std::array<long double, s>, s> A{};
  for (std::size_t i = 0; i < s; ++i)
    for (std::size_t k = 0; k < s; ++k) {
      const auto p = legendre<s>(x[i]), at = legendre<s>(x[k]);
      const long double root = s * at[s - 1], weight = (1 + x[k]) / (root * root);
      A[i][k] = weight / 4 * (x[i] + 1);
      for (std::size_t j = 1; j < s; ++j) A[i][k] += weight / 4 * at[j] * (p[j + 1] - p[j - 1]);
    }
  Radau<s> radau;
  for (std::size_t i = 0; i < s; ++i) {
    radau.c(Index(i)) = double((x[i] + 1) / 2);
    for (std::size_t k = 0; k < s; ++k) {
      long double square = 0;
      for (std::size_t j = 0; j < s; ++j) square += A[i][j] * A[j][k];
      radau.A(Index(i), Index(k)) = double(A[i][k]);
      radau.A2(Index(i), Index(k)) = double(square);
    }
  }
  return radau;
}

template <int stages>
const Radau<stages>& radau() {
  static const Radau<stages> tableau = make_radau<stages>();
  return tableau;
}

// Cells side by side: their maps do not depend on each other, so four are computed at once.
constexpr Index lanes = 4;
using Lane = Eigen::Array<double, lanes, 1>;
// Above, the blocked kernels of one matrix at a time are faster.
constexpr Index most_modes_in_lanes = 8, most_rows = 8 * most_modes_in_lanes;

// e^{i k c_i h}, h = 2 pi/num_cells, at (k, i), k up to `least`; kept per thread, since neighbouring points of a
// sweep use the same ones.
template <int stages>
const Eigen::ArrayXXcd& stage_shifts(Index num_cells, Index least) {
  thread_local std::map<std::pair<Index, Index>, Eigen::ArrayXXcd> kept;
  const Index H = (least + 15) / 16 * 16;
  const auto key = std::pair(num_cells, H);
  if (const auto found = kept.find(key); found != kept.end()) return found->second;
  if (kept.size() > 64) kept.clear();
  Eigen::ArrayXXcd shifts(H + 1, stages);
  for (int i = 0; i < stages; ++i)
    for (Index k = 0; k <= H; ++k)
      shifts(k, i) = std::polar(1.0, double(k) * two_pi * radau<stages>().c(i) / double(num_cells));
  return kept.emplace(key, std::move(shifts)).first->second;
}

// Adds harmonic k, beyond those that N samples tell apart, to the one that it looks like at them.
void fold(cplx c, Index k, Index N, cplx* spectrum) {
  const Index r = k % N;
  cplx& bin = spectrum[2 * r <= N ? r : N - r];
  if (r == 0 || 2 * r == N)
    bin += 2 * c.real();
  else
    bin += 2 * r < N ? c : std::conj(c);
}

// The series at the stage angles (n + c_i) h, row i num_cells + n, a column per component: per stage one Fourier
// transform over the cells of the shifted coefficients, those beyond its length folded back.
template <int stages>
MatrixXd at_stages(const FourierSeries& series, Index num_cells) {
  const Index H = series.num_harmonics(), N = num_cells, n = series.num_components();
  if (H == 0) return series.c.col(0).real().transpose().replicate(stages * N, 1);
  const auto& shifts = stage_shifts<stages>(N, H);
  fourier::RealTransform& transform = fourier::thread_transform(N, stages);
  MatrixXd values(stages * N, n);
  const Index apart = std::min(H + 1, (N + 1) / 2);
  Eigen::ArrayXcd own(H + 1), shifted(H + 1);
  for (Index q = 0; q < n; ++q) {
    auto spectrum = transform.spectrum();
    own = series.c.row(q).transpose();
    for (Index i = 0; i < stages; ++i) {
      shifted = own * shifts.col(i).head(H + 1);
      spectrum.col(i).head(apart) = shifted.head(apart);
      spectrum.col(i).tail(spectrum.rows() - apart).setZero();
      for (Index k = apart; k <= H; ++k) fold(shifted(k), k, N, &spectrum(0, i));
    }
    transform.backward();
    values.col(q) = transform.samples().reshaped();
  }
  return values;
}

// Rows are eliminated in pairs, with four pivots at a time: twice as much arithmetic as loads.
constexpr Index block = 4;
using Multiples = std::array<Lane, block>;

// a <- a - l p, b <- b - m p with the four rows p, for entries from..to-1.
inline void subtract(Lane* __restrict a, Lane* __restrict b, const Multiples& l, const Multiples& m,
                     const Lane* __restrict p, Index stride, Index from, Index to) {
  const auto [l0, l1, l2, l3] = l;
  const auto [m0, m1, m2, m3] = m;
  const Lane *p0 = p, *p1 = p0 + stride, *p2 = p1 + stride, *p3 = p2 + stride;
  for (Index j = from; j < to; ++j) {
    Lane x = a[j], y = b[j], pivot = p0[j];
    x -= l0 * pivot;
    y -= m0 * pivot;
    pivot = p1[j];
    x -= l1 * pivot;
    y -= m1 * pivot;
    pivot = p2[j];
    x -= l2 * pivot;
    y -= m2 * pivot;
    pivot = p3[j];
    x -= l3 * pivot;
    y -= m3 * pivot;
    a[j] = x;
    b[j] = y;
  }
}

// Solves A X = B, A n x n, B n x r, n a multiple of `block`, in all lanes: rows [A B] of n + r entries, overwritten; X
// takes the place of B. Nothing is interchanged; returned is what the rounding errors are relative to,
// max_i sum_k |l_ik| max_j |u_kj|, divided by max |a_ij|: not finite, or large, where pivots would have been needed.
template <int fixed_n, int fixed_r>
Lane eliminate(Lane* rows, Index dynamic_n, Index dynamic_r) {
  static_assert(fixed_n <= most_rows);
  const Index n = fixed_n == Eigen::Dynamic ? dynamic_n : fixed_n;
  const Index width = n + (fixed_r == Eigen::Dynamic ? dynamic_r : fixed_r);
  const auto row_of = [&](Index i) { return rows + i * width; };
  std::array<Lane, most_rows> inverse, largest, sum;
  const auto at = [](auto& of_rows, Index i) -> Lane& { return of_rows[std::size_t(i)]; };
  Lane size = Lane::Zero(), growth = Lane::Zero();
  for (Index i = 0; i < n; ++i) {
    at(sum, i) = Lane::Zero();
    for (Index j = 0; j < n; ++j) size = size.max(row_of(i)[j].abs());
  }
  for (Index k = 0; k < n; k += block) {
    for (Index q = k; q < k + block; ++q) {
      Lane* row = row_of(q);
      for (Index r = k; r < q; ++r) {
        const Lane l = row[r] * at(inverse, r);
        at(sum, q) += l.abs() * at(largest, r);
        for (Index j = r + 1; j < width; ++j) row[j] -= l * row_of(r)[j];
      }
      at(inverse, q) = 1 / row[q];
      at(largest, q) = Lane::Zero();
      for (Index j = q; j < n; ++j) at(largest, q) = at(largest, q).max(row[j].abs());
      growth = growth.max(at(sum, q) + at(largest, q));
    }
    const auto multiples = [&](Index i) {
      Multiples l;
      for (Index q = 0; q < block; ++q) {
        Lane value = row_of(i)[k + q];
        for (Index r = 0; r < q; ++r) value -= at(l, r) * row_of(k + r)[k + q];
        at(l, q) = value * at(inverse, k + q);
        at(sum, i) += at(l, q).abs() * at(largest, k + q);
      }
      return l;
    };
    for (Index i = k + block; i < n; i += 2)
      subtract(row_of(i), row_of(i + 1), multiples(i), multiples(i + 1), row_of(k), width, k + block, width);
  }
  for (Index k = n - block; k >= 0; k -= block) {
    for (Index q = k + block - 1; q >= k; --q) {
      Lane* row = row_of(q);
      for (Index r = q + 1; r < k + block; ++r)
        for (Index j = n; j < width; ++j) row[j] -= row[r] * row_of(r)[j];
      for (Index j = n; j < width; ++j) row[j] *= at(inverse, q);
    }
    const auto multiples = [&](Index i) {
      Multiples l;
      std::copy_n(row_of(i) + k, block, l.begin());
      return l;
    };
    for (Index i = 0; i < k; i += 2)
      subtract(row_of(i), row_of(i + 1), multiples(i), multiples(i + 1), row_of(k), width, n, width);
  }
  return growth / size;
}

// k_i + beta_i h sum_j A_ij k_j + alpha_i h^2 sum_j (A^2)_ij k_j = -beta_i v_0 - alpha_i (x_0 + c_i h v_0)
template <int stages>
struct Turn {
  Index m, num_cells;
  double h;
  MatrixXd alpha, beta;  // at the stages: row i num_cells + n, m*m columns
  VectorXd scale;
  MatrixXd cells;  // 2m x 2m num_cells

  Turn(const FourierSeries& alpha_series, const FourierSeries& beta_series, Index num_modes, Index number_of_cells)
      : m(num_modes),
        num_cells(number_of_cells),
        h(two_pi / double(num_cells)),
        alpha(at_stages<stages>(alpha_series, num_cells)),
        beta(at_stages<stages>(beta_series, num_cells)),
        scale(m),
        cells(2 * m, 2 * m * num_cells) {
    for (Index i = 0; i < m; ++i) scale(i) = std::max(1.0, std::sqrt(std::abs(alpha_series.c(i + m * i, 0).real())));
  }

  // One cell, with pivots.
  void pivoted(Index n) {
    end_if_wished();
    const auto& [c, A, A2] = radau<stages>();
    MatrixXd system(stages * m, stages * m), right(stages * m, 2 * m), alpha_i(m, m), beta_i(m, m);
    for (int i = 0; i < stages; ++i) {
      for (Index q = 0; q < m * m; ++q) {
        alpha_i(q) = alpha(i * num_cells + n, q);
        beta_i(q) = beta(i * num_cells + n, q);
      }
      for (int j = 0; j < stages; ++j)
        system.block(i * m, j * m, m, m) = h * A(i, j) * beta_i + h * h * A2(i, j) * alpha_i;
      system.block(i * m, i * m, m, m).diagonal().array() += 1;
      right.block(i * m, 0, m, m) = -alpha_i;
      right.block(i * m, m, m, m) = -beta_i - c(i) * h * alpha_i;
    }
    const MatrixXd k = dense::Lu<double>(system).solve(right);
    // Stiffly accurate: the last stage is the end of the cell.
    MatrixXd map = MatrixXd::Identity(2 * m, 2 * m);
    map.topRightCorner(m, m).diagonal().setConstant(h);
    for (int j = 0; j < stages; ++j) {
      map.topRows(m) += h * h * A2(stages - 1, j) * k.middleRows(j * m, m);
      map.bottomRows(m) += h * A(stages - 1, j) * k.middleRows(j * m, m);
    }
    map.topRows(m) = scale.asDiagonal() * map.topRows(m);
    map.leftCols(m) = map.leftCols(m) * scale.cwiseInverse().asDiagonal();
    cells.middleCols(2 * m * n, 2 * m) = map;
  }

  // All cells, four at a time; m known at compile time up to four modes.
  template <int fixed_m>
  void in_lanes() {
    constexpr int fixed_n = fixed_m == Eigen::Dynamic ? Eigen::Dynamic : stages * fixed_m;
    constexpr int fixed_r = fixed_m == Eigen::Dynamic ? Eigen::Dynamic : 2 * fixed_m;
    // Up to this growth the maps are as accurate as with pivots (random systems against 80-bit maps: medians of 0.34
    // and 0.29 epsilon of (E11) for growths of 4 to 6, 0.38 and 0.35 for 2 to 4).
    constexpr double most_growth = 8;
    const auto& [c, A, A2] = radau<stages>();
    const Index size = stages * m, width = size + 2 * m;
    std::vector<Lane, Eigen::aligned_allocator<Lane>> rows(static_cast<std::size_t>(size * width));
    const auto at = [&](Index row, Index column) -> Lane& {
      return rows[static_cast<std::size_t>(row * width + column)];
    };
    const Eigen::Matrix<double, stages, 1> for_x = h * h * A2.row(stages - 1), for_v = h * A.row(stages - 1);
    for (Index first = 0; first < num_cells; first += lanes) {
      end_if_wished();
      const auto load = [&](const MatrixXd& series, int stage, Index component) {
        return Lane(Eigen::Map<const Lane>(&series(stage * num_cells + first, component)));
      };
      for (int i = 0; i < stages; ++i)
        for (Index q = 0; q < m; ++q)
          for (Index p = 0; p < m; ++p) {
            const Lane a = h * h * load(alpha, i, p + m * q), b = h * load(beta, i, p + m * q);
            for (int j = 0; j < stages; ++j) at(i * m + p, j * m + q) = A(i, j) * b + A2(i, j) * a;
            if (p == q) at(i * m + p, i * m + p) += 1;
            at(i * m + p, size + q) = -a / (h * h);
            at(i * m + p, size + m + q) = -b / h - c(i) / h * a;
          }
      const Lane growth = eliminate<fixed_n, fixed_r>(rows.data(), size, 2 * m);
      for (Index column = 0; column < 2 * m; ++column)
        for (Index p = 0; p < m; ++p) {
          Lane x = Lane::Constant(column == p ? 1 : column == m + p ? h : 0);
          Lane v = Lane::Constant(column == m + p ? 1 : 0);
          for (int j = 0; j < stages; ++j) {
            x += for_x(j) * at(j * m + p, size + column);
            v += for_v(j) * at(j * m + p, size + column);
          }
          const double by = column < m ? 1 / scale(column) : 1;
          x *= scale(p) * by;
          v *= by;
          for (Index lane = 0; lane < lanes; ++lane) {
            cells(p, 2 * m * (first + lane) + column) = x(lane);
            cells(m + p, 2 * m * (first + lane) + column) = v(lane);
          }
        }
      for (Index lane = 0; lane < lanes; ++lane)
        if (!(growth(lane) <= most_growth && cells.middleCols(2 * m * (first + lane), 2 * m).allFinite()))
          pivoted(first + lane);
    }
  }
};

}  // namespace

// 4, 8, 12, 16, 24, 32, 48, ...
Index radau_cells(Index least) {
  Index cells = lanes;
  while (cells < least) cells *= 2;
  const Index less = cells / 4 * 3;
  return less >= least && less % lanes == 0 ? less : cells;
}

double oscillator_error(double frequency, double num_cells) { return std::pow(0.61 * frequency / num_cells, 15); }

double oscillator_cells(double frequency, double error) { return 0.61 * frequency * std::pow(error, -1.0 / 15); }

// |R(iz)| = 1 - c z^2s, c = s! (s-1)!/((2s)! (2s-1)!), z = w h: per radian c w^8 h^7 = 0.274 w (w/N)^7.
double rough_oscillator_cells(double frequency, double error) {
  return 0.8311 * frequency * std::pow(frequency / error, 1.0 / 7);
}

namespace {

template <int stages>
TurnMaps turn_maps(const FourierSeries& alpha, const FourierSeries& beta, Index num_modes, Index num_cells) {
  Turn<stages> turn(alpha, beta, num_modes, num_cells);
  if (num_modes == 1)
    turn.template in_lanes<1>();
  else if (num_modes == 2)
    turn.template in_lanes<2>();
  else if (num_modes == 3)
    turn.template in_lanes<3>();
  else if (num_modes == 4)
    turn.template in_lanes<4>();
  else if (num_modes <= most_modes_in_lanes)
    turn.template in_lanes<Eigen::Dynamic>();
  else
    for (Index n = 0; n < num_cells; ++n) turn.pivoted(n);

  MatrixXd rates = MatrixXd::Zero(2 * num_modes, 2 * num_modes);
  rates.topRightCorner(num_modes, num_modes).diagonal() = turn.scale;
  for (Index j = 0; j < num_modes; ++j)
    for (Index i = 0; i < num_modes; ++i) {
      rates(num_modes + i, j) = fourier::wiener_norm(alpha, i + num_modes * j) / turn.scale(j);
      rates(num_modes + i, num_modes + j) = fourier::wiener_norm(beta, i + num_modes * j);
    }
  rates *= turn.h;
  const MatrixXd square = rates.lazyProduct(rates);
  MatrixXd terms =
      MatrixXd::Identity(2 * num_modes, 2 * num_modes) + rates + square / 2 + square.lazyProduct(rates) / 6;
  TurnMaps maps{num_cells, std::move(turn.cells), std::move(turn.scale), std::move(terms)};
  for (Index i = 0; i < num_modes; ++i) maps.damping_trace += beta.c(i + num_modes * i, 0).real();
  maps.damping = rates.bottomRightCorner(num_modes, num_modes).rowwise().sum().maxCoeff();
  return maps;
}

}  // namespace

TurnMaps radau_turn(const FourierSeries& alpha, const FourierSeries& beta, Index num_modes, Index num_cells) {
  return turn_maps<8>(alpha, beta, num_modes, num_cells);
}

TurnMaps rough_radau_turn(const FourierSeries& alpha, const FourierSeries& beta, Index num_modes, Index num_cells) {
  return turn_maps<4>(alpha, beta, num_modes, num_cells);
}

}  // namespace hb
