// Harmonic balance without any of the structure: the Hill system as one dense complex matrix. Yardstick for the time of
// the solvers and, refined at more harmonics, reference for their error.
#pragma once

#include "hb/engine/system/scaled_system.hpp"
#include "lib/fourier/fourier.hpp"

namespace hb::benchmarks {

// q with harmonics -H..H kept, by dense LU; each refinement takes its residual in long double.
[[nodiscard]] FourierSeries dense_hill_solution(const ScaledSystem& system, int num_harmonics, int num_refinements = 0);

// max_tau |q - reference| / max_tau |reference|, norm max_i |q_i|.
[[nodiscard]] double relative_error(const FourierSeries& q, const FourierSeries& reference);

// The same of q at equally spaced times over a turn, a column each.
[[nodiscard]] double relative_error(const Eigen::MatrixXd& samples, const FourierSeries& reference);

}  // namespace hb::benchmarks
