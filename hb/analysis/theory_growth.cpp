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

// Harmonics of q + dq below `negligible` of the largest are left out; angles for each of the others tell those of
// M, B, C.
struct GrowthLook {
  double negligible;
  Index angles;
  double tolerance;  // of the exponents
};
// The second where the first leaves an error above `growth_settled` of the change.
constexpr GrowthLook growth_looks[] = {{1e-4, 4, 1e-5}, {1e-6, 6, 1e-7}};
constexpr double growth_settled = 0.02;

struct Growth {
  double rate = -HUGE_VAL, error = 0;
};

// Of the linear rods the fastest one's.
Growth linear_growth(std::span<const HillSystem> rods, double speed, const StabilityOptions& options) {
  Growth largest;
  for (const HillSystem& rod : rods) {
    const Stability stability = analyse_stability(rod, speed, options);
    largest.rate = std::max(largest.rate, stability.growth_rate);
    largest.error = std::max(largest.error, stability.growth_error);
  }
  return largest;
}

// q + dq, which need not be a motion of the exact model.
PeriodicMotion corrected_motion(double speed, std::span<const LinearRod> rods, const TheoryErrors& errors,
                                const std::vector<Index>& num_modes, const GrowthLook& look) {
  std::vector<FourierSeries> bent;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    const FourierSeries moved = fourier::sum(*rods[r].q, errors.rods[r].correction);
    const FourierSeries kept = fourier::resized(moved, fourier::significant_harmonics(moved, look.negligible));
    bent.emplace_back(Eigen::MatrixXcd(kept.c.topRows(num_modes[r])));
  }
  PeriodicMotion motion;
  motion.status = MotionStatus::converged;
  motion.parameter = motion.speed = speed;
  motion.q = motion.q_finer = stacked(bent);
  motion.num_samples = static_cast<int>(fourier::fast_length(look.angles * motion.q.num_harmonics() + 16));
  return motion;
}

}  // namespace

// The exponents of (T5): those of the exact model linearised about q + dq.
std::optional<double> growth_theory_error(const Linkage& linkage, double speed, std::span<const LinearRod> rods,
                                          const TheoryErrors& errors) {
  const std::vector<int> links = elastic_links(linkage);
  std::vector<Index> num_modes;
  std::vector<HillSystem> first_modes;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    if (!errors.rods[r].q || body_at(linkage, links[r])->elastic->shear) return std::nullopt;
    num_modes.push_back(std::min(most_growth_modes, rods[r].q->num_components()));
    first_modes.push_back(first_modes_of(*rods[r].system, num_modes[r]));
  }
  const NonlinearSystem system = exact_system(std::make_shared<const ExactModel>(theory_model(linkage, num_modes)));
  std::optional<double> found;
  for (const GrowthLook& look : growth_looks) {
    const PeriodicMotion motion = corrected_motion(speed, rods, errors, num_modes, look);
    const StabilityOptions options{.tolerance = look.tolerance, .leading_only = true, .growth_suffices = true};
    const Growth linear = linear_growth(first_modes, speed, options);
    const Stability exact = motion_stability(system, motion, options);
    const double change = std::abs(exact.growth_rate - linear.rate), error = exact.growth_error + linear.error;
    if (std::isfinite(change) && std::isfinite(error)) found = std::max(change, error);
    if (error <= growth_settled * change) break;
  }
  return found;
}

}  // namespace hb
