#include "hb/analysis/stress_cycle.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "hb/analysis/rod_stress.hpp"
#include "lib/golden_section.hpp"

namespace hb {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// N along the rigid mechanism's rod and M of the response q; the link outlives it.
StressField linear_field(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                         Index num_samples) {
  return [&link, num_samples, f = fourier::synthesise(axial_series(rod, speed), num_samples),
          moment = bending_moment_along(link, rod, speed, q, num_samples)](const Eigen::Ref<const Eigen::VectorXd>& x) {
    const Elastic& elastic = *link.elastic;
    const double EJ = elastic.youngs_modulus * elastic.second_moment;
    StressSamples field;
    field.axial.resize(x.size(), num_samples);
    for (Index i = 0; i < x.size(); ++i)
      field.axial.row(i) = EJ / elastic.area * (f.row(2) + x(i) * f.row(1) - 0.5 * x(i) * x(i) * f.row(0));
    field.bending = elastic.section_height / 2 / elastic.second_moment * moment(x);
    return field;
  };
}

// Over the turn at one place and fibre.
Range range_at(const StressField& field, double x, int side) {
  const StressSamples at = field(Eigen::VectorXd::Constant(1, x));
  return fourier::range(fourier::analyse(at.axial + side * at.bending), 0);
}

double magnitude(const Range& range) { return std::max(range.max.value, -range.min.value); }
double amplitude(const Range& range) { return (range.max.value - range.min.value) / 2; }
double mean(const Range& range) { return (range.max.value + range.min.value) / 2; }

struct Place {
  double x = 0;
  int side = 1;
};

// Where `measure` of the turn's range is largest: between the neighbours of each place of a grid that may be the one,
// for its samples miss a few per cent of the range.
Place worst_place(const StressField& field, double length, const MatrixXd (&by_side)[2],
                  const std::function<double(const Range&)>& measure) {
  constexpr double nearly = 0.95;
  const Index points = by_side[0].rows();
  MatrixXd rough(points, 2);
  for (int s = 0; s < 2; ++s)
    for (Index i = 0; i < points; ++i)
      rough(i, s) = measure({{by_side[s].row(i).minCoeff(), 0}, {by_side[s].row(i).maxCoeff(), 0}});
  const double least = nearly * rough.maxCoeff();
  const auto at = [&](Index i) { return std::clamp<Index>(i, 0, points - 1); };
  const auto x_of = [&](Index i) { return length * static_cast<double>(at(i)) / static_cast<double>(points - 1); };
  Place worst;
  double most = -1;
  for (int s = 0; s < 2; ++s) {
    const int side = s == 0 ? 1 : -1;
    const auto value = [&](double x) { return measure(range_at(field, x, side)); };
    for (Index i = 0; i < points; ++i) {
      if (!(rough(i, s) >= least && rough(i, s) >= rough(at(i - 1), s) && rough(i, s) >= rough(at(i + 1), s))) continue;
      for (const double x : {x_of(i), largest_between(x_of(i - 1), x_of(i + 1), value)})
        if (const double here = value(x); here > most) {
          most = here;
          worst = {x, side};
        }
    }
  }
  return worst;
}

}  // namespace

StressEnvelope stress_envelope(const Body& link, const StressField& field, Index points) {
  StressEnvelope envelope;
  envelope.x = Eigen::VectorXd::LinSpaced(points, 0, link.length);
  const StressSamples at = field(envelope.x);
  for (int s = 0; s < 2; ++s) {
    const MatrixXd sigma = at.axial + (s == 0 ? 1 : -1) * at.bending;
    envelope.smallest[s] = sigma.rowwise().minCoeff();
    envelope.largest[s] = sigma.rowwise().maxCoeff();
  }
  return envelope;
}

StressEnvelope stress_envelope(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                               Index points) {
  Index H = std::max<Index>(q.num_harmonics(), 8);
  for (const FourierSeries& f : rod.f) H = std::max(H, f.num_harmonics());
  constexpr Index samples_per_harmonic = 16;
  return stress_envelope(link, linear_field(link, rod, speed, q, fourier::fast_length(samples_per_harmonic * H)),
                         points);
}

Eigen::VectorXd stress_places(const Body& link, Index num_modes) {
  return Eigen::VectorXd::LinSpaced(8 * num_modes + 17, 0, link.length);
}

StressCycle stress_cycle(const Body& link, const StressField& field, const StressSamples& grid, double error) {
  const MatrixXd by_side[2] = {grid.axial + grid.bending, grid.axial - grid.bending};
  StressCycle cycle;
  cycle.error = error;
  const Place largest = worst_place(field, link.length, by_side, magnitude);
  const Range there = range_at(field, largest.x, largest.side);
  const Extremum& peak = there.max.value >= -there.min.value ? there.max : there.min;
  cycle.max_abs = std::abs(peak.value);
  cycle.crank_angle = peak.crank_angle;
  cycle.x = largest.x;
  cycle.side = largest.side;
  const Place widest = worst_place(field, link.length, by_side, amplitude);
  const Range turn = range_at(field, widest.x, widest.side);
  cycle.amplitude = amplitude(turn);
  cycle.mean = mean(turn);
  cycle.amplitude_x = widest.x;
  cycle.amplitude_side = widest.side;

  const Strength& strength = link.elastic->strength;
  if (strength.yield > 0) cycle.yield = safety_factor(cycle.max_abs / strength.yield, error / strength.yield);
  if (fatigue_line(strength) != FatigueLine::none) {
    const auto usage = [&](const Range& range) { return fatigue_usage(strength, mean(range), amplitude(range)); };
    const Place worst = worst_place(field, link.length, by_side, usage);
    const Range at = range_at(field, worst.x, worst.side);
    cycle.fatigue = {safety_factor(usage(at), fatigue_usage(strength, error, error)),
                     mean(at),
                     amplitude(at),
                     worst.x,
                     worst.side,
                     at.max.crank_angle,
                     at.min.crank_angle};
  }
  return cycle;
}

StressCycle stress_cycle(const Body& link, const RodCoefficients& rod, double speed, const FourierSeries& q,
                         const FourierSeries& more_modes, double error_bound) {
  const Elastic& elastic = *link.elastic;
  Index H = std::max({q.num_harmonics(), more_modes.num_harmonics(), Index{8}});
  for (const FourierSeries& f : rod.f) H = std::max(H, f.num_harmonics());
  const Index N = fourier::fast_length(4 * H + 4);
  const StressField field = linear_field(link, rod, speed, q, N);
  const Eigen::VectorXd places = stress_places(link, q.num_components());
  const StressSamples grid = field(places);

  // |error of q_i| <= bound max |q|: in w'' sum of i^2 times that. The cut: twice what more modes change.
  const auto I = static_cast<double>(q.num_components());
  double error = error_bound * I * (I + 1) * (2 * I + 1) / 6 * grid.bending.cwiseAbs().maxCoeff();
  if (more_modes.c.size() > 0) {
    const double per_moment = elastic.section_height / 2 / elastic.second_moment;
    const MatrixXd finer = bending_moment_along(link, rod, speed, more_modes, N)(places);
    error += 2 * (per_moment * finer - grid.bending).cwiseAbs().maxCoeff();
  }
  return stress_cycle(link, field, grid, error);
}

}  // namespace hb
