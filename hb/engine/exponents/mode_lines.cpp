#include "hb/engine/exponents/mode_lines.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "hb/engine/exponents/mode_line.hpp"
#include "lib/constants.hpp"

namespace hb {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace mode_lines {

// The largest of all, and its line.
struct Leading {
  double growth = -HUGE_VAL;
  Line* line = nullptr;
};

// Lines of which the one that grows fastest is asked for, order by order. One that is behind it by far more than the
// last order moved both is left out.
class Race {
 public:
  void add(const LoneModes& modes, const Coupling& coupling, Index l) {
    runners_.push_back({std::make_unique<Line>(modes, coupling, l)});
  }

  // With one order more; not a number where a line has none.
  Leading next() {
    Leading leading;
    double leading_moved = 0;
    mixed_ = 0;
    for (Runner& runner : runners_) {
      const double growth = runner.line->next();
      if (!std::isfinite(growth)) return {nan, runner.line.get()};
      mixed_ = std::max(mixed_, runner.line->mixed());
      runner.moved = std::abs(growth - runner.growth);
      runner.growth = growth;
      if (growth > leading.growth) {
        leading = {growth, runner.line.get()};
        leading_moved = runner.moved;
      }
    }
    constexpr double far = 10;
    std::erase_if(runners_, [&](const Runner& runner) {
      return runner.growth < leading.growth - far * (runner.moved + leading_moved);
    });
    return leading;
  }

  // Largest |z_j| of all that were in the race for the last order.
  double mixed() const { return mixed_; }

 private:
  struct Runner {
    std::unique_ptr<Line> line;
    double growth = HUGE_VAL, moved = HUGE_VAL;
  };
  std::vector<Runner> runners_;
  double mixed_ = 0;
};

}  // namespace mode_lines

double GrowthAccuracy::allowed(double change, double rate) const {
  return std::max(of_change * std::abs(change), of_rate * std::max(std::abs(rate), 0.01));
}

struct UncoupledSystems::Impl {
  struct Part {
    Index first;
    mode_lines::LoneModes modes;
    MatrixXd alpha, beta;  // without what the modes alone feel; M x count*count
    mode_lines::Coupling coupling;
  };

  Index M;
  std::optional<mode_lines::LoneModes> modes;
  std::vector<Part> parts;
  std::vector<Index> leading;  // modes that may lead
  mode_lines::Race lines;  // theirs
  std::vector<double> orders;  // the largest growth rate, so far

  Impl(std::span<const PeriodicCoefficients> systems, Index num_angles) : M(num_angles) {
    Index n = 0;
    for (const PeriodicCoefficients& system : systems) n += system.num_modes;
    MatrixXd stiffness(M, n);
    VectorXd damping(n);
    std::vector<MatrixXd> alphas;
    Index first = 0;
    for (const PeriodicCoefficients& system : systems) {
      const Index m = system.num_modes;
      alphas.push_back(mode_lines::at_angles(system.alpha, M));
      for (Index i = 0; i < m; ++i) {
        stiffness.col(first + i) = alphas.back().col(i * (m + 1));
        damping(first + i) = system.beta.c(i * (m + 1), 0).real();
      }
      first += m;
    }
    modes = mode_lines::lone_modes(stiffness, damping);
    if (!modes) return;
    first = 0;
    for (std::size_t r = 0; r < systems.size(); ++r) {
      const Index m = systems[r].num_modes;
      MatrixXd beta = systems[r].beta.c.col(0).real().transpose().replicate(M, 1);
      for (Index i = 0; i < m; ++i) {
        alphas[r].col(i * (m + 1)) = modes->left_out.col(first + i);
        beta.col(i * (m + 1)).setZero();
      }
      mode_lines::LoneModes own = modes->part(first, m);
      mode_lines::Coupling coupling(own, alphas[r], beta);
      parts.push_back({first, std::move(own), std::move(alphas[r]), std::move(beta), std::move(coupling)});
      first += m;
    }
    const double largest = -damping.minCoeff() / 2, least = largest - std::max(std::abs(largest), 0.01);
    for (const Part& part : parts)
      for (Index i = 0; i < part.modes.num_modes(); ++i)
        if (-part.modes.damping(i) / 2 >= least) {
          leading.push_back(part.first + i);
          lines.add(part.modes, part.coupling, i);
        }
  }

