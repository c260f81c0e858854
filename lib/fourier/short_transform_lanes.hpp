// Short transforms of several columns side by side: one operation serves one number of each.
#pragma once

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include "lib/fourier/butterfly.hpp"
#include "lib/fourier/short_transform.hpp"
#include "lib/lanes.hpp"

namespace hb::fourier {
namespace lanes {

using std::size_t;
constexpr size_t width = Lanes::width;

// How many columns are worth it: longer ones do not fit into the fastest memory.
inline size_t fewest(size_t N) { return N <= 128 ? width / 2 : N <= 256 ? width : static_cast<size_t>(-1); }

struct Aligned {
  void operator()(Lanes* block) const { ::operator delete (block, std::align_val_t{64}); }
};

// 4 M + 4 vectors per thread.
inline Lanes* scratch(size_t M) {
  thread_local std::unique_ptr<Lanes, Aligned> block;
  thread_local size_t size = 0;
  if (4 * M + 4 > size) {
    size = 4 * M + 4;
    block.reset(static_cast<Lanes*>(::operator new (size * sizeof(Lanes), std::align_val_t{64})));
  }
  return block.get();
}

// `count` <= width columns `apart` numbers from each other: to put(j, numbers j .. j + width - 1 of all), j < length, a
// multiple of width.
template <class Put>
void gather(const double* columns, size_t apart, size_t count, size_t length, const Put& put) {
  size_t first[width];
  for (size_t c = 0; c < width; ++c) first[c] = std::min(c, count - 1) * apart;
  Lanes block[width];
  for (size_t j = 0; j < length; j += width) {
    for (size_t c = 0; c < width; ++c) block[c] = Lanes::load(columns + first[c] + j);
    transpose(block);
    put(j, block);
  }
}

// And back, from fill(j, numbers).
template <class Fill>
void scatter(const Fill& fill, size_t length, double* columns, size_t apart, size_t count) {
  Lanes block[width];
  for (size_t j = 0; j < length; j += width) {
    fill(j, block);
    transpose(block);
    for (size_t c = 0; c < count; ++c) block[c].store(columns + c * apart + j);
  }
}

// Numbers `apart` from each other.
inline void put(const Butterfly<Lanes>& b, size_t apart, Lanes* __restrict y, Lanes* __restrict z) {
  y[0] = b.y0;
  y[apart] = b.y1;
  y[2 * apart] = b.y2;
  y[3 * apart] = b.y3;
  z[0] = b.z0;
  z[apart] = b.z1;
  z[2 * apart] = b.z2;
  z[3 * apart] = b.z3;
}

inline void radix_4(size_t m, size_t s, const Lanes* __restrict re, const Lanes* __restrict im, const double* w,
                    Lanes* __restrict y, Lanes* __restrict z) {
  const size_t far = s * m;
  for (size_t q = 0; q < s; ++q) {
    const Lanes *a = re + q, *b = im + q;
    put(butterfly(a[0], b[0], a[far], b[far], a[2 * far], b[2 * far], a[3 * far], b[3 * far]), s, y + q, z + q);
  }
  for (size_t p = 1; p < m; ++p) {
    const double c1 = w[p], c2 = w[p + m], c3 = w[p + 2 * m], s1 = w[p + 3 * m], s2 = w[p + 4 * m], s3 = w[p + 5 * m];
    for (size_t q = s * p; q < s * (p + 1); ++q) {
      const Lanes *a = re + q, *b = im + q;
      put(butterfly(a[0], b[0], a[far], b[far], a[2 * far], b[2 * far], a[3 * far], b[3 * far], c1, c2, c3, s1, s2, s3),
          s, y + 3 * s * p + q, z + 3 * s * p + q);
    }
  }
}

inline void radix_2(size_t m, size_t s, const Lanes* __restrict re, const Lanes* __restrict im, const double* w,
                    Lanes* __restrict y, Lanes* __restrict z) {
  const size_t far = s * m;
  for (size_t q = 0; q < s; ++q) {
    y[q] = re[q] + re[q + far];
    z[q] = im[q] + im[q + far];
    y[q + s] = re[q] - re[q + far];
    z[q + s] = im[q] - im[q + far];
  }
  for (size_t p = 1; p < m; ++p)
    for (size_t q = s * p; q < s * (p + 1); ++q) {
      const Lanes ur = re[q] - re[q + far], ui = im[q] - im[q + far];
      Lanes *u = y + s * p + q, *v = z + s * p + q;
      u[0] = re[q] + re[q + far];
      v[0] = im[q] + im[q + far];
      u[s] = weighted_sum(w[p], ur, w[p + m], ui);
      v[s] = weighted_difference(w[p], ui, w[p + m], ur);
    }
}

// Calls all(first column, how many) as often as is worth it, at most `width` at once; returned is how many are done.
template <class All>
std::size_t in_lanes(std::size_t N, std::size_t columns, const All& all) {
  std::size_t done = 0;
  if (N % width != 0) return done;
  while (done < columns && columns - done >= fewest(N)) {
    const std::size_t count = std::min(width, columns - done);
    all(done, count);
    done += count;
  }
  return done;
}

}  // namespace lanes

struct ShortTransform::Columns {
  static constexpr std::size_t width = lanes::width;

