#include "hb/analysis/theory_growth.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "hb/analysis/nonlinear/exact_system.hpp"
#include "hb/analysis/nonlinear/motion_finder.hpp"
#include "hb/engine/nonlinear/motion_stability.hpp"

namespace hb {

namespace {

using Eigen::Index;

constexpr Index most_growth_modes = 2;  // higher ones change the six-link mechanism's value by 1 %

FourierSeries first_entries(const FourierSeries& matrices, Index n, Index kept) {
  FourierSeries part(kept * kept, matrices.num_harmonics());
  for (Index j = 0; j < kept; ++j) part.c.middleRows(kept * j, kept) = matrices.c.middleRows(n * j, kept);
  return part;
}

// The first modes of a linear system, alone.
HillSystem first_modes_of(const HillSystem& system, Index kept) {
  HillSystem part;
  part.mass = system.mass.topLeftCorner(kept, kept);
  part.damping = system.damping.topLeftCorner(kept, kept);
  for (std::size_t p = 0; p < 3; ++p)
    if (system.stiffness[p].c.size() > 0)
      part.stiffness[p] = first_entries(system.stiffness[p], system.num_modes(), kept);
  return part;
}

}  // namespace

// The exponents of (T5): those of the exact model linearised about q + dq, which need not be a motion of it.
std::optional<double> growth_theory_error(const Linkage& linkage, double speed, std::span<const LinearRod> rods,
                                          const TheoryErrors& errors) {
  constexpr double negligible = 1e-6, tolerance = 1e-7;
  const std::vector<int> links = elastic_links(linkage);
  std::vector<Index> num_modes;
  std::vector<FourierSeries> bent;
  double linear_rate = -HUGE_VAL, linear_error = 0;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    if (!errors.rods[r].q || body_at(linkage, links[r])->elastic->shear) return std::nullopt;
    const FourierSeries &q = *rods[r].q, &dq = errors.rods[r].correction;
    const Index I = std::min(most_growth_modes, q.num_components());
    num_modes.push_back(I);
    const Index H = std::max(fourier::significant_harmonics(q, negligible), dq.num_harmonics());
    bent.emplace_back(Eigen::MatrixXcd((fourier::resized(q, H).c + fourier::resized(dq, H).c).topRows(I)));
    const Stability linear = analyse_stability(first_modes_of(*rods[r].system, I), speed, {.leading_only = true});
    linear_rate = std::max(linear_rate, linear.growth_rate);
    linear_error = std::max(linear_error, linear.growth_error);
  }
  PeriodicMotion motion;
  motion.status = MotionStatus::converged;
  motion.parameter = motion.speed = speed;
  motion.q = motion.q_finer = stacked(bent);
  motion.num_samples = static_cast<int>(fourier::fast_length(6 * motion.q.num_harmonics() + 16));
  const NonlinearSystem system = exact_system(std::make_shared<const ExactModel>(theory_model(linkage, num_modes)));
  const Stability stability = motion_stability(system, motion, {.tolerance = tolerance, .leading_only = true});
  const double error = stability.growth_error + linear_error;
  if (!std::isfinite(stability.growth_rate) || !std::isfinite(error)) return std::nullopt;
  return std::max(std::abs(stability.growth_rate - linear_rate), error);
}

}  // namespace hb
