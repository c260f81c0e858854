// Loop closure in closed form: positions and exact first and second derivatives over the crank angle tau. Geometry
// does not know the speed: d/dt = Omega d/dtau.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "lib/linkage/linkage.hpp"

namespace hb {

// Motion of one body's frame at one crank angle; ' = d/dtau.
struct BodyMotion {
  std::complex<double> z, z1, z2;  // origin (joint 0; for a slider its joint), z', z''
  std::complex<double> e = 1;  // e^{i phi}, phi the body's angle
  double phi1 = 0, phi2 = 0;  // phi', phi'' (zero for a slider)

  // Position, first and second derivative of a point given in the body frame.
  std::complex<double> position(std::complex<double> p) const { return z + e * p; }
  std::complex<double> velocity(std::complex<double> p) const { return z1 + std::complex<double>(0, phi1) * e * p; }
  std::complex<double> acceleration(std::complex<double> p) const {
    return z2 + std::complex<double>(-phi1 * phi1, phi2) * e * p;
  }
};

// All bodies (numbered as in linkage.hpp) at one crank angle. Requires a linkage that closes there (check with
// `find_obstruction`); at an angle where it does not close the result holds NaN.
[[nodiscard]] std::vector<BodyMotion> motion_at(const Linkage& linkage, double crank_angle);
void motion_at(const Linkage& linkage, double crank_angle, std::vector<BodyMotion>& motion);

// Why a linkage cannot turn through: at this crank angle this dyad does not close, or stands in a dead centre
// (coupler and rocker in line, coupler at right angles to the guide).
struct Obstruction {
  int dyad = 0;
  double crank_angle = 0;  // rad, in [0, 2 pi)
  bool dead_centre = false;  // closes only just (|sin of the transmission angle| below 1e-6); else: does not close
  std::string message;  // one sentence: dyad's links, angle in degrees, what happens
};

// Searches the whole turn (not only a grid: minima of the closing margin are located); empty if the mechanism turns
// freely.
[[nodiscard]] std::optional<Obstruction> find_obstruction(const Linkage& linkage);

}  // namespace hb
