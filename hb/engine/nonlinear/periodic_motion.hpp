// A periodic motion of a nonlinear forced system at one parameter by harmonic balance, with as many harmonics and
// samples as its accuracy takes.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "hb/engine/nonlinear/nonlinear_system.hpp"
#include "lib/fourier/fourier.hpp"

namespace hb {

struct MotionOptions {
  double tolerance = 1e-9;  // wanted: max_t |error| / max_t |q|
  int turns = 1;  // T: period 2 pi T/Omega
  int num_harmonics = 0;  // of Omega/T; 0: chosen by the solver
  int max_harmonics = 256;
  int max_factorisations = 60;
  std::function<bool()> stop = {};  // true ends the work; asked often
};

enum class MotionStatus {
  converged,  // error_bound <= tolerance
  not_reached,  // a motion, but error_bound > tolerance
  no_motion,  // Newton's method found none from its start
  no_residual,  // it came to where r does not exist; see failure
  stopped,
};

struct PeriodicMotion {
  MotionStatus status = MotionStatus::no_motion;
  std::optional<EvaluationFailure> failure;  // the last place that was met where r does not exist
  double parameter = 0;
  double speed = 0;  // Omega, rad per unit time
  int turns = 1;
  FourierSeries q;  // n components; harmonic k is k Omega/T. Without a motion: the last iterate
  FourierSeries q_finer;  // the same with twice the samples and more harmonics; empty where that failed
  // Estimates of max_t |error of q_i|, n: difference to the finer motion, what is left of both iterations, rounding as
  // it shows in the last corrections.
  Eigen::VectorXd error;
  double error_bound = 0;  // estimate of max_t |error| / max_t |q|, both in the norm max_i |q_i|
  // On a branch the error is that of a motion at a parameter that may differ by this; 0 at a given parameter.
  double parameter_error = 0;
  int num_harmonics = 0, num_samples = 0;
  int factorisations = 0;
  long evaluations = 0;  // samples of r
};

// From `start`, whose harmonics count in Omega/T (no columns: from rest, where the first step of Newton's method is the
// linear response). Throws std::invalid_argument for options or a start that cannot be.
[[nodiscard]] PeriodicMotion solve_periodic_motion(const NonlinearSystem& system, double parameter,
                                                   const FourierSeries& start, const MotionOptions& options = {});

// The same motion over `times` as many turns: harmonic k becomes harmonic `times` k.
[[nodiscard]] FourierSeries repeated(const FourierSeries& q, int times);

[[nodiscard]] const char* to_string(MotionStatus status);

}  // namespace hb
