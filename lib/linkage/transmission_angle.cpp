#include "lib/linkage/transmission_angle.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <variant>
#include <vector>

#include "lib/linkage/kinematics.hpp"

namespace hb {
namespace {

// sin of the transmission angle of one dyad.
double sine_at(const Linkage& linkage, int dyad, double crank_angle, std::vector<BodyMotion>& motion) {
  motion_at(linkage, crank_angle, motion);
  const std::complex<double> coupler = motion[static_cast<std::size_t>(coupler_index(dyad))].e;
  const std::complex<double> closing = motion[static_cast<std::size_t>(closing_index(dyad))].e;
  const std::complex<double> turned = coupler * std::conj(closing);
  const bool is_slider = std::holds_alternative<Slider>(linkage.dyads[static_cast<std::size_t>(dyad)].closing);
  return std::abs(is_slider ? turned.real() : turned.imag());
}

}  // namespace

TransmissionAngle transmission_angle(const Linkage& linkage, int dyad) {
  constexpr int num_samples = 720;
  constexpr double step = 2 * std::numbers::pi / num_samples;
  std::vector<BodyMotion> motion;
  int worst = 0;
  double smallest = 2;
  for (int j = 0; j < num_samples; ++j) {
    const double sine = sine_at(linkage, dyad, j * step, motion);
    if (sine < smallest) smallest = sine, worst = j;
  }
  // Golden section about the smallest sample.
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  double low = (worst - 1) * step, high = (worst + 1) * step;
  while (high - low > 1e-9) {
    const double left = high - ratio * (high - low), right = low + ratio * (high - low);
    if (sine_at(linkage, dyad, left, motion) <= sine_at(linkage, dyad, right, motion)) {
      high = right;
    } else {
      low = left;
    }
  }
  const double angle = (low + high) / 2;
  const double sine = std::min(smallest, sine_at(linkage, dyad, angle, motion));
  const double turn = 2 * std::numbers::pi;
  // A smooth minimum is found to the root of rounding: what lies that near to a full turn is its beginning.
  const double in_turn = angle < 0 ? angle + turn : angle;
  return {std::asin(std::min(1.0, sine)), turn - in_turn <= 1e-7 ? 0 : in_turn};
}

}  // namespace hb
