// What a rod carries over the turn, beside what the theory of small deflections allows for.
#pragma once

#include <optional>

#include "lib/linkage/linkage.hpp"
#include "lib/rod/rod.hpp"

namespace hb {

// Of the rod's own buckling load, of l, and of strain: above these an answer is beyond small deflections.
constexpr double buckling_share_limit = 0.5, deflection_share_limit = 1.0 / 20, strain_limit = 0.005;

// Forces mass length/time^2, stresses mass/(length time^2). Axial forces are those of the rigid mechanism, as the
// theory takes them, largest over rod and turn.
struct RodStress {
  double tension = 0, compression = 0;  // largest axial forces, both >= 0
  double force_error = 0;  // of both: Fourier coefficients left out and rounding
  double buckling_load = 0;  // pi^2 EJ/l^2, of the rod pinned at both ends
  double axial = 0;  // max |N|/F
  double axial_error = 0;  // force_error/F
  double bending = 0;  // max |M| e/J, e = half of the section's height
  std::optional<double> bending_error;  // where that of M is known
  double strain = 0;  // (axial + bending)/E: no less than the largest of any place and time
  bool height_known = true;  // else e is that of a rectangle of area F and second moment J: e^2 = 3 J/F

  double buckling_share() const { return compression / buckling_load; }
  double buckling_share_error() const { return force_error / buckling_load; }
};

// f_2, f_3, f_4 at one speed, lib/README.md (M4).
[[nodiscard]] FourierSeries axial_series(const RodCoefficients& rod, double speed);

// `tail`: LinkageCoefficients::tail. `bending_moment`: its largest value over rod and turn (rod_shape), `moment_error`
// that of PeakErrors.
[[nodiscard]] RodStress rod_stress(const Body& link, const RodCoefficients& rod, double tail, double speed,
                                   double bending_moment, std::optional<double> moment_error = std::nullopt);

}  // namespace hb
