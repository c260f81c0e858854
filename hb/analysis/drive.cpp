#include "hb/analysis/drive.hpp"

#include <cmath>

namespace hb {

// With T = sum of c_k e^{i k tau/n}, n turns: mean c_0, mean square |c_0|^2 + 2 sum |c_k|^2, and E = int (T - c_0)
// dtau, whose coefficients are n c_k/(i k).
Drive drive_of(const FourierSeries& torque, double speed, int turns) {
  Drive drive;
  if (torque.num_harmonics() < 0) return drive;
  const Range range = fourier::range(torque, 0);
  drive.mean = torque.c(0, 0).real();
  drive.rms = std::sqrt(std::norm(torque.c(0, 0)) + 2 * torque.c.row(0).tail(torque.num_harmonics()).squaredNorm());
  drive.mean_power = speed * drive.mean;
  drive.rms_power = speed * drive.rms;
  drive.largest_power = speed * range.max.value;
  drive.smallest_power = speed * range.min.value;
  FourierSeries energy(1, torque.num_harmonics());
  for (Eigen::Index k = 1; k <= torque.num_harmonics(); ++k)
    energy.c(0, k) = static_cast<double>(turns) * torque.c(0, k) / std::complex<double>(0, static_cast<double>(k));
  const Range stored = fourier::range(energy, 0);
  drive.energy_fluctuation = stored.max.value - stored.min.value;
  return drive;
}

// Energy J (w_max^2 - w_min^2)/2 = J Omega (w_max - w_min).
double speed_fluctuation(const Drive& drive, double inertia, double speed) {
  return drive.energy_fluctuation / (inertia * speed * speed);
}

}  // namespace hb
