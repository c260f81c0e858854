// Butterflies of radix 4 and 3, decimation in frequency, in split form; V: a number or numbers of several columns side
// by side.
#pragma once

#include <cstddef>
#include <numbers>

namespace hb::fourier {

// a x + b y and a x - b y: the first product is made first, of numbers and of columns, so that both round alike.
template <class V>
inline V weighted_sum(double a, const V& x, double b, const V& y) {
  const V first = a * x;
  const V second = b * y;
  return first + second;
}
template <class V>
inline V weighted_difference(double a, const V& x, double b, const V& y) {
  const V first = a * x;
  const V second = b * y;
  return first - second;
}

// The four outputs.
template <class V>
struct Butterfly {
  V y0, z0, y1, z1, y2, z2, y3, z3;
};

// c, s: cosines and sines of the three twiddles.
template <class V>
inline Butterfly<V> butterfly(V ar, V ai, V br, V bi, V cr, V ci, V dr, V di, double c1, double c2, double c3,
                              double s1, double s2, double s3) {
  const V pr = ar + cr, pi = ai + ci, qr = ar - cr, qi = ai - ci;
  const V rr = br + dr, ri = bi + di, tr = br - dr, ti = bi - di;
  const V ur = qr + ti, ui = qi - tr, vr = pr - rr, vi = pi - ri, xr = qr - ti, xi = qi + tr;
  return {pr + rr,
          pi + ri,
          weighted_sum(c1, ur, s1, ui),
          weighted_difference(c1, ui, s1, ur),
          weighted_sum(c2, vr, s2, vi),
          weighted_difference(c2, vi, s2, vr),
          weighted_sum(c3, xr, s3, xi),
          weighted_difference(c3, xi, s3, xr)};
}

// With all twiddles 1.
template <class V>
inline Butterfly<V> butterfly(V ar, V ai, V br, V bi, V cr, V ci, V dr, V di) {
  const V pr = ar + cr, pi = ai + ci, qr = ar - cr, qi = ai - ci;
  const V rr = br + dr, ri = bi + di, tr = br - dr, ti = bi - di;
  return {pr + rr, pi + ri, qr + ti, qi - tr, pr - rr, pi - ri, qr - ti, qi + tr};
}

// The last pass: no twiddles are left. From s numbers each at 0, s, 2 s of `re`, `im` to those of `y`, `z`.
template <class In, class Out>
inline void last_radix_3(std::size_t s, In re, In im, Out y, Out z) {
  constexpr double half_root_3 = std::numbers::sqrt3 / 2;
  for (std::size_t q = 0; q < s; ++q) {
    const auto sr = re[q + s] + re[q + 2 * s], si = im[q + s] + im[q + 2 * s];
    const auto dr = half_root_3 * (re[q + s] - re[q + 2 * s]), di = half_root_3 * (im[q + s] - im[q + 2 * s]);
    const auto mr = re[q] - 0.5 * sr, mi = im[q] - 0.5 * si;
    y[q] = re[q] + sr;
    z[q] = im[q] + si;
    y[q + s] = mr + di;
    z[q + s] = mi - dr;
    y[q + 2 * s] = mr - di;
    z[q + 2 * s] = mi + dr;
  }
}

}  // namespace hb::fourier
