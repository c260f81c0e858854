// Exponents in the frequency domain: solutions e^{s tau} sum_k x_k e^{i k tau} of x'' + G x' + K(tau) x = 0, one at a
// time, in a window of harmonics centred on the mode that s belongs to. No spectrum is computed and none sorted: what
// a truncated Hill matrix has at the edges of its window never enters.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "hb/engine/system/scaled_system.hpp"

namespace hb {

struct HillExponents {
  std::vector<std::complex<double>> s;  // per radian of crank angle, imaginary part not folded
  std::vector<double> error;  // see below
  std::vector<Eigen::Index> mode;  // whose window it was found in
};

// With L(s)_kl = ((s + ik)^2 + (s + ik) G) delta_kl + K_(k-l): Newton's method from the roots of each mode's mean
// equation, s <- s - (x x)/(x y) with L(s) y = L'(s) x. Windows grow until the harmonics left out do not matter. The
// error is the first-order effect of the whole residual, rows outside the window and rounding included, four times: |z
// r| / |z L' x| with z the left null vector; four times (E19) at least, where two exponents are nearly one. Exponents
// that do not converge are left out, and those whose window would have to be larger than 600 unknowns for the rows next
// to it, as many as it has, to be dominated by their diagonal.
[[nodiscard]] HillExponents hill_exponents(const ScaledSystem& system);

}  // namespace hb
