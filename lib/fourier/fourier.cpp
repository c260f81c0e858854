#include "lib/fourier/fourier.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "lib/constants.hpp"
#include "lib/fourier/moduli.hpp"
#include "lib/fourier/short_transform.hpp"
#include "lib/fourier/transpose.hpp"
#include "lib/fourier/waves.hpp"

namespace hb::fourier {

namespace {

std::mutex& planner_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

FourierSeries analyse(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  const Eigen::Index n = samples.rows(), N = samples.cols();
  if (N < 1) throw std::invalid_argument("fourier::analyse: no samples");
  RealTransform& transform = thread_transform(N, n);
  transpose(samples, transform.samples());
  transform.forward();
  const Eigen::Index H = (N - 1) / 2;
  FourierSeries series;
  series.c.resize(n, H + 1);
  transpose_singly(transform.spectrum().topRows(H + 1), series.c);
  return series;
}

Eigen::MatrixXd synthesise(const FourierSeries& series, Eigen::Index num_samples) {
  const Eigen::Index H = series.num_harmonics();
  if (num_samples < 2 * H + 1) throw std::invalid_argument("fourier::synthesise: fewer samples than 2H+1");
  RealTransform& transform = thread_transform(num_samples, series.num_components());
  auto spectrum = transform.spectrum();
  spectrum.bottomRows(spectrum.rows() - H - 1).setZero();
  transpose_singly(series.c, spectrum.topRows(H + 1));
  transform.backward();
  Eigen::MatrixXd samples(series.num_components(), num_samples);
  transpose(transform.samples(), samples);
  return samples;
}

FourierSeries derivative(const FourierSeries& series, int order) {
  const Eigen::Index n = series.num_components();
  FourierSeries result;
  result.c.resize(n, series.c.cols());
  const double sign = order % 4 < 2 ? 1 : -1;  // of i^order, or of i^(order - 1)
  for (Eigen::Index k = 0; k <= series.num_harmonics(); ++k) {
    double factor = sign;
    for (int j = 0; j < order; ++j) factor *= static_cast<double>(k);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::complex<double> c = factor * series.c(i, k);
      result.c(i, k) = order % 2 == 0 ? c : std::complex<double>(-c.imag(), c.real());
    }
  }
  return result;
}

Eigen::VectorXd evaluate(const FourierSeries& series, double tau) {
  Eigen::VectorXd sum = series.c.col(0).real();
  Waves wave(tau);
  for (Eigen::Index k = 1; k <= series.num_harmonics(); ++k) {
    const std::complex<double> factor = 2.0 * wave.next();
    sum += factor.real() * series.c.col(k).real() - factor.imag() * series.c.col(k).imag();
  }
  return sum;
}

FourierSeries resized(const FourierSeries& series, Eigen::Index num_harmonics) {
  const Eigen::Index kept = std::min(num_harmonics, series.num_harmonics()) + 1;
  FourierSeries result;
  result.c.resize(series.num_components(), num_harmonics + 1);
  result.c.leftCols(kept) = series.c.leftCols(kept);
  result.c.rightCols(num_harmonics + 1 - kept).setZero();
  return result;
}

FourierSeries sum(const FourierSeries& f, const FourierSeries& g) {
  FourierSeries result = resized(f, std::max(f.num_harmonics(), g.num_harmonics()));
  result.c.leftCols(g.c.cols()) += g.c;
  return result;
}

FourierSeries difference(const FourierSeries& f, const FourierSeries& g) {
  FourierSeries result = resized(f, std::max(f.num_harmonics(), g.num_harmonics()));
  result.c.leftCols(g.c.cols()) -= g.c;
  return result;
}

double mean_product(const FourierSeries& f, const FourierSeries& g) {
  const Eigen::Index count = std::min(f.c.cols(), g.c.cols());
  const auto products = (f.c.leftCols(count).conjugate().cwiseProduct(g.c.leftCols(count))).real();
  return 2 * products.sum() - products.col(0).sum();
}

Eigen::Index significant_harmonics(const FourierSeries& series, double relative) {
  if (series.c.size() == 0) return 0;
  const Eigen::VectorXd squares = (unit_of(series.c) * series.c).cwiseAbs2().colwise().maxCoeff();
  const double floor = relative * relative * squares.maxCoeff();
  Eigen::Index H = series.num_harmonics();
  while (H > 0 && squares(H) <= floor) --H;
  return H;
}

double wiener_norm(const FourierSeries& series, Eigen::Index component) {
  const auto row = series.c.row(component);
  const double unit = unit_of(row);
  const double positive = (unit * row.tail(series.num_harmonics())).cwiseAbs2().cwiseSqrt().sum();
  return (std::sqrt(std::norm(unit * row(0))) + 2 * positive) / unit;
}

class FftwPlans {
 public:
  explicit FftwPlans(int N) : samples_(fftw_alloc_real(at(N))), spectrum_(fftw_alloc_complex(at(N / 2 + 1))) {
    if (!samples_ || !spectrum_) throw std::bad_alloc();
    // Columns of odd length start anywhere.
    const unsigned flags = FFTW_ESTIMATE | (N % 2 == 1 ? FFTW_UNALIGNED : 0U);
    to_spectrum_ = fftw_plan_dft_r2c_1d(N, samples_.get(), spectrum_.get(), flags | FFTW_PRESERVE_INPUT);
    to_samples_ = fftw_plan_dft_c2r_1d(N, spectrum_.get(), samples_.get(), flags);
    if (!to_spectrum_ || !to_samples_) throw std::bad_alloc();
  }
  ~FftwPlans() {
    fftw_destroy_plan(to_spectrum_);
    fftw_destroy_plan(to_samples_);
  }
  FftwPlans(const FftwPlans&) = delete;
  FftwPlans& operator=(const FftwPlans&) = delete;

