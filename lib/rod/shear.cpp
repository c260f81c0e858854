#include "lib/rod/shear.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace hb {

namespace {

using Eigen::ArrayXd;
using Eigen::Index;

ArrayXd wave_numbers(const Body& link, Index num_modes) {
  return ArrayXd::LinSpaced(num_modes, 1, static_cast<double>(num_modes)) * std::numbers::pi / link.length;
}

}  // namespace

double shear_flexibility(const Body& link) {
  const Elastic& elastic = *link.elastic;
  if (!elastic.shear) return 0;
  return elastic.youngs_modulus * elastic.second_moment /
         (elastic.shear->coefficient * elastic.shear->modulus * elastic.area);
}

// Where shear softens the last term by less than this, b_i/a_i is less by the factor ((rho/E) k^2 EJ/mu)^2 (S7).
constexpr double least_softening = 1e-12;

Index num_unknowns(const Body& link, Index num_modes) {
  const double k = static_cast<double>(num_modes) * std::numbers::pi / link.length;
  return shear_flexibility(link) * k * k > least_softening ? 2 * num_modes : num_modes;
}

// lib/README.md (S4) to (S6). With k = i pi/l, S = k G F/EJ, m_w = mu/EJ, m_p = (rho/E) k^2 the modes (w, p) at rest
// are
//     [ S k^2 - lambda m_w      -S k^2              ] [w]
//     [ -S k^2           S k^2 + k^4 - lambda m_p   ] [p] = 0,     lambda = omega^2,
// divided by S k^2: lambda^2 m_w m_p/(S k^2) - lambda [m_w (1 + k^2/S) + m_p] + k^4 = 0. Both roots and the rotations
// without a difference of large numbers as S grows; the rotation of the second from orthogonality,
//     m_w + m_p p_a p_b = 0.
RestModes rest_modes(const Body& link, Index num_modes) {
  const Elastic& elastic = *link.elastic;
  const double flexibility = shear_flexibility(link);
  const double m_w = link.mass / link.length / (elastic.youngs_modulus * elastic.second_moment);
  const ArrayXd k2 = wave_numbers(link, num_modes).square(), k4 = k2.square();
  const ArrayXd m_p = elastic.density / elastic.youngs_modulus * k2;
  const ArrayXd square = flexibility * m_w * m_p / k2, linear = m_w * (1 + flexibility * k2) + m_p;
  const ArrayXd sum = linear + (linear.square() - 4 * square * k4).sqrt();
  const ArrayXd bending = 2 * k4 / sum, shear = sum / (2 * square);
  RestModes modes;
  modes.rotation[0] = 1 / (1 + flexibility * (k2 - bending * m_p / k2));
  modes.rotation[1] = -m_w / (m_p * modes.rotation[0]);
  for (std::size_t branch = 0; branch < 2; ++branch) modes.mass[branch] = m_w + m_p * modes.rotation[branch].square();
  modes.stiffness[0] = bending * modes.mass[0];
  modes.stiffness[1] = shear * modes.mass[1];
  return modes;
}

FourierSeries ritz_coordinates(const FourierSeries& unknowns, Index num_modes) {
  const Index n = unknowns.num_components();
  assert(n == num_modes || n == 2 * num_modes);
  if (n == num_modes) return unknowns;
  return FourierSeries(unknowns.c.topRows(num_modes) + unknowns.c.bottomRows(num_modes));
}

FourierSeries on_unknowns(const FourierSeries& load, Index num_unknowns) {
  const Index I = load.num_components();
  if (load.c.size() == 0 || num_unknowns == I) return load;
  return FourierSeries(load.c.replicate(num_unknowns / I, 1));
}

// (S8), from the second of (S3): p [ 1 + k^2/S - (rho/E) omega^2/(S (1 + i omega alpha_c)) ] = q, omega = n Omega.
Eigen::ArrayXcd rotation_ratios(const Body& link, double speed, Index num_modes, Index n) {
  const Elastic& elastic = *link.elastic;
  const double flexibility = shear_flexibility(link), omega = static_cast<double>(n) * speed;
  const std::complex<double> inertia = flexibility * elastic.density / elastic.youngs_modulus * omega * omega /
                                       std::complex<double>(1, omega * elastic.internal_damping);
  return (1 + flexibility * wave_numbers(link, num_modes).square() - inertia).inverse();
}

FourierSeries rotation_coordinates(const Body& link, double speed, const FourierSeries& q) {
  FourierSeries p = q;
  if (!link.elastic->shear) return p;
  for (Index n = 0; n <= q.num_harmonics(); ++n)
    p.c.col(n).array() *= rotation_ratios(link, speed, q.num_components(), n);
  return p;
}

// The block between a and b holds what the axial force does, without the stiffness at rest; without b it is subtracted.
HillSystem rigid_in_shear(const Body& link, const HillSystem& system, Index num_modes) {
  const Index n = system.num_modes(), I = num_modes, first = n - I;
  assert(link.elastic->shear && (n == I || n == 2 * I));
  const Elastic& elastic = *link.elastic;
  const double EJ = elastic.youngs_modulus * elastic.second_moment;
  const ArrayXd k2 = wave_numbers(link, I).square();
  HillSystem rigid;
  rigid.mass = (elastic.density / elastic.youngs_modulus * k2 + link.mass / link.length / EJ).matrix().asDiagonal();
  rigid.damping = (elastic.internal_damping * k2.square() + elastic.damping_y / EJ).matrix().asDiagonal();
  for (std::size_t p = 0; p < 3; ++p) {
    if (system.stiffness[p].c.size() > 0) {
      Eigen::MatrixXcd c(I * I, system.stiffness[p].c.cols());
      for (Index j = 0; j < I; ++j) c.middleRows(I * j, I) = system.stiffness[p].c.middleRows(n * (first + j), I);
      rigid.stiffness[p] = FourierSeries(std::move(c));
    }
    if (system.load[p].c.size() > 0) rigid.load[p] = FourierSeries(system.load[p].c.topRows(I));
  }
  const ArrayXd at_rest = n == I ? (k2.square() - rest_modes(link, I).stiffness[0]).eval() : k2.square().eval();
  for (Index i = 0; i < I; ++i) rigid.stiffness[0].c(i + I * i, 0) += at_rest(i);
  return rigid;
}

}  // namespace hb
