// Periodic steady state of M q'' + B q' + C(Omega t) q = h(Omega t) by harmonic balance: the block Hill system
//     D(k) x_k + sum_m E_{k-m} x_m = f_k,   D(k) = (-k^2 + i k b_i + w_i^2),   k = -H..H, x_-k = conj(x_k).
#pragma once

#include <string>

#include "hb/engine/system/scaled_system.hpp"
#include "lib/fourier/fourier.hpp"
#include "lib/hill_system.hpp"

namespace hb {

enum class SteadyMethod {
  automatic,  // direct where it is cheap, else iterative with direct behind it
  direct,  // half-spectrum block elimination from the outer harmonics, refined by the residual
  iterative,  // GMRES with FFT products, preconditioned mode by mode
};

enum class SteadyBound {
  estimated,  // the error solved for from the exact residual, with the contraction measured
  proved,  // Newton-Kantorovich, for single points: dense in I (2H+1) unknowns
};

struct SteadyOptions {
  double tolerance = 1e-10;  // wanted: max_t |error| / max_t |q|
  int num_harmonics = 0;  // 0: chosen by the solver
  int max_harmonics = 4096;  // give up beyond
  SteadyMethod method = SteadyMethod::automatic;
  SteadyBound bound = SteadyBound::estimated;
  // The solution alone, to a residual (each row divided by the size of its diagonal) of 0.03 of the tolerance or
  // rounding, whatever the response makes of it: error_bound is infinite, the status not_reached (or singular).
  bool without_bound = false;
  // Where the iteration begins, in given units; harmonics that it does not have are zero. Of another number of
  // components, as when empty: from zero.
  FourierSeries start = {};
};

enum class SteadyStatus {
  converged,  // error_bound <= tolerance
  not_reached,  // a result, but error_bound > tolerance
  singular,  // at resonance without damping: no (unique) periodic solution to working accuracy; q is empty
};

struct SteadyState {
  SteadyStatus status = SteadyStatus::not_reached;
  FourierSeries q;  // I components over the crank angle, given units
  int num_harmonics = 0;  // H used
  double error_bound = 0;  // bound on max_t |error| / max_t |q| (both in the norm max_i |q_i|), rounding included
  double residual = 0;  // sum over harmonics of |exact residual|, relative to |f|
  // Nearness to resonance: smallest singular value (estimate) of A, each row divided by the size of its diagonal
  // without cancellation, k^2 + |b k| + w^2; 1 far away, 0 at resonance. Response to a change of load grows like
  // 1/resonance_distance.
  double resonance_distance = 1;
  SteadyMethod method = SteadyMethod::direct;  // the one that gave the result
  SteadyBound bound = SteadyBound::estimated;  // what error_bound is; `estimated` where a proof was asked but not found
  int iterations = 0;  // matrix products, or factorisations if direct
};

[[nodiscard]] SteadyState solve_steady_state(const HillSystem& system, double speed, const SteadyOptions& options = {});
// The same where its scaled form at a speed is there already.
[[nodiscard]] SteadyState solve_steady_state(const HillSystem& system, const ScaledSystem& scaled,
                                             const SteadyOptions& options = {});
[[nodiscard]] SteadyState solve_steady_state(const ScaledSystem& system, const SteadyOptions& options = {});

}  // namespace hb
