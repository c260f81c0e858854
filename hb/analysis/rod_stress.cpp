#include "hb/analysis/rod_stress.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hb {
namespace {

constexpr Eigen::Index samples_per_harmonic = 16;

}  // namespace

FourierSeries axial_series(const RodCoefficients& rod, double speed) {
  Eigen::Index H = 0;
  for (const FourierSeries& f : rod.f) H = std::max(H, f.num_harmonics());
  FourierSeries sum(3, H);
  double power = 1;
  for (const FourierSeries& f : rod.f) {
    if (f.num_harmonics() >= 0) sum.c.leftCols(f.c.cols()) += power * f.c.middleRows(2, 3);
    power *= speed;
  }
  return sum;
}

// N(x, tau) = EJ (f4 + f3 x - f2 x^2/2), README of lib (M4): largest at an end, or at x = f3/f2 inside.
RodStress rod_stress(const Body& link, const RodCoefficients& rod, double speed, double bending_moment) {
  const Elastic& elastic = *link.elastic;
  const double l = link.length, E = elastic.youngs_modulus, F = elastic.area, J = elastic.second_moment;
  const FourierSeries series = axial_series(rod, speed);
  const Eigen::Index H = std::max<Eigen::Index>(series.num_harmonics(), 4);
  const Eigen::MatrixXd f = fourier::synthesise(series, fourier::fast_length(samples_per_harmonic * H));
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (Eigen::Index j = 0; j < f.cols(); ++j) {
    const double f2 = f(0, j), f3 = f(1, j), f4 = f(2, j), inside = f3 / f2;
    for (const double x : {0.0, l, inside > 0 && inside < l ? inside : 0.0}) {
      const double N = f4 + f3 * x - f2 * x * x / 2;
      low = std::min(low, N);
      high = std::max(high, N);
    }
  }
  RodStress result;
  result.tension = std::max(0.0, high) * E * J;
  result.compression = std::max(0.0, -low) * E * J;
  result.buckling_load = std::pow(std::numbers::pi / l, 2) * E * J;
  result.height_known = elastic.section_height > 0;
  const double e = result.height_known ? elastic.section_height / 2 : std::sqrt(3 * J / F);
  result.axial = std::max(result.tension, result.compression) / F;
  result.bending = bending_moment * e / J;
  result.strain = (result.axial + result.bending) / E;
  return result;
}

}  // namespace hb
