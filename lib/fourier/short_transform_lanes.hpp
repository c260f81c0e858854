// Short transforms of several columns side by side: one operation serves one number of each.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include "lib/fourier/butterfly.hpp"
#include "lib/fourier/short_transform.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // of vector types as arguments of templates

namespace hb::fourier {
namespace lanes {

using std::size_t;
using Vector = Eigen::internal::packet_traits<double>::type;
constexpr size_t width = Eigen::internal::packet_traits<double>::size;
using Block = Eigen::internal::PacketBlock<Vector, static_cast<int>(width)>;

// How many columns are worth it: longer ones do not fit into the fastest memory.
inline size_t fewest(size_t N) { return N <= 128 ? width / 2 : N <= 256 ? width : static_cast<size_t>(-1); }

struct Aligned {
  void operator()(Vector* block) const { ::operator delete (block, std::align_val_t{64}); }
};

// 4 M + 4 vectors per thread.
inline Vector* scratch(size_t M) {
  thread_local std::unique_ptr<Vector, Aligned> block;
  thread_local size_t size = 0;
  if (4 * M + 4 > size) {
    size = 4 * M + 4;
    block.reset(static_cast<Vector*>(::operator new (size * sizeof(Vector), std::align_val_t{64})));
  }
  return block.get();
}

// `count` <= width columns `apart` numbers from each other: to put(j, numbers j of all), j < length, a multiple of
// width.
template <class Put>
void gather(const double* columns, size_t apart, size_t count, size_t length, const Put& put) {
  Block block;
  for (size_t j = 0; j < length; j += width) {
    for (size_t c = 0; c < width; ++c)
      block.packet[c] = Eigen::internal::ploadu<Vector>(columns + std::min(c, count - 1) * apart + j);
    Eigen::internal::ptranspose(block);
    for (size_t i = 0; i < width; ++i) put(j + i, block.packet[i]);
  }
}

// And back, from in(j).
template <class Numbers>
void scatter(const Numbers& in, size_t length, double* columns, size_t apart, size_t count) {
  Block block;
  for (size_t j = 0; j < length; j += width) {
    for (size_t i = 0; i < width; ++i) block.packet[i] = in(j + i);
    Eigen::internal::ptranspose(block);
    for (size_t c = 0; c < count; ++c) Eigen::internal::pstoreu(columns + c * apart + j, block.packet[c]);
  }
}

inline void radix_4(size_t m, size_t s, const Vector* re, const Vector* im, const double* w, Vector* y, Vector* z) {
  const size_t far = s * m;
  for (size_t p = 0; p < m; ++p) {
    const double c1 = w[p], c2 = w[p + m], c3 = w[p + 2 * m], s1 = w[p + 3 * m], s2 = w[p + 4 * m], s3 = w[p + 5 * m];
    for (size_t q = 0; q < s; ++q) {
      const Vector *a = re + s * p + q, *b = im + s * p + q;
      const Butterfly<Vector> to =
          butterfly(a[0], b[0], a[far], b[far], a[2 * far], b[2 * far], a[3 * far], b[3 * far], c1, c2, c3, s1, s2, s3);
      Vector *u = y + 4 * s * p + q, *v = z + 4 * s * p + q;
      u[0] = to.y0;
      v[0] = to.z0;
      u[s] = to.y1;
      v[s] = to.z1;
      u[2 * s] = to.y2;
      v[2 * s] = to.z2;
      u[3 * s] = to.y3;
      v[3 * s] = to.z3;
    }
  }
}

inline void radix_2(size_t m, size_t s, const Vector* re, const Vector* im, const double* w, Vector* y, Vector* z) {
  const size_t far = s * m;
  for (size_t p = 0; p < m; ++p)
    for (size_t q = 0; q < s; ++q) {
      const Vector *a = re + s * p + q, *b = im + s * p + q;
      const Vector ur = a[0] - a[far], ui = b[0] - b[far];
      Vector *u = y + 2 * s * p + q, *v = z + 2 * s * p + q;
      u[0] = a[0] + a[far];
      v[0] = b[0] + b[far];
      u[s] = w[p] * ur + w[p + m] * ui;
      v[s] = w[p] * ui - w[p + m] * ur;
    }
}

inline Vector load(const double* numbers) { return Eigen::internal::ploadu<Vector>(numbers); }
inline void store(double* numbers, Vector v) { Eigen::internal::pstoreu(numbers, v); }

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

struct ShortTransform::Lanes {
  using Vector = lanes::Vector;
  static constexpr std::size_t width = lanes::width;