  const ShortTransform& of;
  std::size_t M = of.M_, N = of.N_;
  Lanes *first = lanes::scratch(M), *second = first + 2 * M + 2;

  // Of M complex numbers re, im in `from`, which is scratch from then on: to re, im of what is returned.
  const Lanes* transform(bool swapped, Lanes* from, Lanes* to) const {
    for (const Pass& pass : of.passes_) {
      const double* w = of.twiddles_.data() + pass.twiddles;
      const std::size_t m = pass.n / pass.radix, s = pass.stride;
      // Real and imaginary parts change places for the transform with the other sign.
      Lanes *re = swapped ? from + M : from, *im = swapped ? from : from + M;
      Lanes *y = swapped ? to + M : to, *z = swapped ? to : to + M;
      if (pass.radix == 4)
        lanes::radix_4(m, s, re, im, w, y, z);
      else if (pass.radix == 2)
        lanes::radix_2(m, s, re, im, w, y, z);
      else
        last_radix_3(s, re, im, y, z);
      std::swap(from, to);
    }
    return from;
  }

  // store(k, real parts, imaginary parts of all), k <= M. Harmonics k and M - k are made of the same sums: their
  // cosines of 2 pi k/N have opposite signs, their sines are equal.
  template <class Store>
  void forward(const double* samples, double factor, std::size_t count, const Store& store) const {
    lanes::gather(samples, N, count, N, [re = second, im = second + M](std::size_t j, const Lanes* f) {
      for (std::size_t i = 0; i < width; i += 2) {
        re[(j + i) / 2] = f[i];
        im[(j + i) / 2] = f[i + 1];
      }
    });
    const Lanes* x = transform(false, second, first);
    const Lanes *y = x + M, none = 0.0 * x[0];
    const double half = 0.5 * factor;
    store(0, factor * (x[0] + y[0]), none);
    for (std::size_t k = 1; k <= M / 2; ++k) {
      const Lanes odd_re = y[k] + y[M - k], odd_im = x[M - k] - x[k];
      const double c = half * of.cosines_[k], s = half * of.sines_[k];
      const Lanes even_re = half * (x[k] + x[M - k]), turned_re = weighted_sum(c, odd_re, s, odd_im);
      const Lanes even_im = half * (y[k] - y[M - k]), turned_im = weighted_difference(c, odd_im, s, odd_re);
      store(k, even_re + turned_re, even_im + turned_im);
      store(M - k, even_re - turned_re, turned_im - even_im);
    }
    store(M, factor * (x[0] - y[0]), none);
  }

  // re(k), im(k) of all, k <= M.
  template <class Real, class Imaginary>
  void backward(const Real& re, const Imaginary& im, double* samples, std::size_t count) const {
    Lanes *x = second, *y = second + M;
    x[0] = re(0) + re(M);
    y[0] = re(0) - re(M);
    for (std::size_t k = 1; k <= M / 2; ++k) {
      const Lanes a = re(k), b = im(k), d = re(M - k), e = im(M - k);
      const Lanes odd_re = a - d, odd_im = b + e;
      const double c = of.cosines_[k], s = of.sines_[k];
      const Lanes turned_re = weighted_sum(c, odd_im, s, odd_re), turned_im = weighted_difference(c, odd_re, s, odd_im);
      x[k] = (a + d) - turned_re;
      y[k] = (b - e) + turned_im;
      x[M - k] = (a + d) + turned_re;
      y[M - k] = turned_im - (b - e);
    }
    const Lanes* z = transform(true, second, first);
    lanes::scatter(
        [z, w = z + M](std::size_t j, Lanes* f) {
          for (std::size_t i = 0; i < width; i += 2) {
            f[i] = z[(j + i) / 2];
            f[i + 1] = w[(j + i) / 2];
          }
        },
        N, samples, N, count);
  }

  // Spectra one after the other.
  void forward(const double* samples, double* spectrum, double factor, std::size_t count) const {
    const std::size_t apart = N + 2;
    Lanes* out = of.passes_.size() % 2 != 0 ? second : first;  // where the transform does not end
    forward(samples, factor, count, [&](std::size_t k, Lanes re, Lanes im) {
      out[2 * k] = re;
      out[2 * k + 1] = im;
    });
    lanes::scatter([out](std::size_t j, Lanes* f) { std::copy_n(out + j, width, f); }, N, spectrum, apart, count);
    double last[width];
    out[N].store(last);
    for (std::size_t c = 0; c < count; ++c) {
      spectrum[c * apart + 1] = 0;
      spectrum[c * apart + N] = last[c];
      spectrum[c * apart + N + 1] = 0;
    }
  }

  void backward(const double* spectrum, double* samples, std::size_t count) const {
    const std::size_t apart = N + 2;
    lanes::gather(spectrum, apart, count, N,
                  [to = first](std::size_t j, const Lanes* f) { std::copy_n(f, width, to + j); });
    double last[width];
    for (std::size_t c = 0; c < width; ++c) last[c] = spectrum[std::min(c, count - 1) * apart + N];
    first[N] = Lanes::load(last);
    backward([&](std::size_t k) { return first[2 * k]; }, [&](std::size_t k) { return first[2 * k + 1]; }, samples,
             count);
  }
};

}  // namespace hb::fourier
