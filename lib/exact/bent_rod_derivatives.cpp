#include <algorithm>

#include "lib/exact/bent_rod.hpp"

namespace hb::exact {

using Eigen::Index;

namespace {

std::size_t entry(Index k) { return static_cast<std::size_t>(k); }

}  // namespace

// du/dq_j = integral (g1 s_j'), du_t/dq_j = integral (h1 s_j'), du_tt/dq_j = integral (h2 s_j'), and at the end of the
// rod those of the chord.
void BentRod::differentiate() {
  const Index I = rule_.num_modes(), Q = rule_.num_points();
  dslope_.resize(entry(I * Q));
  du_.resize(dslope_.size());
  variation_.resize(entry(I));
  std::vector<RodDerivatives::Mode>& modes = derivatives_.modes;
  modes.assign(entry(I), {});
  derivatives_.residual.assign(entry(I * I), {});
  for (Index n = 0; n < Q; ++n)
    for (Index j = 0; j < I; ++j) {
      const Point& at = points_[entry(n)];
      const Lanes s1 = rule_.shapes_at(n)[j].s1, W = rule_.weight(n);
      const Along by{at.g1 * s1, at.h1 * s1, at.h2 * s1};
      dslope_[entry(I * n + j)] = by;
      Chord<Lanes>& chord = modes[entry(j)].chord;
      chord.c += W * by.u;
      chord.c1 += W * by.u1;
      chord.c2 += W * by.u2;
    }
  integrate(dslope_, I, du_);
  for (Index n = 0; n < Q; ++n) {
    vary(n);
    add_residual(n);
    add_surroundings(n);
    add_load(n);
  }
  const double scale = 2 / (rod_.length * rod_.bending);
  for (std::array<Lanes, 3>& of : derivatives_.residual)
    for (Lanes& r : of) r *= scale;
  for (RodDerivatives::Mode& mode : modes) {
    for (Lanes& r : mode.by_base) r *= scale;
    mode.by_axial_force = -scale * mode.chord.c;
  }
}

// With du_t/dq_t = du/dq, du_tt/dq_t = 2 du_t/dq, du_tt/dq_tt = du/dq, at fixed base:
//     df_x/dq = mu du_tt + c_x du_t - mu phi_t^2 du - (mu phi_tt + c_x phi_t) s
//     df_y/dq = (mu phi_tt + c_y phi_t) du + 2 mu phi_t du_t - mu phi_t^2 s
//     df_x/dq_t = 2 mu du_t + c_x du - 2 mu phi_t s,      df_y/dq_t = 2 mu phi_t du + c_y s
//     df_x/dq_tt = mu du,                                 df_y/dq_tt = mu s
// and with dkappa/dq = K_a s' + k s'', dkappa_t/dq = (K_aa a_t + K_ab w''_t) s' + K_ab a_t s'', dpsi/da = k,
// d^3 psi/da^3 = k^5 (1 + 2 a^2):
//     dm/dq = EJ (dkappa/dq + alpha_c dkappa_t/dq),       dm/dq_t = alpha_c EJ dkappa/dq.
void BentRod::vary(Index n) {
  const double mu = rod_.mass_per_length, c_x = rod_.damping_x, c_y = rod_.damping_y, W = rule_.weight(n);
  const auto [turn_x, turn_y, coriolis, centrifugal] = rates_;
  const Point& at = points_[entry(n)];
  const Lanes& K_a = loads_[entry(n)].K_a;
  const Lanes K_ab = -at.a * at.g2, k5 = -at.g2 * at.k * at.k * (1 + 2 * at.a * at.a), K_aa = at.b * k5;
  further_ = {K_ab, K_aa, K_ab * at.a2 + k5 * at.a1 * at.a1, 2 * K_ab * at.a1};
  const double alpha = rod_.internal_damping;
  const Lanes m_slope = W * rod_.bending * (K_a + alpha * (K_aa * at.a1 + K_ab * at.b1)),
              m_curvature = W * rod_.bending * (at.k + alpha * K_ab * at.a1);
  const Index I = rule_.num_modes();
  const RodQuadrature::Shape* shape = rule_.shapes_at(n);
  const Along* du = du_.data() + I * n;
  Variation* variation = variation_.data();
  for (Index j = 0; j < I; ++j) {
    Variation by;
    const auto [s, s1, s2] = shape[j];
    by.du = du[j];
    const auto [u, u1, u2] = du[j];
    by.f_x = {W * (mu * u2 + c_x * u1 - centrifugal * u - turn_x * s), W * (2 * mu * u1 + c_x * u - coriolis * s),
              W * mu * u};
    by.f_y = {W * (turn_y * u + coriolis * u1 - centrifugal * s), W * (coriolis * u + c_y * s), W * mu * s};
    by.kappa = K_a * s1 + at.k * s2;
    by.m = m_slope * s1 + m_curvature * s2;
    variation[j] = by;
  }
}

// df_x du/dq_i + df_y s_i + dm dkappa/dq_i, and by the shape itself
//     g2 axial s_i' s_j',   dkappa_i/dq_j = K_aa s_i' s_j' + K_ab (s_i' s_j'' + s_i'' s_j'),
//     rho J [ dpsi_tt/dq_j k s_i' + (phi + psi)_tt K_ab s_i' s_j' ].
void BentRod::add_residual(Index n) {
  const Index I = rule_.num_modes();
  const Point& at = points_[entry(n)];
  const Load& f = loads_[entry(n)];
  const auto [K_ab, K_aa, psi2_a, psi2_a1] = further_;
  const Lanes rotary = rod_.rotary * rule_.weight(n) * at.k;
  const Lanes slopes = at.g2 * f.axial + rotary * psi2_a + f.rotary * K_ab + f.m * K_aa;
  const Lanes mixed = f.m * K_ab, rates = rotary * psi2_a1, accelerations = rotary * at.k;
  const Lanes damped = rod_.internal_damping * rod_.bending * rule_.weight(n);
  const RodQuadrature::Shape* shape = rule_.shapes_at(n);
  const Variation* variation = variation_.data();
  std::array<Lanes, 3>* residual = derivatives_.residual.data();
  for (Index j = 0; j < I; ++j) {
    const Variation& by = variation[j];
    const Lanes s1 = shape[j].s1, by_slope = slopes * s1 + mixed * shape[j].s2, by_curvature = mixed * s1;
    const Lanes by_rate = rates * s1, by_acceleration = accelerations * s1, by_kappa = damped * by.kappa;
    for (Index i = 0; i < I; ++i) {
      const Variation& own = variation[i];
      const Lanes s_i = shape[i].s, s1_i = shape[i].s1, s2_i = shape[i].s2;
      auto& [by_q, by_q1, by_q2] = residual[i + I * j];
      by_q += by.f_x[0] * own.du.u + by.f_y[0] * s_i + by.m * own.kappa + by_slope * s1_i + by_curvature * s2_i;
      by_q1 += by.f_x[1] * own.du.u + by.f_y[1] * s_i + by_kappa * own.kappa + by_rate * s1_i;
      by_q2 += by.f_x[2] * own.du.u + by.f_y[2] * s_i + by_acceleration * s1_i;
    }
  }
}

void BentRod::add_surroundings(Index n) {
  const double mu = rod_.mass_per_length, c_x = rod_.damping_x, c_y = rod_.damping_y, W = rule_.weight(n);
  const Index I = rule_.num_modes();
  const Point& at = points_[entry(n)];
  const Along& u = u_[entry(n)];
  const Lanes x_by_phi1 = W * (-2 * mu * (u.u * base_.phi1 + at.w1) - c_x * at.w),
              y_by_phi1 = W * (2 * mu * (u.u1 - at.w * base_.phi1) + c_y * u.u);
  const Lanes x_by_phi2 = -W * mu * at.w, y_by_phi2 = W * mu * u.u, rotary = W * rod_.rotary * at.k;
  const RodQuadrature::Shape* shape = rule_.shapes_at(n);
  const Variation* variation = variation_.data();
  RodDerivatives::Mode* mode = derivatives_.modes.data();
  for (Index i = 0; i < I; ++i) {
    const Lanes du = variation[i].du.u, s = shape[i].s, W_du = W * du, W_s = W * s;
    auto& [v_x, v_y, a_x, a_y, phi1, phi2] = mode[i].by_base;
    v_x += c_x * W_du;
    v_y += c_y * W_s;
    a_x += mu * W_du;
    a_y += mu * W_s;
    phi1 += x_by_phi1 * du + y_by_phi1 * s;
    phi2 += x_by_phi2 * du + y_by_phi2 * s + rotary * shape[i].s1;
  }
}

// F_x = int f_x dx, F_y = int f_y dx, moment = int (x+u) f_y - w f_x + rho J (phi + psi)_tt dx.
void BentRod::add_load(Index n) {
  const Point& at = points_[entry(n)];
  const Lanes p = u_[entry(n)].u, w = at.w, f_x = loads_[entry(n)].f_x, f_y = loads_[entry(n)].f_y;
  const double W = rule_.weight(n), rotary = W * rod_.rotary;
  const std::array<Lanes, 3> turned = {rotary * further_.psi2_a, rotary * further_.psi2_a1, rotary * at.k};
  const RodQuadrature::Shape* shape = rule_.shapes_at(n);
  const Variation* variation = variation_.data();
  const Index I = rule_.num_modes();
  RodDerivatives::Mode* mode = derivatives_.modes.data();
  for (Index j = 0; j < I; ++j) {
    const Variation& by = variation[j];
    RodDerivatives::Mode& of = mode[j];
    for (std::size_t s = 0; s < 3; ++s) {
      of.F_x[s] += by.f_x[s];
      of.F_y[s] += by.f_y[s];
      of.moment[s] += p * by.f_y[s] - w * by.f_x[s] + turned[s] * shape[j].s1;
    }
    of.moment[0] += W * (by.du.u * f_y - shape[j].s * f_x);
  }
}

}  // namespace hb::exact
