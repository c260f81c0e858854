// Integration in time of a nonlinear motion together with its variations, by CVODE.
#pragma once

#include <functional>
#include <span>

#include "hb/engine/time/time_integration.hpp"

namespace hb {

// q'' = a(tau, q, q'), ' = d/dtau, with derivatives: first-order form in numbers of order one,
//     x = q/q_scale,  u_i = q_i'/(q_scale w_i),     x' = W u,   u' = W^-1 a/q_scale,
// w about the frequencies per radian of crank angle.
struct AccelerationSamples {
  Eigen::VectorXd a;  // n
  Eigen::MatrixXd by_q, by_v;  // n x n: da/dq, da/dq'
};
struct NonlinearMotion {
  Eigen::VectorXd w;  // n
  double q_scale = 1;
  // False where a does not exist. Keeps scratch: one call at a time.
  std::function<bool(double tau, const Eigen::VectorXd& q, const Eigen::VectorXd& v, AccelerationSamples& result)>
      acceleration;

  Eigen::Index num_unknowns() const { return w.size(); }
};

// The state (x; u) at tau0 and all 2n variations of it over a stretch: columns of each of `states` are the state and
// the derivatives of the state by the initial one, 2n x (2n+1). Method adams or bdf; outputs ascend and are > tau0.
[[nodiscard]] Trajectory integrate_variations(const NonlinearMotion& motion, Integrator method, double tolerance,
                                              double tau0, const Eigen::VectorXd& state,
                                              std::span<const double> outputs, const std::function<bool()>& stop);

}  // namespace hb
