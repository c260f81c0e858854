// A linear system with periodic coefficients,
//     M q'' + B q' + C(Omega t; Omega) q = h(Omega t; Omega)          ' = d/dt
// with C = C0 + Omega C1 + Omega^2 C2 and h alike: value type shared by linkages and by anyone who has such a system.
#pragma once

#include <Eigen/Core>
#include <array>

#include "lib/fourier/fourier.hpp"

namespace hb {

struct HillSystem {
  Eigen::MatrixXd mass;  // I x I, invertible
  Eigen::MatrixXd damping;  // I x I
  // C_p, p = 0, 1, 2: I*I components, column-major (component i + I*k is c_ik); an empty series (no columns) is zero.
  std::array<FourierSeries, 3> stiffness;
  // h_p, p = 0, 1, 2: I components; empty series is zero.
  std::array<FourierSeries, 3> load;

  Eigen::Index num_modes() const { return mass.rows(); }
};

// C(tau; Omega) and h(tau; Omega) at one speed (rad per unit time): the three powers added up.
[[nodiscard]] FourierSeries stiffness_at(const HillSystem& system, double speed);
[[nodiscard]] FourierSeries load_at(const HillSystem& system, double speed);

// Throws std::invalid_argument naming what is wrong: shapes, non-finite entries, singular mass.
void validate(const HillSystem& system);

}  // namespace hb
