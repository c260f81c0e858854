#include "lib/hill_system.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "lib/dense.hpp"
#include "lib/parts.hpp"

namespace hb {

namespace {

// S0 + Omega S1 + Omega^2 S2, with as many harmonics as the longest has.
FourierSeries at_speed(const std::array<FourierSeries, 3>& powers, Eigen::Index num_components, double speed) {
  Eigen::Index H = 0;
  for (const FourierSeries& series : powers) H = std::max(H, series.num_harmonics());
  FourierSeries sum = powers[0].c.size() > 0 ? fourier::resized(powers[0], H) : FourierSeries(num_components, H);
  double factor = 1;
  for (std::size_t p = 1; p < powers.size(); ++p) {
    factor *= speed;
    if (powers[p].c.size() > 0) parts(sum.c).leftCols(powers[p].c.cols()) += factor * parts(powers[p].c);
  }
  return sum;
}

void require(bool condition, const std::string& message) {
  if (!condition) throw std::invalid_argument("HillSystem: " + message);
}

void require_series(const FourierSeries& series, Eigen::Index num_components, const std::string& name) {
  if (series.c.size() == 0) return;
  require(series.num_components() == num_components, name + " has " + std::to_string(series.num_components()) +
                                                         " components, " + std::to_string(num_components) + " wanted");
  require(series.c.allFinite(), name + " has entries that are not finite");
}

}  // namespace

FourierSeries stiffness_at(const HillSystem& system, double speed) {
  return at_speed(system.stiffness, system.num_modes() * system.num_modes(), speed);
}

FourierSeries load_at(const HillSystem& system, double speed) {
  return at_speed(system.load, system.num_modes(), speed);
}

void validate(const HillSystem& system) {
  const Eigen::Index I = system.num_modes();
  require(I > 0 && system.mass.cols() == I, "mass must be square and not empty");
  require(system.damping.rows() == I && system.damping.cols() == I, "damping must have the size of mass");
  require(system.mass.allFinite(), "mass has entries that are not finite");
  require(system.damping.allFinite(), "damping has entries that are not finite");
  require(dense::is_invertible(system.mass), "mass is singular");
  for (int p = 0; p < 3; ++p) {
    require_series(system.stiffness[p], I * I, "stiffness (power " + std::to_string(p) + ")");
    require_series(system.load[p], I, "load (power " + std::to_string(p) + ")");
  }
}

}  // namespace hb
