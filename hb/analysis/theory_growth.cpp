#include "hb/analysis/theory_growth.hpp"

#include <algorithm>
#include <cmath>

#include "hb/engine/exponents/mode_lines.hpp"
#include "hb/engine/exponents/radau_turn.hpp"
#include "hb/engine/exponents/rough_growth.hpp"
#include "hb/engine/system/periodic_system.hpp"
#include "lib/constants.hpp"
#include "lib/dense.hpp"

namespace hb {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index most_growth_modes = 2;  // higher ones change the six-link mechanism's value by 1 %
// Harmonics of q + dq below the first of the largest are left out; those above the second are apart at the angles of
// the first look.
constexpr double negligible = 1e-6, apart = 1e-4;
constexpr Index fewest_angles = 24;
constexpr Index points_beside_modes = 5;
// What an answer may be off by.
constexpr GrowthAccuracy growth_accuracy{.of_change = 0.02, .of_rate = 1e-7};
// Twice the angles leave about the square of what they change, which may be this part of the answer.
constexpr double look_settled = 0.07;
// Cells of a turn for each oscillation of the fastest mode, look by look.
constexpr double cells_per_oscillation[] = {0.8, 2.4, 3.6, 4.8};
constexpr Index fewest_cells = 12, most_cells = 100000;

// The first modes of a linear system, alone: alpha = M^-1 C/Omega^2, beta = M^-1 B/Omega.
PeriodicCoefficients first_modes_of(const HillSystem& system, double speed, Index kept) {
  const Index n = system.num_modes();
  const MatrixXd per_mass = dense::inverse(MatrixXd(system.mass.topLeftCorner(kept, kept)));
  Index H = 0;
  for (const FourierSeries& C : system.stiffness) H = std::max(H, C.num_harmonics());
  PeriodicCoefficients part{FourierSeries(kept * kept, H), FourierSeries(kept * kept, 0), kept};
  double power = 1 / (speed * speed);
  for (const FourierSeries& C : system.stiffness) {
    for (Index j = 0; j < kept && C.c.size() > 0; ++j)
      part.alpha.c.block(kept * j, 0, kept, C.c.cols()) += power * C.c.middleRows(n * j, kept);
    power *= speed;
  }
  for (Index j = 0; j < kept; ++j) {
    auto columns = part.alpha.c.middleRows(kept * j, kept);
    columns = per_mass.lazyProduct(columns).eval();
  }
  part.beta.c.col(0).real() = (per_mass * system.damping.topLeftCorner(kept, kept) / speed).reshaped();
  return part;
}

// The variations about q + dq, which need not be a motion of the exact model, at every `step`th of N angles from
// `first`; empty where the model ends.
std::optional<NormalForm> variations(const ExactModel& model, double speed, const std::vector<FourierSeries>& motion,
                                     Index N, Index first, Index step) {
  Index finer = 1;
  for (const FourierSeries& q : motion)
    while (finer * N < 2 * q.num_harmonics() + 2) finer *= 2;
  const RitzSamples all = ritz_samples(motion, speed, finer * N);
  const Index count = N / step;
  const auto at = [&](const MatrixXd& samples) -> MatrixXd {
    return samples(Eigen::all, Eigen::seqN(finer * first, count, finer * step));
  };
  const auto crank_angle = [N](Index j) { return two_pi * double(j) / double(N); };
  const CrankAngles angles(model.linkage(), Eigen::VectorXd(Eigen::VectorXd::LinSpaced(count, crank_angle(first),
                                                                                       crank_angle(N - step + first))));
  ExactResidual exact = model.linearised(speed, angles, {at(all.q), at(all.q1), at(all.q2)});
  if (exact.breakdown) return std::nullopt;
  return normal_form({speed, std::move(exact.by_q2), std::move(exact.by_q1), std::move(exact.by_q)});
}

// Samples at N angles, those of all harmonics.
MatrixXd sampled(const FourierSeries& series, Index N) {
  Index finer = 1;
  while (finer * N < 2 * series.num_harmonics() + 2) finer *= 2;
  return fourier::synthesise(series, finer * N)(Eigen::all, Eigen::seqN(0, N, finer));
}

// Columns of both in turn.
MatrixXd interleaved(const MatrixXd& even, const MatrixXd& odd) {
  MatrixXd all(even.rows(), 2 * even.cols());
  all(Eigen::all, Eigen::seqN(0, even.cols(), 2)) = even;
  all(Eigen::all, Eigen::seqN(1, even.cols(), 2)) = odd;
  return all;
}

Index most_harmonics(const std::vector<FourierSeries>& motion, double relative) {
  Index H = 0;
  for (const FourierSeries& q : motion) H = std::max(H, fourier::significant_harmonics(q, relative));
  return H;
}

// Both by as many cells and by the harmonics that the angles tell.
GrowthChange propagated(const NormalForm& exact, const std::vector<PeriodicCoefficients>& rods, Index num_cells) {
  const Index told = (exact.alpha.cols() - 1) / 2;
  GrowthChange found{-HUGE_VAL, 0};
  for (const PeriodicCoefficients& rod : rods) {
    const FourierSeries alpha = fourier::resized(rod.alpha, std::min(rod.alpha.num_harmonics(), told));
    found.linear = std::max(found.linear, rough_growth({alpha, rod.beta, rod.num_modes}, num_cells));
  }
  const PeriodicCoefficients all{fourier::analyse(exact.alpha), fourier::analyse(exact.beta), exact.num_modes()};
  found.change = rough_growth(all, num_cells) - found.linear;
  return found;
}

// Cells over which Radau damps the modes that may lead by less than a tenth of `enough`; those damped twice as much as
// the fastest growth do not.
double resolving_cells(const NormalForm& exact, double largest_growth, double enough) {
  const Index n = exact.num_modes();
  const Eigen::VectorXd frequency = exact.weights();
  double cells = 0;
  for (Index i = 0; i < n; ++i) {
    const double mean_growth = -exact.beta.row(i * (n + 1)).mean() / 2;
    if (mean_growth < largest_growth - std::max(std::abs(largest_growth), 0.01)) continue;
    cells = std::max(cells, rough_oscillator_cells(frequency(i), 0.1 * enough));
  }
  return cells;
}

// Whether the last look, which changed the answer by so much, is near enough.
bool settles(const GrowthChange& growth, double changed) {
  return changed <= std::max(look_settled * std::abs(growth.change), growth_accuracy.allowed(0, growth.linear));
}

// The variations at more and more angles.
class Looks {
 public:
  Looks(const ExactModel& model, double speed, const std::vector<FourierSeries>& motion,
        const std::vector<PeriodicCoefficients>& rods)
      : model_(model),
        speed_(speed),
        motion_(motion),
        rods_(rods),
        most_angles_(24 * most_harmonics(motion, 0) + 4 * fewest_angles),
        N_(fourier::fast_length(std::max(fewest_angles, 2 * most_harmonics(motion, apart) + 2))),
        exact_(variations(model, speed, motion, N_, 0, 1)) {}

