#include "hb/engine/steady/split_products.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "lib/constants.hpp"
#include "lib/fourier/fourier.hpp"

namespace hb::steady {

using Index = Eigen::Index;
using Real = long double;

Split split(const std::vector<Real>& re, const std::vector<Real>& im, int bits) {
  const Index H = static_cast<Index>(re.size()) - 1;
  Split s;
  for (Eigen::VectorXd* part : {&s.high_re, &s.high_im, &s.low_re, &s.low_im}) part->setZero(2 * H + 1);
  Real largest = 0;
  for (std::size_t k = 0; k < re.size(); ++k) largest = std::max({largest, std::abs(re[k]), std::abs(im[k])});
  if (!(largest > 0)) return s;
  const Real grid = std::ldexp(Real(1), std::ilogb(largest) + 1 - bits);
  s.grid = static_cast<double>(grid);
  const auto place = [&](Real value, Index k, Real sign, Eigen::VectorXd& high, Eigen::VectorXd& low) {
    const Real rounded = std::nearbyint(value / grid) * grid;
    high(H + k) = static_cast<double>(rounded);
    low(H + k) = static_cast<double>(value - rounded);
    high(H - k) = static_cast<double>(sign) * high(H + k);
    low(H - k) = static_cast<double>(sign) * low(H + k);
  };
  for (Index k = 0; k <= H; ++k) {
    place(re[static_cast<std::size_t>(k)], k, 1, s.high_re, s.low_re);
    place(im[static_cast<std::size_t>(k)], k, -1, s.high_im, s.low_im);
  }
  return s;
}

void Products::multiply(const Split& c, Index top, Index P, const Split& x, Index H) {
  for (Eigen::ArrayXd* part : {&exact_re, &exact_im, &rest_re, &rest_im}) part->setZero();
  const Index reach = exact_re.size() - 1;
  for (Index m = -top; m <= top; ++m) {
    // rows k with |k - m| <= H
    const Index first = std::max<Index>(0, m - H), count = std::min(reach, m + H) - first + 1;
    if (count <= 0) continue;
    const Index from = H + first - m;
    const double A = c.high_re(P + m), B = c.high_im(P + m), a = c.low_re(P + m), b = c.low_im(P + m);
    const auto X = x.high_re.array().segment(from, count), Y = x.high_im.array().segment(from, count);
    const auto u = x.low_re.array().segment(from, count), v = x.low_im.array().segment(from, count);
    exact_re.segment(first, count) += A * X - B * Y;
    exact_im.segment(first, count) += A * Y + B * X;
    rest_re.segment(first, count) += (A * u - B * v) + (a * (X + u) - b * (Y + v));
    rest_im.segment(first, count) += (A * v + B * u) + (a * (Y + v) + b * (X + u));
  }
}

bool SampledProducts::suits(Index P, Index H) {
  constexpr Index fewest = 128;
  return P >= fewest && H >= fewest;
}

SampledProducts::SampledProducts(const std::vector<Split>& q, Index reach)
    : reach_(reach), N_(fourier::fast_length(2 * reach + 2)) {
  for (const Split& component : q) q_.push_back(sampled(component));
}

SampledProducts::Sampled SampledProducts::sampled(const Split& series) const {
  fourier::RealTransform& fft = fourier::thread_transform(N_, 2);
  auto spectrum = fft.spectrum();
  spectrum.setZero();
  const Index H = series.high_re.size() / 2;
  for (Index k = 0; k <= H; ++k) {
    spectrum(k, 0) = {series.high_re(H + k), series.high_im(H + k)};
    spectrum(k, 1) = {series.low_re(H + k), series.low_im(H + k)};
  }
  fft.backward();
  Sampled result;
  result.values = fft.samples().array();
  constexpr double computed = 1.001;  // the norms are known that well
  const double scale = computed / std::sqrt(static_cast<double>(N_));
  result.high_norm = scale * result.values.col(0).matrix().norm();
  result.low_norm = scale * result.values.col(1).matrix().norm();
  result.high_largest = computed * result.values.col(0).abs().maxCoeff();
  result.low_largest = computed * result.values.col(1).abs().maxCoeff();
  result.grid = series.grid;
  return result;
}

// hb/engine/README.md (S9).
std::optional<double> SampledProducts::multiply(const Split& c, std::size_t component, Products& products) {
  const Sampled entry = sampled(c), &x = q_[component];
  const double unit = entry.grid * x.grid, per_transform = 4 * eps * (std::log2(static_cast<double>(N_)) + 2);
  const double of_high = per_transform * x.high_norm * (2 * entry.high_norm + entry.high_largest);
  if (!(of_high <= unit / 8)) return std::nullopt;
  fourier::RealTransform& fft = fourier::thread_transform(N_, 2);
  auto samples = fft.samples();
  const auto high = entry.values.col(0), low = entry.values.col(1);
  samples.col(0) = (high * x.values.col(0)).matrix();
  samples.col(1) = (high * x.values.col(1) + low * (x.values.col(0) + x.values.col(1))).matrix();
  fft.forward();
  const auto spectrum = fft.spectrum();
  for (Index k = 0; k <= reach_; ++k) {
    products.exact_re(k) = unit > 0 ? std::nearbyint(spectrum(k, 0).real() / unit) * unit : 0;
    products.exact_im(k) = unit > 0 ? std::nearbyint(spectrum(k, 0).imag() / unit) * unit : 0;
    products.rest_re(k) = spectrum(k, 1).real();
    products.rest_im(k) = spectrum(k, 1).imag();
  }
  return per_transform * (x.low_norm * (2 * entry.high_norm + entry.high_largest) +
                          (x.high_norm + x.low_norm) * (2 * entry.low_norm + entry.low_largest));
}

}  // namespace hb::steady