  double linear(std::size_t order) {
    while (orders.size() <= order) orders.push_back(lines.next().growth);
    return orders[order];
  }
};

UncoupledSystems::UncoupledSystems(std::span<const PeriodicCoefficients> parts, Index num_angles)
    : impl_(std::make_unique<Impl>(parts, num_angles)) {}

UncoupledSystems::~UncoupledSystems() = default;

std::optional<GrowthChange> UncoupledSystems::growth(const NormalForm& change, const GrowthAccuracy& accuracy) {
  constexpr std::size_t most_orders = 12;
  // Lines more mixed than that may be locked to each other, which shows in no real part at first: two that are have 1/2
  // at least.
  constexpr double most_mixed = 0.3;
  // Orders to come, each at most `geometric` of the one before, change the answer by less than this part of what is
  // allowed.
  constexpr double settled = 0.1, geometric = 0.5;
  if (!impl_->modes) return std::nullopt;
  const mode_lines::LoneModes& modes = *impl_->modes;
  const Index n = modes.num_modes(), M = modes.num_angles();
  const auto coupling_by = [&](const MatrixXd& alpha_samples, const MatrixXd& beta_samples) {
    const auto at_angles = [M](const MatrixXd& samples) -> MatrixXd {
      if (samples.cols() == M) return samples.transpose();
      return mode_lines::at_angles(fourier::analyse(samples), M);
    };
    MatrixXd alpha = at_angles(alpha_samples), beta = at_angles(beta_samples);
    for (const Impl::Part& part : impl_->parts)
      for (Index m = part.modes.num_modes(), j = 0; j < m; ++j) {
        const Index column = part.first + n * (part.first + j);
        alpha.middleCols(column, m) += part.alpha.middleCols(m * j, m);
        beta.middleCols(column, m) += part.beta.middleCols(m * j, m);
      }
    return mode_lines::Coupling(modes, alpha, beta);
  };
  const mode_lines::Coupling coupling = coupling_by(change.alpha, change.beta);
  mode_lines::Race lines;
  for (const Index l : impl_->leading) lines.add(modes, coupling, l);

  double last = HUGE_VAL, last_moved = HUGE_VAL;
  for (std::size_t order = 0; order < most_orders; ++order) {
    const mode_lines::Leading leading = lines.next();
    const double mixed = lines.mixed();
    if (!(mixed <= most_mixed)) return std::nullopt;
    const double linear = impl_->linear(order), found = leading.growth - linear;
    if (!std::isfinite(found)) return std::nullopt;
    const double moved = found - std::exchange(last, found), ratio = moved / std::exchange(last_moved, moved);
    if (order < 2) continue;
    const double rate = std::max(std::abs(ratio), mixed);
    const bool foreseen = rate <= geometric;
    const double to_come = foreseen ? moved * rate / (1 - rate) : moved;
    if (!(std::abs(to_come) <= settled * accuracy.allowed(found, linear))) continue;
    // The leading line once more, from where it is.
    const auto half = Eigen::seqN(0, change.alpha.cols() / 2, 2);
    const mode_lines::Coupling by_half = coupling_by(change.alpha(Eigen::all, half), change.beta(Eigen::all, half));
    leading.line->feel(by_half);
    leading.line->next();
    return GrowthChange{linear, foreseen ? found + moved * ratio / (1 - ratio) : found,
                        leading.line->next() - impl_->linear(order + 2)};
  }
  return std::nullopt;
}

}  // namespace hb