  const ShortTransform& of;
  std::size_t M = of.M_, N = of.N_;
  Vector *first = lanes::scratch(M), *second = first + 2 * M + 2;

  // Of M complex numbers re, im in `from`, which is scratch from then on: to re, im of what is returned.
  const Vector* transform(bool swapped, Vector* from, Vector* to) const {
    for (const Pass& pass : of.passes_) {
      const double* w = of.twiddles_.data() + pass.twiddles;
      const std::size_t m = pass.n / pass.radix, s = pass.stride;
      // Real and imaginary parts change places for the transform with the other sign.
      Vector *re = swapped ? from + M : from, *im = swapped ? from : from + M;
      Vector *y = swapped ? to + M : to, *z = swapped ? to : to + M;
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

  // store(k, real parts, imaginary parts of all), k <= M.
  template <class Store>
  void forward(const double* samples, double factor, std::size_t count, const Store& store) const {
    lanes::gather(samples, N, count, N, [&](std::size_t j, Vector f) { second[j % 2 * M + j / 2] = f; });
    const Vector* x = transform(false, second, first);
    const Vector *y = x + M, none = 0.0 * x[0];
    const double half = 0.5 * factor;
    store(0, factor * (x[0] + y[0]), none);
    for (std::size_t k = 1; k < M; ++k) {
      const Vector odd_re = y[k] + y[M - k], odd_im = x[M - k] - x[k];
      const double c = half * of.cosines_[k], s = half * of.sines_[k];
      store(k, half * (x[k] + x[M - k]) + (c * odd_re + s * odd_im),
            half * (y[k] - y[M - k]) + (c * odd_im - s * odd_re));
    }
    store(M, factor * (x[0] - y[0]), none);
  }

  // re(k), im(k) of all, k <= M.
  template <class Real, class Imaginary>
  void backward(const Real& re, const Imaginary& im, double* samples, std::size_t count) const {
    Vector *x = second, *y = second + M;
    x[0] = re(0) + re(M);
    y[0] = re(0) - re(M);
    for (std::size_t k = 1; k < M; ++k) {
      const Vector a = re(k), b = im(k), d = re(M - k), e = im(M - k);
      const Vector odd_re = a - d, odd_im = b + e;
      const double c = of.cosines_[k], s = of.sines_[k];
      x[k] = (a + d) - (c * odd_im + s * odd_re);
      y[k] = (b - e) + (c * odd_re - s * odd_im);
    }
    const Vector* z = transform(true, second, first);
    lanes::scatter([&](std::size_t place) { return z[place % 2 * M + place / 2]; }, N, samples, N, count);
  }

  // Spectra one after the other.
  void forward(const double* samples, double* spectrum, double factor, std::size_t count) const {
    const std::size_t apart = N + 2;
    Vector* out = of.passes_.size() % 2 != 0 ? second : first;  // where the transform does not end
    forward(samples, factor, count, [&](std::size_t k, Vector re, Vector im) {
      out[2 * k] = re;
      out[2 * k + 1] = im;
    });
    lanes::scatter([&](std::size_t place) { return out[place]; }, N, spectrum, apart, count);
    double last[width];
    Eigen::internal::pstoreu(last, out[N]);
    for (std::size_t c = 0; c < count; ++c) {
      spectrum[c * apart + 1] = 0;
      spectrum[c * apart + N] = last[c];
      spectrum[c * apart + N + 1] = 0;
    }
  }

  void backward(const double* spectrum, double* samples, std::size_t count) const {
    const std::size_t apart = N + 2;
    lanes::gather(spectrum, apart, count, N, [&](std::size_t j, Vector c) { first[j] = c; });
    double last[width];
    for (std::size_t c = 0; c < width; ++c) last[c] = spectrum[std::min(c, count - 1) * apart + N];
    first[N] = Eigen::internal::ploadu<Vector>(last);
    backward([&](std::size_t k) { return first[2 * k]; }, [&](std::size_t k) { return first[2 * k + 1]; }, samples,
             count);
  }
};

}  // namespace hb::fourier

#pragma GCC diagnostic pop
