#include "hb/analysis/rod_steady.hpp"

#include <algorithm>

#include "hb/engine/steady/rough_state.hpp"
#include "lib/rod/shear.hpp"

namespace hb {
namespace {

double largest(const FourierSeries& series) {
  double value = 0;
  for (Eigen::Index i = 0; i < series.num_components(); ++i) value = std::max(value, fourier::max_abs(series, i).value);
  return value;
}

}  // namespace

SteadyState solve_rod(const HillSystem& system, Eigen::Index num_modes, double speed, const SteadyOptions& options) {
  return solve_rod(system, num_modes, scale_system(system, speed), options);
}

// q_i = a_i + b_i: |error of q_i| <= 2 bound max |unknowns|.
SteadyState solve_rod(const HillSystem& system, Eigen::Index num_modes, const ScaledSystem& scaled,
                      SteadyOptions options) {
  if (system.num_modes() == num_modes) return solve_steady_state(system, scaled, options);
  options.tolerance = std::max(options.tolerance / 4, std::min(options.tolerance, 1e-14));
  SteadyState state = solve_steady_state(system, scaled, options);
  if (state.q.c.size() == 0) return state;
  FourierSeries q = ritz_coordinates(state.q, num_modes);
  if (const double size = largest(q); size > 0) state.error_bound *= 2 * largest(state.q) / size;
  state.q = std::move(q);
  return state;
}

std::optional<FourierSeries> rough_rod(const HillSystem& system, Eigen::Index num_modes, double speed, double accuracy,
                                       const FourierSeries* near) {
  constexpr double of_residual = 0.1;
  if (system.num_modes() != num_modes) near = nullptr;  // other unknowns than q
  const std::optional<FourierSeries> q =
      RoughSolver(system, speed)
          .solve(load_at(system, speed), of_residual * accuracy / nearest_amplification(system, speed), near);
  if (!q) return std::nullopt;
  return ritz_coordinates(*q, num_modes);
}

}  // namespace hb
