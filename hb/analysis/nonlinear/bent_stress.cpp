#include "hb/analysis/nonlinear/bent_stress.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

// w' of the kept modes at x (rows) over the samples of q.
MatrixXd slopes(const FourierSeries& q, double length, const Eigen::Ref<const Eigen::VectorXd>& x, Index N) {
  MatrixXd shapes(x.size(), q.num_components());
  for (Index i = 0; i < q.num_components(); ++i) {
    const double k = static_cast<double>(i + 1) * std::numbers::pi / length;
    shapes.col(i) = k * (k * x.array()).cos();
  }
  return shapes * fourier::synthesise(q, N);
}

}  // namespace

Index stress_samples(Index num_harmonics, int turns) {
  return std::max<Index>(256 * turns, fourier::fast_length(8 * num_harmonics));
}

void bend(RodPeak& moment, const FourierSeries& q, double length) {
  const Eigen::VectorXd at = fourier::evaluate(q, moment.crank_angle);
  double slope = 0;
  for (Index i = 0; i < at.size(); ++i) {
    const double k = static_cast<double>(i + 1) * std::numbers::pi / length;
    slope += k * std::cos(k * moment.x) * at(i);
  }
  moment.max_abs /= std::sqrt(1 - slope * slope);
}

BentStresses::BentStresses(const ExactModel& exact, double speed, int turns, std::vector<FourierSeries> q,
                           Index num_samples) {
  Samples samples{exact.linkage(), {}, speed / turns, std::move(q), num_samples, {}};
  for (const ExactModel::Rod& rod : exact.rods()) samples.links.push_back(rod.link);
  samples.tension = rod_tensions(exact, speed, CrankAngles(exact.linkage(), num_samples, turns),
                                 ritz_samples(samples.q, speed, num_samples, turns));
  samples_ = std::make_shared<const Samples>(std::move(samples));
}

// With the axial force along the bent rod instead of the rigid mechanism's.
RodStress BentStresses::largest(std::size_t rod, const RodCoefficients& coefficients, double bending_moment,
                                std::optional<double> moment_error, const std::vector<BentStresses>& better) const {
  const Body& link = *body_at(samples_->linkage, samples_->links[rod]);
  const RodTension& tension = samples_->tension[rod];
  constexpr double no_tail = 0;
  RodStress stress = rod_stress(link, coefficients, no_tail, samples_->base, bending_moment, moment_error);
  stress.tension = stress.compression = 0;
  const FourierSeries over_motion = fourier::analyse(tension.N);
  for (Index i = 0; i < over_motion.num_components(); ++i) {
    const Range range = fourier::range(over_motion, i);
    stress.tension = std::max(stress.tension, range.max.value);
    stress.compression = std::max(stress.compression, -range.min.value);
  }
  stress.force_error = better.empty() ? HUGE_VAL : 0;
  for (const BentStresses& other : better)
    stress.force_error += 2 * (other.samples_->tension[rod].at(tension.x) - tension.N).cwiseAbs().maxCoeff();
  stress.axial = std::max(stress.tension, stress.compression) / link.elastic->area;
  stress.axial_error = stress.force_error / link.elastic->area;
  stress.strain = (stress.axial + stress.bending) / link.elastic->youngs_modulus;
  return stress;
}

// sigma = N/F and EJ w''/cos psi e/J, 1/cos psi = (1 - w'^2)^(-1/2).
StressField BentStresses::field(std::size_t rod, const RodCoefficients& coefficients) const {
  return [samples = samples_, rod, &coefficients](const Eigen::Ref<const Eigen::VectorXd>& x) {
    const Body& link = *body_at(samples->linkage, samples->links[rod]);
    const FourierSeries& q = samples->q[rod];
    const Elastic& elastic = *link.elastic;
    StressSamples at;
    at.axial = samples->tension[rod].at(x) / elastic.area;
    const MatrixXd straight = rod_field(link, coefficients, samples->base, q, x, samples->N).bending_moment;
    const Eigen::ArrayXXd slope = slopes(q, link.length, x, samples->N).array();
    at.bending =
        elastic.section_height / 2 / elastic.second_moment * (straight.array() / (1 - slope.square()).sqrt()).matrix();
    return at;
  };
}

std::optional<StressCycle> bent_cycle(const Body& link, const BentStresses& stresses, std::size_t rod,
                                      const RodCoefficients& coefficients, Index num_modes, int turns,
                                      const std::vector<BentStresses>& better) {
  if (!(link.elastic->section_height > 0)) return std::nullopt;
  const StressField field = stresses.field(rod, coefficients);
  const Eigen::VectorXd places = stress_places(link, num_modes);
  const StressSamples grid = field(places);
  double error = better.empty() ? HUGE_VAL : 0;
  for (const BentStresses& other : better) {
    const StressSamples at = other.field(rod, coefficients)(places);
    const MatrixXd axial = at.axial - grid.axial, bending = at.bending - grid.bending;
    error += 2 * (axial.cwiseAbs() + bending.cwiseAbs()).maxCoeff();
  }
  StressCycle cycle = stress_cycle(link, field, grid, error);
  cycle.crank_angle *= turns;
  if (cycle.fatigue) {
    cycle.fatigue->largest_at *= turns;
    cycle.fatigue->smallest_at *= turns;
  }
  return cycle;
}

}  // namespace hb
