// Periodic answers to loads to a few digits, without an error bound: one solve each on a predicted window of harmonics.
#pragma once

#include <memory>
#include <optional>

#include "hb/engine/system/scaled_system.hpp"

namespace hb {

// M q'' + B q' + C q = load at one speed, for one load after another: what depends on the system alone is kept.
class RoughSolver {
 public:
  // The system's own load is not looked at.
  RoughSolver(const HillSystem& system, double speed);
  // Of the system's scaled form and its mass.
  RoughSolver(const ScaledSystem& scaled, const Eigen::MatrixXd& mass);
  ~RoughSolver();
  RoughSolver(RoughSolver&&) noexcept;
  RoughSolver& operator=(RoughSolver&&) noexcept;

  // Over the crank angle, the residual of the window's rows below `tolerance` of the load; near resonance the error is
  // as many times larger as the response. The window of the first load serves all of no smaller tolerance. Empty where
  // the iteration does not get there: solve_steady_state finds out why. `near`: what the answer is near to, of the
  // first components alone, or nullptr; the difference is then told, too, however small, to the root of the tolerance.
  [[nodiscard]] std::optional<FourierSeries> solve(const FourierSeries& load, double tolerance,
                                                   const FourierSeries* near = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// How many times larger than without cancellation of stiffness and inertia one mode answers to the harmonic of the
// crank angle that is nearest to its resonance, with the mean stiffness; the largest of all modes.
[[nodiscard]] double nearest_amplification(const HillSystem& system, double speed);

}  // namespace hb
