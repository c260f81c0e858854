// Where a forced vibration is in its resonance curve: the speed of the nearest simple resonance, and how much larger
// the response is than that of the load applied slowly.
#pragma once

#include <optional>

#include "hb/engine/steady/steady_state.hpp"
#include "lib/hill_system.hpp"

namespace hb {

// r = omega_1/Omega with omega_1 the lowest natural frequency of the undamped system averaged over the turn at the
// speed Omega; 0 where its square is not positive.
[[nodiscard]] double frequency_ratio(const HillSystem& system, double speed);

struct NearestResonance {
  int order = 0;  // n of n Omega = omega_1
  double speed = 0;  // Omega there, rad per unit time
  double frequency = 0;  // omega_1 there, rad per unit time
};

// Where r = n: of all orders n >= 1 the one whose speed is nearest; empty where none is found (no positive mean
// stiffness, more than 60 unknowns).
[[nodiscard]] std::optional<NearestResonance> nearest_resonance(const HillSystem& system, double speed);

// The highest harmonic of a response that is above its error: resonances of higher orders it does not meet. 0: none.
[[nodiscard]] int highest_harmonic(const SteadyState& response);

// q_1..q_num_modes at equally spaced crank angles (columns) of the solution of C(tau; Omega) u = h(tau; Omega) at each
// crank angle by itself; u is q, or with shear its two parts (lib/rod/shear.hpp). Empty without a load and where C is
// singular or indefinite at some angle.
[[nodiscard]] std::optional<Eigen::MatrixXd> quasi_static_motion(const HillSystem& system, Eigen::Index num_modes,
                                                                 double speed);
// max over i and tau of its |q_i|; empty where that is 0, and for more than 60 unknowns, too.
[[nodiscard]] std::optional<double> quasi_static_response(const HillSystem& system, Eigen::Index num_modes,
                                                          double speed);

}  // namespace hb
