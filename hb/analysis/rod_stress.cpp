#include "hb/analysis/rod_stress.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lib/golden_section.hpp"

namespace hb {
namespace {

// The largest value of sense N(x, tau) over the rod at one crank angle, N of N(x, tau) = EJ (f4 + f3 x - f2 x^2/2),
// README of lib (M4): at an end, or at x = f3/f2 inside. `f`: f2, f3, f4; without EJ.
double along_the_rod(const Eigen::Ref<const Eigen::Vector3d>& f, double length, double sense) {
  double largest = -HUGE_VAL;
  const double inside = f(1) / f(0);
  for (const double x : {0.0, length, inside > 0 && inside < length ? inside : 0.0})
    largest = std::max(largest, sense * (f(2) + f(1) * x - f(0) * x * x / 2));
  return largest;
}

// Whether that place may be inside at the next samples too.
bool may_be_inside(const Eigen::Ref<const Eigen::Vector3d>& f, double length, double sense) {
  const double x = f(1) / f(0);
  return sense * f(0) > 0 && x > -0.5 * length && x < 1.5 * length;
}

// Over the turn at both ends.
std::array<Range, 2> at_ends(const FourierSeries& series, double length) {
  FourierSeries ends(2, series.num_harmonics());
  ends.c.row(0) = series.c.row(2);
  ends.c.row(1) = series.c.row(2) + length * series.c.row(1) - length * length / 2 * series.c.row(0);
  const std::vector<Range> ranges = fourier::ranges(ends);
  return {ranges[0], ranges[1]};
}

// The largest value over rod and turn, `at_ends` that of both ends: of samples, those that may be next to a higher one
// inside improved by golden sections.
double over_rod_and_turn(const FourierSeries& series, const Eigen::MatrixXd& samples, double length, double sense,
                         double at_ends) {
  const Eigen::Index N = samples.cols();
  Eigen::VectorXd values(N);
  for (Eigen::Index j = 0; j < N; ++j) values(j) = along_the_rod(samples.col(j), length, sense);
  const double step = 2 * std::numbers::pi / static_cast<double>(N);
  // 1 - cos(pi/16) of the highest harmonic's amplitude at most lies between two samples; as much for those left out.
  const double near = at_ends - 0.04 * (values.maxCoeff() - values.minCoeff());
  const auto value = [&](double tau) { return along_the_rod(fourier::evaluate(series, tau), length, sense); };
  double largest = at_ends;
  for (Eigen::Index j = 0; j < N; ++j) {
    const Eigen::Index before = (j + N - 1) % N, after = (j + 1) % N;
    if (!(values(j) > values(before) && values(j) >= values(after)) || values(j) < near) continue;
    if (std::ranges::none_of(std::array{before, j, after},
                             [&](Eigen::Index k) { return may_be_inside(samples.col(k), length, sense); }))
      continue;
    const double tau = step * static_cast<double>(j);
    largest = std::max(largest, value(largest_between(tau - step, tau + step, value)));
  }
  return largest;
}

// The highest harmonic that is not small beside the largest, of f2 l^2/2, f3 l and f4 together.
Eigen::Index largest_harmonics(const FourierSeries& series, double length) {
  constexpr double small = 1e-3;
  FourierSeries forces = series;
  forces.c.row(0) *= length * length / 2;
  forces.c.row(1) *= length;
  return fourier::significant_harmonics(forces, small);
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
  constexpr Eigen::Index samples_per_harmonic = 16, fewest = 4;
  const Eigen::Index H = std::max(largest_harmonics(series, l), fewest);
  const Eigen::MatrixXd f =
      fourier::synthesise(fourier::resized(series, H), fourier::fast_length(samples_per_harmonic * H));
  const auto [first, last] = at_ends(series, l);
  const double most = std::max(first.max.value, last.max.value), least = std::min(first.min.value, last.min.value);
  RodStress result;
  result.tension = std::max(0.0, over_rod_and_turn(series, f, l, 1, most)) * E * J;
  result.compression = std::max(0.0, over_rod_and_turn(series, f, l, -1, -least)) * E * J;
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
