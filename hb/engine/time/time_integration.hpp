// Integration of a time-domain system over a stretch of crank angle, several solutions side by side: by CVODE (Adams,
// BDF) with its own step and order, or by collocation (Radau IIA) on equal cells. Only sundials_session.*,
// time_integration.cpp and variational_integration.cpp see SUNDIALS.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <span>
#include <string>
#include <vector>

#include "lib/time_domain.hpp"

namespace hb {

enum class Integrator {
  automatic,
  adams,  // CVODE, order 1-12, for mild systems
  bdf,  // CVODE, order 1-5, for stiff systems
  collocation,  // Radau IIA, 9 stages, order 17, L-stable: reaches rounding where CVODE's order 5 cannot
};

[[nodiscard]] const char* to_string(Integrator integrator);

using Deadline = std::chrono::steady_clock::time_point;
[[nodiscard]] Deadline deadline_after(Deadline start, double seconds);

// First-order form in numbers of order one: x = q/q_scale, v_i = q_i'/(q_scale w_i), ' = d/dtau,
//     x' = W v,   v' = -K(tau) x - G v + load f(tau),
//     K = W^-1 M^-1 C/Omega^2,   G = W^-1 M^-1 B W/Omega,   f = W^-1 M^-1 h/(Omega^2 q_scale).
// w_i is about the frequency of mode i in units of Omega, q_scale about the size of the forced response.
class ScaledMotion {
 public:
  explicit ScaledMotion(const TimeDomainSystem& system);

  Eigen::Index num_modes() const { return w_.size(); }
  const Eigen::VectorXd& w() const { return w_; }
  double q_scale() const { return q_scale_; }
  bool loaded() const { return q_scale_ > 0; }

  // Afterwards K(), f() are those of tau. A repeated angle costs nothing.
  void evaluate(double tau);
  const Eigen::MatrixXd& K() const { return K_; }
  const Eigen::MatrixXd& G() const { return G_; }
  const Eigen::VectorXd& f() const { return f_; }
  long evaluations() const { return evaluations_; }

  // Eigenvalues of the system frozen at tau, per radian of crank angle.
  Eigen::VectorXcd frozen_eigenvalues(double tau);

 private:
  const TimeDomainSystem& system_;
  Eigen::MatrixXd mass_inverse_, C_, K_, G_;
  Eigen::VectorXd w_, h_, f_;
  double q_scale_ = 1, tau_;
  long evaluations_ = 0;
};

enum class IntegrationStatus {
  finished,
  time_limit,  // the deadline passed
  failed,  // the integrator gave up; `message` says where
};

struct Trajectory {
  IntegrationStatus status = IntegrationStatus::failed;
  std::vector<Eigen::MatrixXd> states;  // (x; v) per column of the initial state, at each output angle reached
  long steps = 0;
  std::string message;
};

// Solutions from Y0 (2I x m) at tau0; column j feels load(j) times the load. Outputs ascend and are > tau0.
// CVODE's local error per step is held at `tolerance` (relative, and absolute in the scaled numbers). The global error
// is larger, with BDF some hundred times, but not in step with it: Adams is stable only up to h |lambda| = 1.8 (order
// 5), 1.2 (6) and less, so where fast modes have died out its step is far shorter than accuracy asks for. Riding on
// that bound the controller may let the fast modes grow back to the tolerance, or not: six-link mechanism, 300 rpm,
// error of q 2e-13 at tolerance 1e-8 (order 5 all the way), 2e-10 at 1e-10 (changing between 5 and 6; 2e-13 if kept at
// 5).
[[nodiscard]] Trajectory integrate_cvode(ScaledMotion& motion, Integrator method, double tolerance, double tau0,
                                         const Eigen::MatrixXd& Y0, const Eigen::VectorXd& load,
                                         std::span<const double> outputs, Deadline deadline);

// What CVODE's local errors add up to, per step: with BDF four times the tolerance was measured, with Adams less than
// one.
[[nodiscard]] double error_per_step(Integrator integrator, double tolerance);

// The same by collocation with `cells_between` equal cells between neighbouring outputs.
[[nodiscard]] Trajectory integrate_collocation(ScaledMotion& motion, int cells_between, double tau0,
                                               const Eigen::MatrixXd& Y0, const Eigen::VectorXd& load,
                                               std::span<const double> outputs, Deadline deadline);

}  // namespace hb
