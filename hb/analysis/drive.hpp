// The drive at constant speed: means and fluctuation of torque and power, and what a flywheel leaves of it.
#pragma once

#include "lib/fourier/fourier.hpp"

namespace hb {

struct Drive {
  double mean = 0, rms = 0;  // of the torque
  double mean_power = 0, rms_power = 0, largest_power = 0, smallest_power = 0;
  // Largest minus smallest value over the motion of the integral of torque - mean over the crank angle: the energy that
  // a flywheel takes up and gives back.
  double energy_fluctuation = 0;
};

// `torque` over the crank angle, one component, its harmonic k k/turns times a turn; speed in rad per unit time.
[[nodiscard]] Drive drive_of(const FourierSeries& torque, double speed, int turns = 1);

// (largest - smallest speed)/mean speed with all that turns at the crank's speed having this moment of inertia, in
// first order: the torque is still that of constant speed.
[[nodiscard]] double speed_fluctuation(const Drive& drive, double inertia, double speed);

}  // namespace hb
