// Discrete Fourier transform of real samples, of lengths that are a power of two or three times one: at once ready for
// use, where a general library would plan for longer than a short transform takes.
//     c_k = sum_j f_j e^{-2 pi i jk/N},  k = 0..N/2          f_j = sum_k c_k e^{2 pi i jk/N},  c_{N-k} = conj c_k
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace hb::fourier {

class ShortTransform {
 public:
  // N = 2^k or 3 2^k, from 8 to 4096.
  [[nodiscard]] static bool serves(std::size_t num_samples);
  explicit ShortTransform(std::size_t num_samples);
  // One per length serves the process; none where N is not such a length.
  [[nodiscard]] static const ShortTransform* of_length(std::size_t num_samples);

  // N samples -> N/2 + 1 coefficients times `factor`.
  void forward(const double* samples, std::complex<double>* spectrum, double factor) const;
  // And back, without a factor; the imaginary parts of c_0 and c_{N/2} count as zero.
  void backward(const std::complex<double>* spectrum, double* samples) const;

  // Of `columns` functions, N samples and N/2 + 1 coefficients after each other: as many at once as the machine's
  // vectors hold numbers. The bits of one column may depend on how many there are.
  void forward(const double* samples, std::complex<double>* spectrum, double factor, std::size_t columns) const;
  void backward(const std::complex<double>* spectrum, double* samples, std::size_t columns) const;

  // The same with real and imaginary parts apart, those of all columns side by side: of harmonic k at re + k apart and
  // im + k apart, `apart` a multiple of lane_width() not below `columns`. N is a multiple of lane_width(), too.
  void forward(const double* samples, double* re, double* im, std::size_t apart, double factor,
               std::size_t columns) const;
  void backward(const double* re, const double* im, std::size_t apart, double* samples, std::size_t columns) const;
  [[nodiscard]] static std::size_t lane_width();

 private:
  // One pass of the autosort transform of M = N/2 complex numbers: sub-transforms of length n, radix r, stride M/n.
  struct Pass {
    std::size_t n, radix, stride;
    std::size_t twiddles;  // where in twiddles_: per power 1..r-1 cosines, then sines of 2 pi p/n, p < n/r
  };
  // In split form; the result lies in (re, im), the other pair is scratch.
  void transform(double*& re, double*& im, double*& other_re, double*& other_im) const;
  // short_transform_lanes.hpp
  struct Columns;

  std::size_t N_, M_;
  std::vector<Pass> passes_;
  std::vector<double> twiddles_;
  std::vector<double> cosines_, sines_;  // of 2 pi k/N, k <= M
};

}  // namespace hb::fourier
