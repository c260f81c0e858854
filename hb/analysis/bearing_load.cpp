#include "hb/analysis/bearing_load.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "lib/constants.hpp"

namespace hb {
namespace {

// N x n samples, until the thread's next transform of this size, at the angles 2 pi (j + shift)/N.
Eigen::Map<const Eigen::MatrixXd> sampled(const FourierSeries& series, Eigen::Index N, double shift = 0) {
  fourier::RealTransform& transform = fourier::thread_transform(N, series.num_components());
  auto spectrum = transform.spectrum();
  const Eigen::Index H = series.num_harmonics();
  spectrum.bottomRows(spectrum.rows() - H - 1).setZero();
  spectrum.topRows(H + 1) = series.c.transpose();
  if (shift != 0)
    for (Eigen::Index k = 1; k <= H; ++k)
      spectrum.row(k) *= std::polar(1.0, two_pi * shift * static_cast<double>(k) / static_cast<double>(N));
  transform.backward();
  return {transform.samples().data(), N, series.num_components()};
}

// Mean of |f| over the turn from the integral F of f between its sign changes, each found by halving.
double mean_of_modulus(const FourierSeries& f) {
  const auto at = [](const FourierSeries& series, double tau) { return fourier::evaluate(series, tau)(0); };
  const double mean = f.c(0, 0).real();
  FourierSeries F = f;
  F.c(0, 0) = 0;
  for (Eigen::Index k = 1; k <= f.num_harmonics(); ++k) F.c(0, k) /= std::complex<double>(0, static_cast<double>(k));
  const auto integral = [&](double tau) { return mean * tau + at(F, tau); };
  constexpr Eigen::Index samples_per_harmonic = 16;
  constexpr int halvings = 60;
  const Eigen::Index N = fourier::fast_length(samples_per_harmonic * (f.num_harmonics() + 1));
  const Eigen::RowVectorXd values = fourier::synthesise(f, N).row(0);
  const double step = two_pi / static_cast<double>(N), start = integral(0);
  double sum = 0, before = start, sign = values(0) < 0 ? -1 : 1;
  for (Eigen::Index j = 0; j < N; ++j) {
    if (!(values((j + 1) % N) * sign < 0)) continue;
    double low = step * static_cast<double>(j), high = low + step;
    for (int k = 0; k < halvings; ++k) {
      const double middle = (low + high) / 2;
      (at(f, middle) * sign < 0 ? high : low) = middle;
    }
    const double here = integral((low + high) / 2);
    sum += sign * (here - before);
    before = here;
    sign = -sign;
  }
  return (sum + sign * (start + two_pi * mean - before)) / two_pi;
}

// Mean length over the turn. Near a kink, where both components nearly vanish, it settles slowly with the samples.
double mean_length(const FourierSeries& force) {
  if (force.num_components() == 1) return mean_of_modulus(force);
  constexpr Eigen::Index fewest_per_harmonic = 8, most_per_harmonic = 64;
  constexpr double settled = 1e-12;
  const Eigen::Index H = std::max<Eigen::Index>(force.num_harmonics(), 16);
  const auto lengths = [&](Eigen::Index N, double shift) -> Eigen::ArrayXd {
    return sampled(force, N, shift).rowwise().norm().array();
  };
  Eigen::Index N = fourier::fast_length(fewest_per_harmonic * H);
  const Eigen::ArrayXd first = lengths(N, 0);
  double of_half = first(Eigen::seqN(0, N / 2, 2)).mean(), mean = first.mean();
  for (Eigen::Index per_harmonic = fewest_per_harmonic; per_harmonic < most_per_harmonic; per_harmonic *= 2, N *= 2) {
    if (std::abs(mean - of_half) <= settled * mean) break;
    of_half = std::exchange(mean, (mean + lengths(N, 0.5).mean()) / 2);
  }
  return mean;
}

// Of the length, which is that of the components together: sum over all harmonics, both signs, of |c|^2.
double rms_length(const FourierSeries& force) {
  const double constant = force.c.col(0).squaredNorm();
  return std::sqrt(constant + 2 * force.c.rightCols(force.num_harmonics()).squaredNorm());
}

}  // namespace

std::vector<BearingLoad> bearing_loads(const JointForces& forces, int turns, LoadDetail detail) {
  std::vector<BearingLoad> loads;
  for (const JointForce& joint : forces.joints) {
    BearingLoad load{joint.name, fourier::largest_length(joint.elastic), {}};
    if (detail == LoadDetail::all) {
      load.rigid = fourier::largest_length(joint.rigid);
      if (joint.elastic.num_harmonics() >= 0) {
        load.mean = mean_length(joint.elastic);
        load.rms = rms_length(joint.elastic);
      }
    }
    for (Extremum* peak : {&load.rigid, &load.elastic}) peak->crank_angle *= turns;
    loads.push_back(std::move(load));
  }
  return loads;
}

}  // namespace hb
