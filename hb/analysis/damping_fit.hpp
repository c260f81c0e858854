// The damping of one mode from a measurement of it: a free vibration that dies out, or a resonance peak.
#pragma once

#include <Eigen/Core>

namespace hb {

struct DampingFit {
  double frequency = 0;  // omega_0 of the undamped mode, rad per unit of the measured time
  double ratio = 0;  // zeta: decay rate over omega_0
  double frequency_error = 0, ratio_error = 0;  // standard errors of least squares, independent equal errors assumed
  Eigen::VectorXd fitted;  // the curve at the measured places
  double residual = 0;  // rms of measured - fitted over rms of measured (less its mean, of a decay)
};

// x(t) = e^(-zeta omega_0 t) (a cos omega_d t + b sin omega_d t) + c,     omega_d^2 = omega_0^2 (1 - zeta^2)
// at increasing times. Throws RequestError (field decay) for fewer than 8 values, values that do not change, and
// records that hold less than one period or fewer than three values in each.
[[nodiscard]] DampingFit fit_decay(const Eigen::VectorXd& t, const Eigen::VectorXd& x);

// |X|(omega) = a/sqrt((omega_0^2 - omega^2)^2 + (2 zeta omega_0 omega)^2)
// at increasing frequencies > 0: the mode's displacement under a harmonic force of constant size. Throws RequestError
// (field peak) for fewer than 5 values, negative ones, and a largest one at either end.
[[nodiscard]] DampingFit fit_peak(const Eigen::VectorXd& omega, const Eigen::VectorXd& amplitude);

}  // namespace hb