  // Any arrays aligned as FFTW's own.
  void forward(double* samples, fftw_complex* spectrum) const { fftw_execute_dft_r2c(to_spectrum_, samples, spectrum); }
  void backward(fftw_complex* spectrum, double* samples) const { fftw_execute_dft_c2r(to_samples_, spectrum, samples); }

 private:
  struct Free {
    void operator()(void* memory) const { fftw_free(memory); }
  };
  static std::size_t at(int n) { return static_cast<std::size_t>(n); }

  std::unique_ptr<double, Free> samples_;
  std::unique_ptr<fftw_complex, Free> spectrum_;
  fftw_plan to_spectrum_ = nullptr, to_samples_ = nullptr;
};

// Transforms of one length, one component at a time: made once per process, then only read. Short lengths have their
// own transform, which is ready at once; FFTW, which plans for up to milliseconds, serves the others.
class Plans {
 public:
  explicit Plans(int N) : N_(N), short_(ShortTransform::of_length(at(N))) {
    if (!short_) fftw_.emplace(N);
  }

  // `columns` arrays of N and N/2 + 1 numbers after each other, aligned as FFTW's own; forward with the factor 1/N.
  void forward(double* samples, fftw_complex* spectrum, Eigen::Index columns) const {
    if (short_)
      return short_->forward(samples, reinterpret_cast<std::complex<double>*>(spectrum), 1 / double(N_),
                             static_cast<std::size_t>(columns));
    for (Eigen::Index i = 0; i < columns; ++i) fftw_->forward(samples + i * N_, spectrum + i * (N_ / 2 + 1));
    Eigen::Map<Eigen::VectorXcd>(reinterpret_cast<std::complex<double>*>(spectrum), columns * (N_ / 2 + 1)) /=
        double(N_);
  }
  void backward(fftw_complex* spectrum, double* samples, Eigen::Index columns) const {
    if (short_)
      return short_->backward(reinterpret_cast<const std::complex<double>*>(spectrum), samples,
                              static_cast<std::size_t>(columns));
    for (Eigen::Index i = 0; i < columns; ++i) fftw_->backward(spectrum + i * (N_ / 2 + 1), samples + i * N_);
  }

 private:
  static std::size_t at(int n) { return static_cast<std::size_t>(n); }

  int N_;
  const ShortTransform* short_;
  std::optional<FftwPlans> fftw_;
};

static const Plans& plans(Eigen::Index N) {
  static std::map<Eigen::Index, Plans> made;
  const std::lock_guard lock(planner_mutex());
  return made.try_emplace(N, static_cast<int>(N)).first->second;
}

struct RealTransform::Impl {
  Eigen::Index N, n;
  const Plans& plan;
  // Aligned as all matrices are: where a vector begins decides in which order its numbers are added.
  Eigen::VectorXd samples_memory;
  Eigen::VectorXcd spectrum_memory;
  double* samples;
  fftw_complex* spectrum;

  Impl(Eigen::Index num_samples, Eigen::Index num_components)
      : N(num_samples),
        n(num_components),
        plan(checked(N, n)),
        samples_memory(N * n),
        spectrum_memory((N / 2 + 1) * n),
        samples(samples_memory.data()),
        spectrum(reinterpret_cast<fftw_complex*>(spectrum_memory.data())) {}
  static const Plans& checked(Eigen::Index N, Eigen::Index n) {
    if (N < 1 || n < 1) throw std::invalid_argument("RealTransform: length and number of components must be positive");
    return plans(N);
  }
};

RealTransform::RealTransform(Eigen::Index num_samples, Eigen::Index num_components)
    : impl_(std::make_unique<Impl>(num_samples, num_components)) {}
RealTransform::~RealTransform() = default;
RealTransform::RealTransform(RealTransform&&) noexcept = default;
RealTransform& RealTransform::operator=(RealTransform&&) noexcept = default;

Eigen::Index RealTransform::num_samples() const { return impl_->N; }
Eigen::Index RealTransform::num_components() const { return impl_->n; }
Eigen::Map<Eigen::MatrixXd> RealTransform::samples() { return {impl_->samples, impl_->N, impl_->n}; }
Eigen::Map<Eigen::MatrixXcd> RealTransform::spectrum() {
  return {reinterpret_cast<std::complex<double>*>(impl_->spectrum), impl_->N / 2 + 1, impl_->n};
}

void RealTransform::forward() { impl_->plan.forward(impl_->samples, impl_->spectrum, impl_->n); }

void RealTransform::backward() { impl_->plan.backward(impl_->spectrum, impl_->samples, impl_->n); }

Eigen::Index fast_length(Eigen::Index n) {
  Eigen::Index N = 2;
  while (N < n) N *= 2;
  return N / 4 * 3 >= n && N >= 8 ? N / 4 * 3 : N;
}

RealTransform& thread_transform(Eigen::Index num_samples, Eigen::Index num_components) {
  thread_local std::map<std::pair<Eigen::Index, Eigen::Index>, RealTransform> transforms;
  const auto key = std::pair(num_samples, num_components);
  const auto found = transforms.find(key);
  if (found != transforms.end()) return found->second;
  return transforms.emplace(key, RealTransform(num_samples, num_components)).first->second;
}

}  // namespace hb::fourier
