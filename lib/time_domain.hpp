// A linear periodic system evaluated where an integrator stands, at one speed:
//     M q'' + B q' + C(tau) q = h(tau)          ' = d/dt, tau = Omega t
// The time-domain path of the program: it shares nothing with the Fourier series that harmonic balance works on.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "lib/hill_system.hpp"

namespace hb {

struct TimeDomainSystem {
  double speed = 0;  // Omega, rad per unit time
  Eigen::MatrixXd mass;  // M, I x I, invertible
  Eigen::MatrixXd damping;  // B, I x I
  // Writes C (I x I) and h (I) at crank angle tau. Keeps scratch: one call at a time.
  std::function<void(double tau, Eigen::Ref<Eigen::MatrixXd> C, Eigen::Ref<Eigen::VectorXd> h)> evaluate;

  Eigen::Index num_modes() const { return mass.rows(); }
};

// The cosines and sines of the series added up term by term. Throws std::invalid_argument for a speed that is not
// positive and finite.
[[nodiscard]] TimeDomainSystem time_domain_system(const HillSystem& system, double speed);

}  // namespace hb
