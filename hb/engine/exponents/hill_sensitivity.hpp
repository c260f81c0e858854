// First-order change of a steady state or of an exponent when M, B, C, h change, from one more solution of the block
// Hill system: a Lagrangian whose partial derivatives are the derivatives, so that only coefficients are computed anew.
//
// Response. L q = M q'' + B q' + C q = h; J(q; p) = <g, q> + ... a number, <a, b> the mean of a.b over the turn. With
// L* lambda = g, stationary in q,
//     dJ/dp = d/dp [ J(q; p) + <lambda, h - L q> ]     at fixed q and lambda.
// Where J depends on many numbers of the response: dq/dp = L^-1 d(h - L q)/dp.
//
// Exponents. S(s; p) x = 0 and y^H S = 0, S(s)_km = delta_km [ M (s + ik Omega)^2 + B (s + ik Omega) ] + C_{k-m}:
//     ds/dp = d/dp [ s - y^H S(s; p) x / (y^H S' x) ]     at fixed s, x, y.
#pragma once

#include <complex>
#include <optional>

#include "hb/engine/exponents/stability.hpp"
#include "lib/hill_system.hpp"

namespace hb {

// h - M q'' - B q' - C q on the harmonics of q: zero for the steady state.
[[nodiscard]] FourierSeries equation_residual(const HillSystem& system, double speed, const FourierSeries& q);

// x with L x = r, and lambda with L* lambda = g, on harmonics 0..num_harmonics: the same truncated block Hill system
// and its conjugate transpose, so that both agree to rounding. Empty at resonance without damping.
[[nodiscard]] std::optional<FourierSeries> solve_linearised(const HillSystem& system, double speed, FourierSeries r,
                                                            Eigen::Index num_harmonics);
[[nodiscard]] std::optional<FourierSeries> solve_adjoint(const HillSystem& system, double speed, FourierSeries g,
                                                         Eigen::Index num_harmonics);

// q_i(crank_angle) = <g, q> for every q with up to num_harmonics.
[[nodiscard]] FourierSeries point_functional(Eigen::Index num_modes, Eigen::Index num_harmonics, Eigen::Index mode,
                                             double crank_angle);

// Right and left vectors of one exponent: columns k = -H..H, I rows, in the coordinates of q.
struct FloquetVectors {
  double speed = 0;
  std::complex<double> s;  // 1/time, the imaginary part such that column H carries the motion
  Eigen::MatrixXcd x, y;
  std::complex<double> slope;  // y^H S' x
};

// Empty where the exponent is not simple to working accuracy (two meet: no derivative), or needs too many harmonics.
[[nodiscard]] std::optional<FloquetVectors> floquet_vectors(const HillSystem& system, double speed,
                                                            const Exponent& exponent);

// s - y^H S(s) x / (y^H S' x) of another system: its exponent, to first order in the difference of the two.
[[nodiscard]] std::complex<double> exponent_nearby(const FloquetVectors& vectors, const HillSystem& system);

}  // namespace hb
