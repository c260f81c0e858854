#include "hb/analysis/rod_stress.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/golden_section.hpp"

namespace hb {
namespace {

constexpr Eigen::Index samples_per_harmonic = 16;

// The largest value of sense N(x, tau) over the rod at one crank angle, N of N(x, tau) = EJ (f4 + f3 x - f2 x^2/2),
// README of lib (M4): at an end, or at x = f3/f2 inside. `f`: f2, f3, f4; without EJ.
double along_the_rod(const Eigen::Ref<const Eigen::Vector3d>& f, double length, double sense) {
  double largest = -HUGE_VAL;
  const double inside = f(1) / f(0);
  for (const double x : {0.0, length, inside > 0 && inside < length ? inside : 0.0})
    largest = std::max(largest, sense * (f(2) + f(1) * x - f(0) * x * x / 2));
  return largest;
}

// The largest value over rod and turn: of samples, those that may be next to it improved by golden sections.
double over_rod_and_turn(const FourierSeries& series, const Eigen::MatrixXd& samples, double length, double sense) {
  const Eigen::Index N = samples.cols();
  Eigen::VectorXd values(N);
  for (Eigen::Index j = 0; j < N; ++j) values(j) = along_the_rod(samples.col(j), length, sense);
  const double step = 2 * std::numbers::pi / static_cast<double>(N), most = values.maxCoeff();
  // 1 - cos(pi/16) of the highest harmonic's amplitude at most lies between two samples.
  const double near = most - 0.02 * (most - values.minCoeff());
  const auto value = [&](double tau) { return along_the_rod(fourier::evaluate(series, tau), length, sense); };
  double largest = most;
  for (Eigen::Index j = 0; j < N; ++j) {
    const bool peak = values(j) > values((j + N - 1) % N) && values(j) >= values((j + 1) % N);
    if (!peak || values(j) < near) continue;
    const double tau = step * static_cast<double>(j);
    largest = std::max(largest, value(largest_between(tau - step, tau + step, value)));
  }
  return largest;
}

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

RodStress rod_stress(const Body& link, const RodCoefficients& rod, double tail, double speed, double bending_moment,
                     std::optional<double> moment_error) {
  const Elastic& elastic = *link.elastic;
  const double l = link.length, E = elastic.youngs_modulus, F = elastic.area, J = elastic.second_moment;
  const FourierSeries series = axial_series(rod, speed);
  const Eigen::Index H = std::max<Eigen::Index>(series.num_harmonics(), 4);
  const Eigen::MatrixXd f = fourier::synthesise(series, fourier::fast_length(samples_per_harmonic * H));
  RodStress result;
  result.tension = std::max(0.0, over_rod_and_turn(series, f, l, 1)) * E * J;
  result.compression = std::max(0.0, over_rod_and_turn(series, f, l, -1)) * E * J;
  // What golden sections leave, and the first coefficients of the tail, which decays.
  constexpr double search = 1e-10, tail_sum = 8;
  const double size = fourier::wiener_norm(series, 2) + l * fourier::wiener_norm(series, 1) +
                      l * l / 2 * fourier::wiener_norm(series, 0);
  result.force_error = std::max(search, tail_sum * tail) * size * E * J;
  result.buckling_load = std::pow(std::numbers::pi / l, 2) * E * J;
  result.height_known = elastic.section_height > 0;
  const double e = result.height_known ? elastic.section_height / 2 : std::sqrt(3 * J / F);
  result.axial = std::max(result.tension, result.compression) / F;
  result.axial_error = result.force_error / F;
  result.bending = bending_moment * e / J;
  if (moment_error) result.bending_error = *moment_error * e / J;
  result.strain = (result.axial + result.bending) / E;
  return result;
}

}  // namespace hb
