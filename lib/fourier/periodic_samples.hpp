// Fourier series of functions that are known by samples over one turn.
#pragma once

#include <Eigen/Core>

#include "lib/fourier/fourier.hpp"

namespace hb {

// Trigonometric interpolant of equally spaced samples (components x N) at first + 2 pi j/N. For even N the Nyquist term
// stands as a cosine of the sample's own phase, so that the series passes through all samples. Harmonics that end the
// series below rounding of its largest are cut.
[[nodiscard]] FourierSeries interpolate(const Eigen::Ref<const Eigen::MatrixXd>& samples, double first = 0);

// Series of the periodic cubic spline (C2) through (angle_j, value_j), angles in rad, strictly increasing and spanning
// less than one turn; at least 3. The coefficients are the spline's own, exact up to rounding; the series ends where
// what is cut is below 1e-10 of the largest value over the turn, or at harmonic 4096.
[[nodiscard]] FourierSeries spline_series(const Eigen::Ref<const Eigen::VectorXd>& angles,
                                          const Eigen::Ref<const Eigen::VectorXd>& values);

}  // namespace hb
