#include "hb/engine/exponents/slaving_pairs.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <complex>

#include "hb/engine/exponents/neighbouring_numbers.hpp"
#include "lib/workspace.hpp"

namespace hb::slaving {

using Eigen::Index;

namespace {

// Complex numbers of several pairs.
template <class V>
struct Complex {
  V re, im;
};

// 2 x 2: A and C by the two equations.
template <class V>
using Block = std::array<Complex<V>, 4>;  // row after row

constexpr Index entries = 8;

// z +- a b
template <class V>
[[gnu::always_inline]] inline void add(Complex<V>& z, const Complex<V>& a, const Complex<V>& b) {
  z.re += a.re * b.re;
  z.re -= a.im * b.im;
  z.im += a.re * b.im;
  z.im += a.im * b.re;
}
template <class V>
[[gnu::always_inline]] inline void subtract(Complex<V>& z, const Complex<V>& a, const Complex<V>& b) {
  z.re -= a.re * b.re;
  z.re += a.im * b.im;
  z.im -= a.re * b.im;
  z.im -= a.im * b.re;
}
template <class V>
[[gnu::always_inline]] inline Complex<V> product(const Complex<V>& a, const Complex<V>& b) {
  Complex<V> z{V::Zero(), V::Zero()};
  add(z, a, b);
  return z;
}

template <int width>
[[gnu::always_inline]] inline Complex<Numbers<width>> load(const double* p, Index to_im) {
  return {at<width>(p), at<width>(p + to_im)};
}
template <int width>
[[gnu::always_inline]] inline void store(const Complex<Numbers<width>>& z, double* p, Index to_im) {
  at<width>(p) = z.re;
  at<width>(p + to_im) = z.im;
}
template <int width>
[[gnu::always_inline]] inline Complex<Numbers<width>> entry(const double* block, Index of_four) {
  return load<width>(block + 2 * width * of_four, width);
}

// x, y -= B (a, c), or +=.
template <int width, bool plus>
[[gnu::always_inline]] inline void apply(const double* B, const double* from, Complex<Numbers<width>>& x,
                                         Complex<Numbers<width>>& y) {
  const auto a = load<width>(from, width), c = load<width>(from + 2 * width, width);
  if constexpr (plus) {
    add(x, entry<width>(B, 0), a), add(x, entry<width>(B, 1), c);
    add(y, entry<width>(B, 2), a), add(y, entry<width>(B, 3), c);
  } else {
    subtract(x, entry<width>(B, 0), a), subtract(x, entry<width>(B, 1), c);
    subtract(y, entry<width>(B, 2), a), subtract(y, entry<width>(B, 3), c);
  }
}

template <int width>
void invert(double* B) {
  using V = Numbers<width>;
  const auto a = entry<width>(B, 0), b = entry<width>(B, 1), c = entry<width>(B, 2), d = entry<width>(B, 3);
  Complex<V> determinant = product(a, d);
  subtract(determinant, b, c);
  const V size = determinant.re * determinant.re + determinant.im * determinant.im;
  const Complex<V> by{determinant.re / size, -determinant.im / size}, minus{-by.re, -by.im};
  store<width>(product(d, by), B, width);
  store<width>(product(b, minus), B + 2 * width, width);
  store<width>(product(c, minus), B + 4 * width, width);
  store<width>(product(a, by), B + 6 * width, width);
}

// L <- L P
template <int width>
void multiply_by(double* L, const double* P) {
  for (Index row = 0; row < 2; ++row) {
    double* const l = L + 4 * width * row;
    const auto x = load<width>(l, width), y = load<width>(l + 2 * width, width);
    auto first = product(x, entry<width>(P, 0)), second = product(x, entry<width>(P, 1));
    add(first, y, entry<width>(P, 2));
    add(second, y, entry<width>(P, 3));
    store<width>(first, l, width);
    store<width>(second, l + 2 * width, width);
  }
}

// B <- B - L U
template <int width>
void subtract_product(double* B, const double* L, const double* U) {
  for (Index column = 0; column < 2; ++column) {
    const auto above = entry<width>(U, column), below = entry<width>(U, 2 + column);
    for (Index row = 0; row < 2; ++row) {
      double* const b = B + 2 * width * (2 * row + column);
      auto z = load<width>(b, width);
      subtract(z, entry<width>(L, 2 * row), above);
      subtract(z, entry<width>(L, 2 * row + 1), below);
      store<width>(z, b, width);
    }
  }
}

}  // namespace

PairInverse::PairInverse(Index num_pairs, Index H)
    : pairs_(num_pairs), H_(H), central_(std::size_t(central * central * num_pairs)) {
  thread_local Workspace kept;
  blocks_ = kept.matrix(entries * (2 * band + 1) * (H + 1), num_pairs).data();
}

// How harmonic k + away stands in the equations of harmonic k.
double* PairInverse::block(Index first, Index width, Index k, Index away) const {
  return blocks_ + entries * ((2 * band + 1) * ((H_ + 1) * first + width * k) + width * (band + away));
}

void PairInverse::factorise(const Equations& of) {
  in_groups(pairs_, [&]<int width>(std::integral_constant<int, width>, Index first) { factorise<width>(of, first); });
}

void PairInverse::solve(const Residuals& of, const double* weight, double* step) const {
  in_groups(pairs_,
            [&]<int width>(std::integral_constant<int, width>, Index first) { solve<width>(of, weight, step, first); });
}

// (E27): with mu_m = K_jj,m - alpha_m and the dampings g of the fast mode, b of the slow one, harmonic k - m of (A, C)
// stands in the equations of harmonic k with
//     [ mu_m   -alpha_m (g - b + i (2k - m)) ]
//     [   0                mu_m              ],  m <> 0,
//     [ mu_0 - k^2 + ikg           -alpha_0 (g - b + 2ik)          ]
//     [   g - b + 2ik    mu_0 - k^2 - b (g - b) + ik (g - 2b) ],  m = 0.
// With z_-k = conj z_k what stands at harmonics k >= band is eliminated from the highest on, what stands at -k as its
// mirror image; harmonics 0 .. band - 1 are left.
template <int width>
void PairInverse::factorise(const Equations& of, Index first) {
  using V = Numbers<width>;
  using Z = Complex<V>;
  const V g = at<width>(&of.fast_damping(first)), b = at<width>(&of.slow_damping(first)), g_b = g - b;
  const auto harmonic = [first](const Eigen::MatrixXd& f, Index m) {
    return Z{at<width>(&f(first, m)), at<width>(&f(first, band + 1 + m))};
  };
  std::array<Z, 2 * band + 1> alpha, mu;  // of harmonic m at band + m
  for (Index m = 0; m <= band; ++m) {
    const Z slow = harmonic(of.slow, m), fast = harmonic(of.fast, m), difference{fast.re - slow.re, fast.im - slow.im};
    alpha[std::size_t(band + m)] = slow, alpha[std::size_t(band - m)] = {slow.re, -slow.im};
    mu[std::size_t(band + m)] = difference, mu[std::size_t(band - m)] = {difference.re, -difference.im};
  }
  const Z none{V::Zero(), V::Zero()};
  for (Index k = 0; k <= H_; ++k) {
    const double n = double(k);
    for (Index m = -band; m <= band; ++m) {  // of z_(k - m)
      const Z &alpha_m = alpha[std::size_t(band + m)], &mu_m = mu[std::size_t(band + m)];
      const Z upper_right = product(alpha_m, Z{-g_b, V::Constant(double(m) - 2 * n)});
      Block<V> B{mu_m, upper_right, none, mu_m};
      if (m == 0) {
        B[0] = {mu_m.re - n * n, n * g};
        B[2] = {g_b, V::Constant(2 * n)};
        B[3] = {mu_m.re - n * n - b * g_b, n * (g - 2 * b)};
      }
      for (Index e = 0; e < 4; ++e) store<width>(B[std::size_t(e)], block(first, width, k, -m) + 2 * width * e, width);
    }
  }
  std::array<V, 4> mean;
  for (Index e = 0; e < 4; ++e) mean[std::size_t(e)] = entry<width>(block(first, width, 0, 0), e).re;
  for (Index k = H_; k >= band; --k) {
    invert<width>(block(first, width, k, 0));
    for (Index i = 1; i <= band; ++i) {
      multiply_by<width>(block(first, width, k - i, i), block(first, width, k, 0));
      for (Index m = 1; m <= band; ++m)
        subtract_product<width>(block(first, width, k - i, i - m), block(first, width, k - i, i),
                                block(first, width, k, -m));
    }
  }
  // Real unknowns A_0, C_0, then real and imaginary part of A_k, then of C_k.
  for (Index lane = 0; lane < width; ++lane) {
    Eigen::Matrix<double, central, central> M = Eigen::Matrix<double, central, central>::Zero();
    const auto of_lane = [&](Index k, Index away, Index row, Index column) {
      const double* p = block(first, width, k, away) + width * 2 * (2 * row + column) + lane;
      return std::complex<double>(p[0], p[width]);
    };
    const auto place = [](Index k, Index of_two) { return k == 0 ? of_two : 4 * k - 2 + 2 * of_two; };
    for (Index row = 0; row < 2; ++row)
      for (Index column = 0; column < 2; ++column) {
        M(row, column) = 2 * of_lane(0, 0, row, column).real() - mean[std::size_t(2 * row + column)](lane);
        for (Index c = 1; c < band; ++c) {
          const std::complex<double> z = of_lane(0, c, row, column);
          M(row, place(c, column)) = 2 * z.real();
          M(row, place(c, column) + 1) = -2 * z.imag();
        }
        for (Index k = 1; k < band; ++k) {
          const Index to = place(k, row);
          const std::complex<double> at_0 = of_lane(k, -k, row, column);
          M(to, column) = at_0.real();
          M(to + 1, column) = at_0.imag();
          for (Index c = 1; c < band; ++c) {
            const std::complex<double> z = of_lane(k, c - k, row, column);
            const std::complex<double> mirrored = k + c <= band ? of_lane(k, -c - k, row, column) : 0;
            M(to, place(c, column)) = z.real() + mirrored.real();
            M(to, place(c, column) + 1) = mirrored.imag() - z.imag();
            M(to + 1, place(c, column)) = z.imag() + mirrored.imag();
            M(to + 1, place(c, column) + 1) = z.real() - mirrored.real();
          }
        }
      }
    const Eigen::Matrix<double, central, central> inverse = M.inverse();
    for (Index i = 0; i < central; ++i)
      for (Index j = 0; j < central; ++j)
        central_[std::size_t(central * (central * first + width * i) + width * j + lane)] = inverse(i, j);
  }
}

template <int width>
void PairInverse::solve(const Residuals& of, const double* weight, double* step, Index first) const {
  using V = Numbers<width>;
  using Z = Complex<V>;
  thread_local Workspace kept;
  double* const z = kept.matrix(4 * width, H_ + 1).data();  // A and C, real and imaginary part of each, by harmonics
  const auto at_harmonic = [z](Index k) { return z + 4 * width * k; };
  V a_0 = V::Zero(), c_0 = a_0;
  for (Index k = H_; k >= 0; --k) {
    const double *re = of.re + of.stride * k + first, *im = of.im + of.stride * k + first;
    Z a{at<width>(re), at<width>(im)}, c{at<width>(re + pairs_), at<width>(im + pairs_)};
    if (k == 0) a_0 = a.re, c_0 = c.re;
    for (Index i = std::max<Index>(1, band - k); i <= std::min(band, H_ - k); ++i)
      apply<width, false>(block(first, width, k, i), at_harmonic(k + i), a, c);
    store<width>(a, at_harmonic(k), width);
    store<width>(c, at_harmonic(k) + 2 * width, width);
  }
  // Where the central unknowns stand: all real parts but the imaginary ones of harmonic 0.
  const auto number = [z](Index unknown) { return z + width * (unknown < 2 ? 2 * unknown : unknown + 2); };
  std::array<V, central> right;
  for (Index i = 0; i < central; ++i) right[std::size_t(i)] = at<width>(number(i));
  right[0] = 2 * right[0] - a_0;
  right[1] = 2 * right[1] - c_0;
  const double* inverse = central_.data() + central * central * first;
  for (Index i = 0; i < central; ++i) {
    V sum = V::Zero();
    for (Index j = 0; j < central; ++j, inverse += width) sum += at<width>(inverse) * right[std::size_t(j)];
    at<width>(number(i)) = sum;
  }
  at<width>(z + width).setZero();
  at<width>(z + 3 * width).setZero();
  const V by = at<width>(weight + first);
  for (Index k = 0; k <= H_; ++k) {
    double* const here = at_harmonic(k);
    Z x = load<width>(here, width), y = load<width>(here + 2 * width, width);
    if (k >= band) {
      for (Index m = 1; m <= band; ++m) apply<width, false>(block(first, width, k, -m), at_harmonic(k - m), x, y);
      store<width>(x, here, width);
      store<width>(y, here + 2 * width, width);
      x = y = {V::Zero(), V::Zero()};
      apply<width, true>(block(first, width, k, 0), here, x, y);
      store<width>(x, here, width);
      store<width>(y, here + 2 * width, width);
    }
    double* const to = step + 4 * pairs_ * k + first;
    at<width>(to) = -x.re;
    at<width>(to + pairs_) = -by * y.re;
    at<width>(to + 2 * pairs_) = -x.im;
    at<width>(to + 3 * pairs_) = -by * y.im;
  }
}

}  // namespace hb::slaving
