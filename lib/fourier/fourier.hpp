// Periodic functions as Fourier series. The only part of the program that sees FFTW.
//
// Convention, stated once: a real, 2*pi-periodic function with values in R^n is
//     f(tau) = sum_{k=-H}^{H} c_k e^{i k tau},   c_{-k} = conj(c_k),
// stored as the n x (H+1) matrix of c_0 .. c_H. Samples are taken at tau_j = 2 pi j / N.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <vector>

namespace hb {

struct FourierSeries {
  Eigen::MatrixXcd c;  // components x (H+1); column k is c_k

  FourierSeries() = default;
  FourierSeries(Eigen::Index num_components, Eigen::Index num_harmonics)
      : c(Eigen::MatrixXcd::Zero(num_components, num_harmonics + 1)) {}
  explicit FourierSeries(Eigen::MatrixXcd coefficients) : c(std::move(coefficients)) {}

  Eigen::Index num_components() const { return c.rows(); }
  Eigen::Index num_harmonics() const { return c.cols() - 1; }
};

// Value and place of an extremum over one turn.
struct Extremum {
  double value = 0;
  double crank_angle = 0;  // rad, in [0, 2 pi)
};

struct Range {
  Extremum min, max;
};

namespace fourier {

// Coefficients of the trigonometric interpolant of equally spaced samples (components x N).
// H = (N-1)/2; for even N the Nyquist term is dropped (it must be below rounding).
[[nodiscard]] FourierSeries analyse(const Eigen::Ref<const Eigen::MatrixXd>& samples);

// Samples (components x N) of the series; needs N >= 2H+1.
[[nodiscard]] Eigen::MatrixXd synthesise(const FourierSeries& series, Eigen::Index num_samples);

// d^order f / dtau^order.
[[nodiscard]] FourierSeries derivative(const FourierSeries& series, int order = 1);

// f(tau), one value per component.
[[nodiscard]] Eigen::VectorXd evaluate(const FourierSeries& series, double tau);

// Same series with harmonics 0..num_harmonics (cut or padded with zeros).
[[nodiscard]] FourierSeries resized(const FourierSeries& series, Eigen::Index num_harmonics);

// f + g and f - g, with as many harmonics as the longer one.
[[nodiscard]] FourierSeries sum(const FourierSeries& f, const FourierSeries& g);
[[nodiscard]] FourierSeries difference(const FourierSeries& f, const FourierSeries& g);

// Mean over the turn of sum_i f_i g_i.
[[nodiscard]] double mean_product(const FourierSeries& f, const FourierSeries& g);

// Smallest H such that every |c_k|, k > H, is <= relative * max|c| (per component's own maximum if
// `per_component`).
[[nodiscard]] Eigen::Index significant_harmonics(const FourierSeries& series, double relative);

// True extrema over the turn of one component (error of the value: rounding). A constant gives the constant, at angle
// 0.
[[nodiscard]] Range range(const FourierSeries& series, Eigen::Index component);

// Of every component, which costs less than one after the other.
[[nodiscard]] std::vector<Range> ranges(const FourierSeries& series);

// max |f| of one component over the turn, with its sign dropped.
[[nodiscard]] Extremum max_abs(const FourierSeries& series, Eigen::Index component);

// Of every component the value alone.
[[nodiscard]] Eigen::VectorXd largest_values(const FourierSeries& series);

// Largest length over the turn of the vector of all components; 0 of an empty series.
[[nodiscard]] Extremum largest_length(const FourierSeries& series);

// Upper bound of max_tau |f_i(tau)|: sum over all harmonics (both signs) of |c_k|.
[[nodiscard]] double wiener_norm(const FourierSeries& series, Eigen::Index component);

// Real FFT of fixed length for inner loops, with aligned buffers of its own. One plan per length serves the process,
// made under a lock; forward and backward may run in parallel on distinct objects. Plans are made with FFTW_ESTIMATE:
// same input, same bits.
class RealTransform {
 public:
  explicit RealTransform(Eigen::Index num_samples, Eigen::Index num_components = 1);
  ~RealTransform();
  RealTransform(RealTransform&&) noexcept;
  RealTransform& operator=(RealTransform&&) noexcept;

  Eigen::Index num_samples() const;  // N
  Eigen::Index num_components() const;  // n: transforms done at once
  // N x n, column per component.
  Eigen::Map<Eigen::MatrixXd> samples();
  // (N/2+1) x n, column per component.
  Eigen::Map<Eigen::MatrixXcd> spectrum();
  void forward();  // samples -> spectrum = c_0..c_{N/2}, normalised; samples are kept
  void backward();  // spectrum -> samples; the spectrum is destroyed

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Smallest 2^k or 3 2^k >= n, even: lengths that are fast, and few, so that plans are shared.
[[nodiscard]] Eigen::Index fast_length(Eigen::Index n);

// This thread's own RealTransform of the given size, made at its first use and kept: making one costs more than a
// short transform. The buffers belong to whoever asked last; do not hold on to it across other calls.
[[nodiscard]] RealTransform& thread_transform(Eigen::Index num_samples, Eigen::Index num_components = 1);

}  // namespace fourier
}  // namespace hb