  // |change of the growth rate|, at least what the last look changed it by; empty where the model ends, or where
  // nothing settles.
  std::optional<double> settled() {
    if (!exact_) return std::nullopt;
    std::optional<double> found = by_lines();
    if (!exact_) return std::nullopt;
    return found ? found : by_propagation();
  }

 private:
  // Less the linear rods.
  NormalForm change() const {
    NormalForm less = *exact_;
    const Index n = less.num_modes();
    Index first = 0;
    for (const PeriodicCoefficients& rod : rods_) {
      const Index m = rod.num_modes;
      const MatrixXd alpha = sampled(rod.alpha, N_);
      for (Index j = 0; j < m; ++j) {
        const Index row = first + n * (first + j);
        less.alpha.middleRows(row, m) -= alpha.middleRows(m * j, m);
        less.beta.middleRows(row, m).colwise() -= rod.beta.c.col(0).real().segment(m * j, m);
      }
      first += m;
    }
    return less;
  }

  // Twice the angles; false where that is too many, or the model ends.
  bool refine() {
    if (2 * N_ > most_angles_) return false;
    N_ *= 2;
    const std::optional<NormalForm> odd = variations(model_, speed_, motion_, N_, 1, 2);
    if (odd)
      exact_ = {interleaved(exact_->alpha, odd->alpha), interleaved(exact_->beta, odd->beta)};
    else
      exact_.reset();
    return odd.has_value();
  }

  // Empty where the modes' lines do not settle.
  std::optional<double> by_lines() {
    std::optional<double> told;
    do {
      const std::optional<GrowthChange> found = UncoupledSystems(rods_, N_).growth(change(), growth_accuracy);
      if (!found) return std::nullopt;
      const double size = std::abs(found->change), changed = std::abs(found->change - found->by_half);
      told = speed_ * std::max(size, changed);
      if (settles(*found, changed)) break;
    } while (refine());
    return told;
  }

  std::optional<double> by_propagation() {
    std::optional<double> found;
    double last = HUGE_VAL, resolving = 0;
    for (std::size_t look = 0;; ++look) {
      const double per_oscillation = cells_per_oscillation[std::min(look, std::size(cells_per_oscillation) - 1)];
      const double least = std::max({resolving, per_oscillation * exact_->weights().maxCoeff(), double(N_ / 2)});
      if (!(least < double(most_cells))) return found;
      const Index cells = radau_cells(std::max(fewest_cells, Index(std::ceil(least))));
      const GrowthChange at = propagated(*exact_, rods_, cells);
      const double size = std::abs(at.change), changed = std::abs(at.change - last);
      if (std::isfinite(changed)) found = speed_ * std::max(size, changed);
      resolving = resolving_cells(*exact_, at.linear + at.change, growth_accuracy.allowed(at.change, at.linear));
      if (settles(at, changed) && resolving <= double(cells)) return found;
      last = at.change;
      if (!refine()) return exact_ ? found : std::nullopt;
    }
  }

  const ExactModel& model_;
  double speed_;
  const std::vector<FourierSeries>& motion_;
  const std::vector<PeriodicCoefficients>& rods_;
  Index most_angles_, N_;
  std::optional<NormalForm> exact_;
};

}  // namespace

// The exponents of (T5): those of the exact model linearised about q + dq.
std::optional<double> growth_theory_error(const Linkage& linkage, double speed, std::span<const LinearRod> rods,
                                          const TheoryErrors& errors) {
  const std::vector<int> links = elastic_links(linkage);
  std::vector<Index> num_modes;
  std::vector<PeriodicCoefficients> linear;
  std::vector<FourierSeries> motion;
  for (std::size_t r = 0; r < rods.size(); ++r) {
    if (!errors.rods[r].q || body_at(linkage, links[r])->elastic->shear) return std::nullopt;
    const Index kept = std::min(most_growth_modes, rods[r].q->num_components());
    num_modes.push_back(kept);
    linear.push_back(first_modes_of(*rods[r].system, speed, kept));
    const FourierSeries moved = fourier::sum(*rods[r].q, errors.rods[r].correction);
    motion.emplace_back(
        Eigen::MatrixXcd(moved.c.topLeftCorner(kept, 1 + fourier::significant_harmonics(moved, negligible))));
  }
  return Looks(theory_model(linkage, num_modes, points_beside_modes), speed, motion, linear).settled();
}

}  // namespace hb
