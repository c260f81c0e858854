// A periodically forced system of second order,
//     r(tau, q, q_t, q_tt; p) = 0,      tau = Omega(p) t,   r of period 2 pi in tau, smooth in all its arguments,
// with n unknowns q(t) and a parameter p, which may be the speed Omega itself: the type that the nonlinear solvers work
// on. It is known by its values at given samples of the motion, so whatever can evaluate a residual can be solved.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>

namespace hb {

// N samples of a motion, one after the other: what r is evaluated at. Any N >= 1.
struct MotionSamples {
  Eigen::VectorXd angle;  // tau, rad, ascending; over several turns where the motion has them
  Eigen::MatrixXd q, v, a;  // n x N: q, q_t, q_tt, in the system's units

  Eigen::Index num_samples() const { return angle.size(); }
};

// Values of r and of its partial derivatives at the samples. Column-major: row i + n k of dq is dr_i/dq_k.
struct ResidualSamples {
  Eigen::MatrixXd r;  // n x N
  Eigen::MatrixXd dq, dv, da;  // n*n x N: by q, q_t, q_tt; da regular along the motion
  Eigen::MatrixXd dp;  // n x N: by p with tau, q, q_t, q_tt held; empty: left to differences
};

// Why r has no value at a sample: a rod folded, a linkage that does not close.
struct EvaluationFailure {
  std::string reason;
  double angle = 0;  // tau of the sample, rad
};

enum class Derivatives { none, state };  // r alone; or dq, dv, da as well, and dp where the system knows it

struct NonlinearSystem {
  Eigen::Index num_unknowns = 0;  // n
  // Omega(p), rad per unit time, positive.
  std::function<double(double parameter)> speed;
  // Fills `residual` (resizing it) at all samples, or says where r does not exist. May keep scratch: one call at a
  // time. A function of its arguments alone.
  std::function<std::optional<EvaluationFailure>(double parameter, const MotionSamples& motion, Derivatives wanted,
                                                 ResidualSamples& residual)>
      evaluate;
};

// Throws std::invalid_argument naming what is wrong: no unknowns, a function missing.
void validate(const NonlinearSystem& system);

}  // namespace hb
