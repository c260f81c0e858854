#include "lib/fourier/short_transform.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <numbers>
#include <utility>

#include "lib/fourier/butterfly.hpp"
#include "lib/fourier/short_transform_lanes.hpp"

namespace hb::fourier {
namespace {

using std::size_t;

constexpr size_t shortest = 8, longest = 4096;

// e^{2 pi i k/N}: of the first eighth of the turn, the rest by symmetry, so that each is right to its last digit.
std::complex<double> on_circle(size_t k, size_t N) {
  k %= N;
  const auto eighth = [N](size_t j) {
    const double angle = 2 * std::numbers::pi * (static_cast<double>(j) / static_cast<double>(N));
    return std::complex<double>(std::cos(angle), std::sin(angle));
  };
  if (2 * k > N) return std::conj(on_circle(N - k, N));
  if (4 * k > N) {
    const std::complex<double> z = on_circle(N / 2 - k, N);
    return {-z.real(), z.imag()};
  }
  if (8 * k <= N) return eighth(k);
  const std::complex<double> z = eighth(N / 4 - k);
  return {z.imag(), z.real()};
}

// Four real arrays in one aligned block per thread.
class Scratch {
 public:
  double* at(size_t M) {
    if (4 * M > size_) {
      block_.reset(static_cast<double*>(::operator new(4 * M * sizeof(double), alignment)));
      size_ = 4 * M;
    }
    return block_.get();
  }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Free {
    void operator()(double* block) const { ::operator delete(block, alignment); }
  };
  std::unique_ptr<double, Free> block_;
  size_t size_ = 0;
};

double* scratch(size_t M) {
  thread_local Scratch block;
  return block.at(M);
}

// Pointers of different arrays: the compiler may take several neighbours at once.
using In = const double* __restrict;
using Out = double* __restrict;

// Stride 1: places p of the sub-transforms are neighbours.
void first_radix_4(size_t m, In re, In im, In w, Out y, Out z) {
  for (size_t p = 0; p < m; ++p) {
    const Butterfly<double> b =
        butterfly(re[p], im[p], re[p + m], im[p + m], re[p + 2 * m], im[p + 2 * m], re[p + 3 * m], im[p + 3 * m], w[p],
                  w[p + m], w[p + 2 * m], w[p + 3 * m], w[p + 4 * m], w[p + 5 * m]);
    y[4 * p] = b.y0;
    y[4 * p + 1] = b.y1;
    y[4 * p + 2] = b.y2;
    y[4 * p + 3] = b.y3;
    z[4 * p] = b.z0;
    z[4 * p + 1] = b.z1;
    z[4 * p + 2] = b.z2;
    z[4 * p + 3] = b.z3;
  }
}

template <class Length>
inline void radix_4_at(Length s, size_t far, In re, In im, const double (&w)[6], Out y, Out z) {
  for (size_t q = 0; q < s; ++q) {
    const Butterfly<double> b = butterfly(re[q], im[q], re[q + far], im[q + far], re[q + 2 * far], im[q + 2 * far],
                                          re[q + 3 * far], im[q + 3 * far], w[0], w[1], w[2], w[3], w[4], w[5]);
    y[q] = b.y0;
    y[q + s] = b.y1;
    y[q + 2 * s] = b.y2;
    y[q + 3 * s] = b.y3;
    z[q] = b.z0;
    z[q + s] = b.z1;
    z[q + 2 * s] = b.z2;
    z[q + 3 * s] = b.z3;
  }
}

// A stride that is a multiple of 4, known at compile time or not.
template <class Length>
void radix_4(size_t m, Length s, In re, In im, In w, Out y, Out z) {
  for (size_t p = 0; p < m; ++p) {
    const double here[6] = {w[p], w[p + m], w[p + 2 * m], w[p + 3 * m], w[p + 4 * m], w[p + 5 * m]};
    radix_4_at(s, s * m, re + s * p, im + s * p, here, y + 4 * s * p, z + 4 * s * p);
  }
}

void radix_2_at(size_t s, size_t far, In re, In im, double c, double sine, Out y, Out z) {
  for (size_t q = 0; q < s; ++q) {
    const double ur = re[q] - re[q + far], ui = im[q] - im[q + far];
    y[q] = re[q] + re[q + far];
    z[q] = im[q] + im[q + far];
    y[q + s] = c * ur + sine * ui;
    z[q + s] = c * ui - sine * ur;
  }
}

void radix_2(size_t m, size_t s, In re, In im, In w, Out y, Out z) {
  for (size_t p = 0; p < m; ++p)
    radix_2_at(s, s * m, re + s * p, im + s * p, w[p], w[p + m], y + 2 * s * p, z + 2 * s * p);
}

// Even and odd places apart, and back.
void split(size_t M, In samples, Out re, Out im) {
  for (size_t j = 0; j < M; ++j) {
    re[j] = samples[2 * j];
    im[j] = samples[2 * j + 1];
  }
}

void join(size_t M, In re, In im, Out samples) {
  for (size_t j = 0; j < M; ++j) {
    samples[2 * j] = re[j];
    samples[2 * j + 1] = im[j];
  }
}

void from_halves(size_t M, double half, In x, In y, In c, In s, Out out) {
  for (size_t k = 1; k < M; ++k) {
    const double sum_re = x[k] + x[M - k], sum_im = y[k] - y[M - k];
    const double odd_re = y[k] + y[M - k], odd_im = x[M - k] - x[k];
    out[2 * k] = half * (sum_re + (c[k] * odd_re + s[k] * odd_im));
    out[2 * k + 1] = half * (sum_im + (c[k] * odd_im - s[k] * odd_re));
  }
}

void to_halves(size_t M, In in, In c, In s, Out x, Out y) {
  for (size_t k = 1; k < M; ++k) {
    const double a = in[2 * k], b = in[2 * k + 1], d = in[2 * (M - k)], e = in[2 * (M - k) + 1];
    const double odd_re = a - d, odd_im = b + e;
    x[k] = (a + d) - (c[k] * odd_im + s[k] * odd_re);
    y[k] = (b - e) + (c[k] * odd_re - s[k] * odd_im);
  }
}

}  // namespace

bool ShortTransform::serves(size_t num_samples) {
  const size_t power = num_samples % 3 == 0 ? num_samples / 3 : num_samples;
  return num_samples >= shortest && num_samples <= longest && std::has_single_bit(power) && num_samples % 2 == 0;
}

ShortTransform::ShortTransform(size_t num_samples) : N_(num_samples), M_(num_samples / 2) {
  std::vector<std::complex<double>> circle(N_);
  for (size_t k = 0; k < N_; ++k) circle[k] = on_circle(k, N_);
  for (size_t k = 0; k <= M_; ++k) {
    cosines_.push_back(circle[k].real());
    sines_.push_back(circle[k].imag());
  }
  for (size_t n = M_; n > 1;) {
    const size_t radix = n % 4 == 0 ? 4 : n % 2 == 0 ? 2 : 3;
    passes_.push_back({n, radix, M_ / n, twiddles_.size()});
    const size_t m = n / radix;
    for (const bool sine : {false, true})
      for (size_t power = 1; power < radix; ++power)
        for (size_t p = 0; p < m; ++p) {
          const std::complex<double> z = circle[power * p * (N_ / n) % N_];
          twiddles_.push_back(sine ? z.imag() : z.real());
        }
    n = m;
  }
}

const ShortTransform* ShortTransform::of_length(size_t num_samples) {
  if (!serves(num_samples)) return nullptr;
  static std::map<size_t, ShortTransform> made;
  static std::mutex making;
  const std::lock_guard lock(making);
  return &made.try_emplace(num_samples, num_samples).first->second;
}

// Stockham's autosort transform, decimation in frequency.
void ShortTransform::transform(double*& re, double*& im, double*& other_re, double*& other_im) const {
  for (const Pass& pass : passes_) {
    const double* w = twiddles_.data() + pass.twiddles;
    const size_t m = pass.n / pass.radix, s = pass.stride;
    if (pass.radix == 4 && s == 1)
      first_radix_4(m, re, im, w, other_re, other_im);
    else if (pass.radix == 4 && s == 4)
      radix_4(m, std::integral_constant<size_t, 4>(), re, im, w, other_re, other_im);
    else if (pass.radix == 4)
      radix_4(m, s, re, im, w, other_re, other_im);
    else if (pass.radix == 2)
      radix_2(m, s, re, im, w, other_re, other_im);
    else
      last_radix_3(s, re, im, other_re, other_im);
    std::swap(re, other_re);
    std::swap(im, other_im);
  }
}

// Of z_j = f_2j + i f_2j+1, j < M, the transform Z gives those of even and odd samples,
//     c_k = (Z_k + conj Z_{M-k})/2 - i e^{-2 pi i k/N} (Z_k - conj Z_{M-k})/2.
void ShortTransform::forward(const double* samples, std::complex<double>* spectrum, double factor) const {
  const size_t M = M_;
  double* block = scratch(M);
  double *re = block, *im = block + M, *other_re = block + 2 * M, *other_im = block + 3 * M;
  split(M, samples, re, im);
  transform(re, im, other_re, other_im);
  double* out = reinterpret_cast<double*>(spectrum);
  from_halves(M, 0.5 * factor, re, im, cosines_.data(), sines_.data(), out);
  out[0] = factor * (re[0] + im[0]);
  out[2 * M] = factor * (re[0] - im[0]);
  out[1] = out[2 * M + 1] = 0;
}

// Z_k = (c_k + conj c_{M-k}) + i e^{2 pi i k/N} (c_k - conj c_{M-k}); real and imaginary parts change places for the
// transform with the other sign.
void ShortTransform::backward(const std::complex<double>* spectrum, double* samples) const {
  const size_t M = M_;
  double* block = scratch(M);
  double *re = block, *im = block + M, *other_re = block + 2 * M, *other_im = block + 3 * M;
  const double* in = reinterpret_cast<const double*>(spectrum);
  to_halves(M, in, cosines_.data(), sines_.data(), re, im);
  re[0] = in[0] + in[2 * M];
  im[0] = in[0] - in[2 * M];
  transform(im, re, other_im, other_re);
  join(M, re, im, samples);
}

void ShortTransform::forward(const double* samples, std::complex<double>* spectrum, double factor,
                             std::size_t columns) const {
  std::size_t c = lanes::in_lanes(N_, columns, [&](std::size_t first, std::size_t count) {
    Columns{*this}.forward(samples + first * N_, reinterpret_cast<double*>(spectrum + first * (M_ + 1)), factor, count);
  });
  for (; c < columns; ++c) forward(samples + c * N_, spectrum + c * (M_ + 1), factor);
}

void ShortTransform::backward(const std::complex<double>* spectrum, double* samples, std::size_t columns) const {
  std::size_t c = lanes::in_lanes(N_, columns, [&](std::size_t first, std::size_t count) {
    Columns{*this}.backward(reinterpret_cast<const double*>(spectrum + first * (M_ + 1)), samples + first * N_, count);
  });
  for (; c < columns; ++c) backward(spectrum + c * (M_ + 1), samples + c * N_);
}

std::size_t ShortTransform::lane_width() { return lanes::width; }

void ShortTransform::forward(const double* samples, double* re, double* im, std::size_t apart, double factor,
                             std::size_t columns) const {
  for (std::size_t c = 0; c < columns; c += lanes::width)
    Columns{*this}.forward(samples + c * N_, factor, std::min(lanes::width, columns - c),
                           [&](std::size_t k, Lanes real, Lanes imaginary) {
                             real.store(re + k * apart + c);
                             imaginary.store(im + k * apart + c);
                           });
}

void ShortTransform::backward(const double* re, const double* im, std::size_t apart, double* samples,
                              std::size_t columns) const {
  for (std::size_t c = 0; c < columns; c += lanes::width)
    Columns{*this}.backward([&](std::size_t k) { return Lanes::load(re + k * apart + c); },
                            [&](std::size_t k) { return Lanes::load(im + k * apart + c); }, samples + c * N_,
                            std::min(lanes::width, columns - c));
}

}  // namespace hb::fourier
