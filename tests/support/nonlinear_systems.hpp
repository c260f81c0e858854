// Well-known nonlinear forced systems, their derivatives by forward automatic differentiation.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <unsupported/Eigen/AutoDiff>

#include "hb/engine/nonlinear/nonlinear_system.hpp"
#include "lib/hill_system.hpp"

namespace hb::test {

using Dual = Eigen::AutoDiffScalar<Eigen::VectorXd>;
template <class Number>
using Numbers = Eigen::Matrix<Number, Eigen::Dynamic, 1>;

// `residual(p, tau, q, v, a)` gives r as a vector of whatever numbers q, v and a are. The parameter is the speed unless
// `speed` says otherwise.
template <class Residual>
NonlinearSystem differentiated(
    Eigen::Index n, Residual residual, std::function<double(double)> speed = [](double p) { return p; }) {
  NonlinearSystem system;
  system.num_unknowns = n;
  system.speed = std::move(speed);
  system.evaluate = [n, residual](double p, const MotionSamples& motion, Derivatives wanted,
                                  ResidualSamples& samples) -> std::optional<EvaluationFailure> {
    const Eigen::Index N = motion.num_samples();
    samples.r.resize(n, N);
    if (wanted == Derivatives::none) {
      for (Eigen::Index j = 0; j < N; ++j)
        samples.r.col(j) = residual(p, motion.angle(j), Numbers<double>(motion.q.col(j)),
                                    Numbers<double>(motion.v.col(j)), Numbers<double>(motion.a.col(j)));
      return std::nullopt;
    }
    samples.dq.resize(n * n, N);
    samples.dv.resize(n * n, N);
    samples.da.resize(n * n, N);
    for (Eigen::Index j = 0; j < N; ++j) {
      Numbers<Dual> q(n), v(n), a(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        q(i) = Dual(motion.q(i, j), 3 * n, i);
        v(i) = Dual(motion.v(i, j), 3 * n, n + i);
        a(i) = Dual(motion.a(i, j), 3 * n, 2 * n + i);
      }
      const Numbers<Dual> r = residual(p, motion.angle(j), q, v, a);
      for (Eigen::Index i = 0; i < n; ++i) {
        samples.r(i, j) = r(i).value();
        for (Eigen::Index k = 0; k < n; ++k) {
          samples.dq(i + n * k, j) = r(i).derivatives()(k);
          samples.dv(i + n * k, j) = r(i).derivatives()(n + k);
          samples.da(i + n * k, j) = r(i).derivatives()(2 * n + k);
        }
      }
    }
    return std::nullopt;
  };
  return system;
}

// x'' + damping x' + x + cubic x^3 = force cos tau.
struct Duffing {
  double damping = 0.1, cubic = 1, force = 0.5;
};
inline NonlinearSystem duffing(Duffing d) {
  return differentiated(1, [d](double, double tau, const auto& q, const auto& v, const auto& a) {
    auto r = a;
    r(0) = a(0) + d.damping * v(0) + q(0) + d.cubic * q(0) * q(0) * q(0) - d.force * std::cos(tau);
    return r;
  });
}

// Double pendulum in relative angles with springs and dampers in its joints, torque on the first: the inertia depends
// on the position,
//     T = 1/2 (a + 2 b cos q2) q1'^2 + (c + b cos q2) q1' q2' + 1/2 c q2'^2.
struct DoublePendulum {
  double a = 3, b = 1, c = 1, k1 = 4, k2 = 9, d1 = 0.1, d2 = 0.05, torque = 1, bias = 0.3;
};
inline NonlinearSystem double_pendulum(DoublePendulum s) {
  return differentiated(2, [s](double, double tau, const auto& q, const auto& v, const auto& a) {
    using std::cos, std::sin;
    auto r = a;
    const auto cosine = cos(q(1)), sine = sin(q(1));
    r(0) = (s.a + 2 * s.b * cosine) * a(0) + (s.c + s.b * cosine) * a(1) -
           s.b * sine * (2.0 * v(0) * v(1) + v(1) * v(1)) + s.d1 * v(0) + s.k1 * q(0) - s.torque * std::cos(tau) -
           s.bias;
    r(1) = (s.c + s.b * cosine) * a(0) + s.c * a(1) + s.b * sine * v(0) * v(0) + s.d2 * v(1) + s.k2 * q(1);
    return r;
  });
}

// Pendulum of unit frequency, its pivot vibrating along gravity: x'' + damping x' + (1 + depth cos tau) sin x = force.
struct VibratedPendulum {
  double damping = 0.1, depth = 0.5, force = 0;
};
inline NonlinearSystem vibrated_pendulum(VibratedPendulum s) {
  return differentiated(1, [s](double, double tau, const auto& q, const auto& v, const auto& a) {
    using std::sin;
    auto r = a;
    r(0) = a(0) + s.damping * v(0) + (1 + s.depth * std::cos(tau)) * sin(q(0)) - s.force;
    return r;
  });
}

// M q_tt + B q_t + C q - h of a Hill system; the parameter is the speed.
inline NonlinearSystem linear(const HillSystem& hill) {
  NonlinearSystem system;
  system.num_unknowns = hill.num_modes();
  system.speed = [](double p) { return p; };
  system.evaluate = [hill](double p, const MotionSamples& motion, Derivatives wanted,
                           ResidualSamples& samples) -> std::optional<EvaluationFailure> {
    const Eigen::Index n = hill.num_modes(), N = motion.num_samples();
    const FourierSeries C = stiffness_at(hill, p), h = load_at(hill, p);
    samples.r.resize(n, N);
    samples.dq.resize(n * n, N);
    for (Eigen::Index j = 0; j < N; ++j) {
      samples.dq.col(j) = fourier::evaluate(C, motion.angle(j));
      samples.r.col(j) = hill.mass * motion.a.col(j) + hill.damping * motion.v.col(j) +
                         samples.dq.col(j).reshaped(n, n) * motion.q.col(j);
      if (h.c.size() > 0) samples.r.col(j) -= fourier::evaluate(h, motion.angle(j));
    }
    if (wanted == Derivatives::none) return std::nullopt;
    samples.dv = hill.damping.reshaped().replicate(1, N);
    samples.da = hill.mass.reshaped().replicate(1, N);
    return std::nullopt;
  };
  return system;
}

}  // namespace hb::test
