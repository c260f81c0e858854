// A periodic motion as samples of one turn.
#pragma once

#include <Eigen/Core>

#include "hb/engine/time/time_integration.hpp"

namespace hb {

// The state over one turn at tau_j = 2 pi j/N; ' = d/dtau.
struct PeriodicOrbit {
  Eigen::MatrixXd q, q1, q2;  // I x N
};

// From states (x; v) of the scaled motion at the same angles.
[[nodiscard]] PeriodicOrbit orbit_of(ScaledMotion& motion, const Eigen::MatrixXd& states);

}  // namespace hb
