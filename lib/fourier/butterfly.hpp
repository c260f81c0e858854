// Radix-4 butterfly, decimation in frequency, in split form; V: a number or numbers of several columns side by side.
#pragma once

namespace hb::fourier {

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
  return {pr + rr,           pi + ri,           c1 * ur + s1 * ui, c1 * ui - s1 * ur,
          c2 * vr + s2 * vi, c2 * vi - s2 * vr, c3 * xr + s3 * xi, c3 * xi - s3 * xr};
}

}  // namespace hb::fourier
