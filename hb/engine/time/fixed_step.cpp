#include "hb/engine/time/fixed_step.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lib/dense.hpp"
#include "lib/stop_wish.hpp"

namespace hb {

namespace {

// Everything per radian of crank angle: Omega^2 M q'' + Omega B q' + C q = h.
struct Equation {
  const TimeDomainSystem& system;
  Eigen::MatrixXd M, B, C;
  Eigen::VectorXd h;
  dense::Lu<double> mass;
  long evaluations = 0;

  explicit Equation(const TimeDomainSystem& s)
      : system(s), M(s.speed * s.speed * s.mass), B(s.speed * s.damping), C(s.mass), h(s.mass.rows()), mass(M) {}
  void at(double tau) {
    system.evaluate(tau, C, h);
    ++evaluations;
  }
  Eigen::VectorXd acceleration(const Eigen::VectorXd& q, const Eigen::VectorXd& q1) const {
    return mass.solve(h - B * q1 - C * q);
  }
};

struct State {
  Eigen::VectorXd q, q1, q2;
};

// (M + d/2 B + d^2/4 C) q2_new = h - B (q1 + d/2 q2) - C (q + d q1 + d^2/4 q2), at the new angle.
void newmark_step(Equation& equation, double tau, double d, State& state) {
  equation.at(tau + d);
  const Eigen::VectorXd q = state.q + d * state.q1 + d * d / 4 * state.q2, q1 = state.q1 + d / 2 * state.q2;
  const Eigen::MatrixXd A = equation.M + d / 2 * equation.B + d * d / 4 * equation.C;
  state.q2 = dense::Lu<double>(A).solve(equation.h - equation.B * q1 - equation.C * q);
  state.q = q + d * d / 4 * state.q2;
  state.q1 = q1 + d / 2 * state.q2;
}

void runge_kutta_step(Equation& equation, double tau, double d, State& state) {
  const auto slope = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& q1) { return equation.acceleration(q, q1); };
  equation.at(tau);
  const Eigen::VectorXd a1 = slope(state.q, state.q1), v1 = state.q1;
  equation.at(tau + d / 2);
  const Eigen::VectorXd v2 = state.q1 + d / 2 * a1, a2 = slope(state.q + d / 2 * v1, v2);
  const Eigen::VectorXd v3 = state.q1 + d / 2 * a2, a3 = slope(state.q + d / 2 * v2, v3);
  equation.at(tau + d);
  const Eigen::VectorXd v4 = state.q1 + d * a3, a4 = slope(state.q + d * v3, v4);
  state.q += d / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
  state.q1 += d / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  state.q2 = slope(state.q, state.q1);
}

}  // namespace

MarchingResult march_fixed_step(const TimeDomainSystem& system, FixedStep method, int steps_per_turn, double tolerance,
                                int max_turns, double time_limit) {
  if (steps_per_turn < 8 || steps_per_turn % 8 != 0)
    throw std::invalid_argument("march_fixed_step: steps_per_turn must be a multiple of 8, is " +
                                std::to_string(steps_per_turn));
  const Deadline start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const Eigen::Index I = system.num_modes();
  const int num_outputs = steps_per_turn % 128 == 0 ? 128 : 8, every = steps_per_turn / num_outputs;
  Equation equation(system);
  State state{Eigen::VectorXd::Zero(I), Eigen::VectorXd::Zero(I), Eigen::VectorXd::Zero(I)};
  equation.at(0);
  state.q2 = equation.acceleration(state.q, state.q1);

  MarchingResult result;
  result.status = ShootingStatus::not_reached;
  result.message = "did not settle";
  PeriodicOrbit& orbit = result.orbit;
  orbit.q = orbit.q1 = orbit.q2 = Eigen::MatrixXd::Zero(I, num_outputs);
  const double d = 2 * std::numbers::pi / steps_per_turn;
  while (result.turns < max_turns) {
    for (int k = 0; k < steps_per_turn; ++k) {
      if (k % every == 0) {
        orbit.q.col(k / every) = state.q;
        orbit.q1.col(k / every) = state.q1;
        orbit.q2.col(k / every) = state.q2;
      }
      if (method == FixedStep::newmark)
        newmark_step(equation, k * d, d, state);
      else
        runge_kutta_step(equation, k * d, d, state);
      ++result.steps;
      if (k % 256 == 255) end_if_wished();
      if (k % 256 == 255 && seconds() > time_limit) {
        result.status = ShootingStatus::time_limit;
        result.message = "stopped by the time limit";
        max_turns = 0;
        break;
      }
    }
    ++result.turns;
    const double size = std::max(orbit.q.cwiseAbs().maxCoeff(), state.q.cwiseAbs().maxCoeff());
    const double size1 = std::max(orbit.q1.cwiseAbs().maxCoeff(), state.q1.cwiseAbs().maxCoeff());
    if (!std::isfinite(size) || !std::isfinite(size1)) {
      result.message = "grew beyond all bounds";
      break;
    }
    const double change_q = (state.q - orbit.q.col(0)).cwiseAbs().maxCoeff();
    const double change_q1 = (state.q1 - orbit.q1.col(0)).cwiseAbs().maxCoeff();
    result.change = size > 0 ? std::max(change_q / size, size1 > 0 ? change_q1 / size1 : 0.0) : 0;
    if (max_turns > 0 && result.change <= tolerance) {
      result.status = ShootingStatus::converged;
      result.message.clear();
      break;
    }
  }
  result.evaluations = equation.evaluations;
  result.seconds = seconds();
  return result;
}

}  // namespace hb
