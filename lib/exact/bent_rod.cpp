#include "lib/exact/bent_rod.hpp"

#include <numbers>

namespace hb::exact {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// A field and A' field: one instance of the product each.
MatrixXd times(const MatrixXd& A, const Field& field) { return A * field.matrix(); }
MatrixXd transposed_times(const MatrixXd& A, const Field& field) { return A.transpose() * field.matrix(); }
Angles sum(const Eigen::VectorXd& weights, const Field& field) {
  return (weights.transpose() * field.matrix()).array();
}

// Row i + I j: left_i right_j at each point, I*I x Q, so that (products * field) is sum_k left_i field right_j.
MatrixXd products(const MatrixXd& left, const MatrixXd& right) {
  const Index I = left.cols();
  MatrixXd rows(I * I, left.rows());
  for (Index j = 0; j < I; ++j)
    for (Index i = 0; i < I; ++i) rows.row(i + I * j) = left.col(i).cwiseProduct(right.col(j)).transpose();
  return rows;
}

}  // namespace

// With a = w', k = 1/cos psi = (1 - a^2)^(-1/2):
//     u' = -a^2/(1 + cos psi),   u'_t = g1 a_t,   u'_tt = g1 a_tt + g2 a_t^2,   g1 = -a k,   g2 = -k^3,
//     psi_t = k a_t,   psi_tt = k a_tt + a k^3 a_t^2.
BentRod::BentRod(const RodQuadrature& rule, const RodConstants& rod, const Samples& q, const Samples& q1,
                 const Samples& q2)
    : rule_(rule), rod_(rod) {
  w_ = (rule.s * q).array(), w1_ = (rule.s * q1).array(), w2_ = (rule.s * q2).array();
  a_ = (rule.s1 * q).array(), a1_ = (rule.s1 * q1).array(), a2_ = (rule.s1 * q2).array();
  b_ = (rule.s2 * q).array(), b1_ = (rule.s2 * q1).array();

  const Field square = 1 - a_ * a_;
  const Field cosine = square.sqrt();
  k_ = cosine / square;
  const Field cube = k_ / square;
  g1_ = -a_ * k_;
  g2_ = -cube;
  h1_ = g2_ * a1_;
  h2_ = g2_ * a2_ - 3 * a_ * cube / square * a1_ * a1_;
  psi2_ = k_ * a2_ - a_ * h1_ * a1_;
  const Field slope = -a_ * a_ / (1 + cosine);
  const Field slope1 = g1_ * a1_;
  const Field slope2 = g1_ * a2_ + h1_ * a1_;
  p_ = times(rule.integral, slope).array().colwise() + rule.x.array();
  u1_ = times(rule.integral, slope1).array();
  u2_ = times(rule.integral, slope2).array();
  c_ = rule.length + sum(rule.weight, slope);
  c1_ = sum(rule.weight, slope1);
  c2_ = sum(rule.weight, slope2);

  steepest_ = a_.abs().colwise().maxCoeff();
  const double first = std::numbers::pi / rule.length;
  at_0_ = at_l_ = Angles::Zero(q.cols());
  for (Index i = 0; i < q.rows(); ++i) {
    const double wave = first * static_cast<double>(i + 1);
    at_0_ += wave * q.row(i).array();
    at_l_ += (i % 2 == 0 ? -wave : wave) * q.row(i).array();
  }
  steepest_ = steepest_.max(at_0_.abs()).max(at_l_.abs());

  integrals_.resize(15, q.cols());
  integrals_ << sum(rule.weight, p_), sum(rule.weight, u1_), sum(rule.weight, u2_),  //
      sum(rule.weight, w_), sum(rule.weight, w1_), sum(rule.weight, w2_),  //
      sum(rule.weight, p_ * p_ + w_ * w_),  //
      sum(rule.weight, p_ * p_), sum(rule.weight, w_ * w_),  //
      sum(rule.weight, p_ * u1_), sum(rule.weight, w_ * w1_),  //
      sum(rule.weight, p_ * w1_), sum(rule.weight, w_ * u1_),  //
      sum(rule.weight, p_ * w2_ - w_ * u2_),  //
      sum(rule.weight, psi2_);
}

ShapeIntegrals BentRod::shape(Index angle) const {
  const auto I = integrals_.col(angle);
  return {I(0), I(1), I(2), I(3), I(4), I(5), I(6), I(7), I(8), I(9), I(10), I(11), I(12), I(13), I(14)};
}

// Load per length along and across the chord, and what it and X make of the slopes:
//     f_x = mu [ a_x - phi_t^2 (x+u) - phi_tt w - 2 phi_t w_t + u_tt ] + c_x [ v_x - phi_t w + u_t ]
//     f_y = mu [ a_y + phi_tt (x+u) - phi_t^2 w + 2 phi_t u_t + w_tt ] + c_y [ v_y + phi_t (x+u) + w_t ]
// Since du/dq_i = integral (g1 s_i'), int f_x du/dq_i dx - X du(l)/dq_i = sum over the points of g1 s_i' times
//     axial = integral' (W f_x) - X W            (minus the weighted axial force that the load leaves at x)
// and the moment EJ (kappa + alpha_c kappa_t) =: m works on dkappa/dq_i = k s_i'' + a w'' k^3 s_i'.
struct BentRod::Loads {
  Field f_x, f_y, axial, m;  // f without weights, m with them
  Field rotary;  // W rho J (phi + psi)_tt
  Field K_a;  // dkappa/da = a w'' k^3
};

BentRod::Loads BentRod::loads(const RodSurroundings& at) const {
  const double mu = rod_.mass_per_length, c_x = rod_.damping_x, c_y = rod_.damping_y;
  const auto v_x = at.base.row(0), v_y = at.base.row(1), a_x = at.base.row(2), a_y = at.base.row(3);
  const auto phi1 = at.base.row(4), phi2 = at.base.row(5);
  const Angles square = mu * phi1.square();
  Loads f;
  f.f_x = mu * u2_ + c_x * u1_;
  f.f_x += -(p_.rowwise() * square) - w_.rowwise() * (mu * phi2 + c_x * phi1) - w1_.rowwise() * (2 * mu * phi1);
  f.f_x.rowwise() += mu * a_x + c_x * v_x;
  f.f_y = mu * w2_ + c_y * w1_;
  f.f_y += p_.rowwise() * (mu * phi2 + c_y * phi1) - w_.rowwise() * square + u1_.rowwise() * (2 * mu * phi1);
  f.f_y.rowwise() += mu * a_y + c_y * v_y;

  const auto W = rule_.weight.array();
  const Field weighted = f.f_x.colwise() * W;
  f.axial = transposed_times(rule_.integral, weighted).array() -
            at.axial_force.replicate(rule_.num_points(), 1).colwise() * W;
  f.K_a = -a_ * b_ * g2_;
  const Field kappa1 = f.K_a * a1_ + k_ * b1_;
  f.m = (rod_.bending * (k_ * b_ + rod_.internal_damping * kappa1)).colwise() * W;
  f.rotary = (rod_.rotary * (psi2_.rowwise() + phi2)).colwise() * W;
  return f;
}

MatrixXd BentRod::residual(const RodSurroundings& at) const {
  const Loads f = loads(at);
  const MatrixXd r = transposed_times(rule_.s, f.f_y.colwise() * rule_.weight.array()) +
                     transposed_times(rule_.s1, g1_ * f.axial + f.rotary * k_ + f.m * f.K_a) +
                     transposed_times(rule_.s2, f.m * k_);
  return 2 / (rod_.length * rod_.bending) * r;
}

Field BentRod::tension(const RodSurroundings& at, const Angles& Y) const {
  const Index Q = rule_.num_points(), N = num_angles();
  const Loads f = loads(at);
  const Angles base_x = at.axial_force - sum(rule_.weight, f.f_x), base_y = Y - sum(rule_.weight, f.f_y);
  Field F_x = times(rule_.integral, f.f_x).array(), F_y = times(rule_.integral, f.f_y).array();
  F_x.rowwise() += base_x;
  F_y.rowwise() += base_y;
  Field result(Q + 2, N);
  result.topRows(Q) = F_x / k_ + F_y * a_;
  result.row(Q) = base_x * (1 - at_0_.square()).sqrt() + base_y * at_0_;
  result.row(Q + 1) = at.axial_force * (1 - at_l_.square()).sqrt() + Y * at_l_;
  return result;
}

RodDerivatives BentRod::derivatives(const RodSurroundings& at) const {
  RodDerivatives out;
  const Loads f = loads(at);
  differentiate_residual(at, f, out);
  differentiate_by_surroundings(at, out);
  differentiate_load(at, f, out);
  const MatrixXd weighted = rule_.weight.asDiagonal() * rule_.s1;
  out.chord = {transposed_times(weighted, g1_), transposed_times(weighted, h1_), transposed_times(weighted, h2_)};
  return out;
}

// At fixed base and X, with du/dq_j = integral (g1 s_j'), du_t/dq_j = integral (h1 s_j'), du_tt/dq_j = integral
// (h2 s_j'), du_t/dq_t = du/dq, du_tt/dq_t = 2 du_t/dq, du_tt/dq_tt = du/dq:
//     df_x/dq = integral (x0 s_j') - (mu phi_tt + c_x phi_t) s_j    x0 = mu (h2 - phi_t^2 g1) + c_x h1
//     df_x/dq_t = integral (x1 s_j') - 2 mu phi_t s_j               x1 = 2 mu h1 + c_x g1
//     df_x/dq_tt = integral (x2 s_j')                               x2 = mu g1
//     df_y/dq = integral (y0 s_j') - mu phi_t^2 s_j                 y0 = (mu phi_tt + c_y phi_t) g1 + 2 mu phi_t h1
//     df_y/dq_t = integral (y1 s_j') + c_y s_j                      y1 = 2 mu phi_t g1
//     df_y/dq_tt = mu s_j
// so that int df_x du/dq_i dx = sum g1 s_i' (integral_square (x s_j') - rest_s_j ..), int df_y s_i dx = sum rest_s_i
// y s_j' ... . Bending, with kappa_j = K_a s_j' + k s_j'', dkappa_t/dq_j = (K_aa a_t + K_ab w''_t) s_j' + K_ab a_t
// s_j'', K_ab = a k^3, K_aa = w'' k^5 (1 + 2 a^2):
//     EJ (kappa_j + alpha_c dkappa_t/dq_j) kappa_i + m dkappa_i/dq_j,
//     dkappa_i/dq_j = K_aa s_i' s_j' + K_ab (s_i' s_j'' + s_i'' s_j').
void BentRod::differentiate_residual(const RodSurroundings& at, const Loads& f, RodDerivatives& out) const {
  const Index I = rule_.num_modes(), Q = rule_.num_points(), N = num_angles();
  const double mu = rod_.mass_per_length, c_x = rod_.damping_x, c_y = rod_.damping_y, l = rod_.length;
  const auto phi1 = at.base.row(4), phi2 = at.base.row(5);
  const auto W = rule_.weight.array();
  const Field W_EJ = (rod_.bending * W).matrix().replicate(1, N).array();
  const double alpha = rod_.internal_damping;
  const Angles turn = mu * phi2 + c_x * phi1, coriolis = 2 * mu * phi1, centrifugal = mu * phi1.square();

  const Field K_ab = -a_ * g2_;
  const Field k5 = -g2_ * k_ * k_ * (1 + 2 * a_ * a_);  // d^3 psi/da^3
  const Field K_aa = b_ * k5;
  const Field kappa_t_a = K_aa * a1_ + K_ab * b1_, kappa_t_b = K_ab * a1_;
  const Field psi2_a = K_ab * a2_ + k5 * a1_ * a1_, psi2_a1 = 2 * K_ab * a1_;
  const Field rotary = rod_.rotary * (W.matrix().replicate(1, N).array());

  // Fields beside s_i' s_j', s_i' s_j'', s_i'' s_j', s_i'' s_j'', s_i' rest_s_j, rest_s_i s_j'.
  const MatrixXd P11 = products(rule_.s1, rule_.s1), P12 = products(rule_.s1, rule_.s2);
  const MatrixXd P21 = products(rule_.s2, rule_.s1), P22 = products(rule_.s2, rule_.s2);
  const MatrixXd P1r = products(rule_.s1, rule_.rest_s), Pr1 = products(rule_.rest_s, rule_.s1);

  MatrixXd& by_q = out.residual[0];
  by_q = times(P11, g2_ * f.axial + rotary * k_ * psi2_a + f.rotary * K_ab +
                        W_EJ * (f.K_a + alpha * kappa_t_a) * f.K_a + f.m * K_aa);
  by_q += times(P12, W_EJ * (k_ + alpha * kappa_t_b) * f.K_a + f.m * K_ab);
  by_q += times(P21, W_EJ * (f.K_a + alpha * kappa_t_a) * k_ + f.m * K_ab);
  by_q += times(P22, W_EJ * (k_ + alpha * kappa_t_b) * k_);
  by_q -= times(P1r, g1_.rowwise() * turn);
  by_q += times(Pr1, g1_.rowwise() * (mu * phi2 + c_y * phi1) + h1_.rowwise() * coriolis);

  MatrixXd& by_q1 = out.residual[1];
  by_q1 = times(P11, rotary * k_ * psi2_a1 + alpha * W_EJ * f.K_a * f.K_a);
  by_q1 += times(P12 + P21, alpha * W_EJ * f.K_a * k_);
  by_q1 += times(P22, alpha * W_EJ * k_ * k_);
  by_q1 += times(Pr1 - P1r, g1_.rowwise() * coriolis);

  MatrixXd& by_q2 = out.residual[2];
  by_q2 = times(P11, rotary * k_ * k_);

  // sum g1 s_i' integral_square (x_s s_j') for the three states at once.
  const std::array<Field, 3> x = {mu * h2_ - g1_.rowwise() * centrifugal + c_x * h1_, 2 * mu * h1_ + c_x * g1_,
                                  mu * g1_};
  Field columns(Q, 3 * I * N);
  for (Index s = 0; s < 3; ++s)
    for (Index j = 0; j < I; ++j)
      columns.middleCols((s * I + j) * N, N) = x[static_cast<std::size_t>(s)].colwise() * rule_.s1.col(j).array();
  Field axial = times(rule_.integral_square, columns);
  for (Index block = 0; block < 3 * I; ++block) axial.middleCols(block * N, N) *= g1_;
  const MatrixXd rows = transposed_times(rule_.s1, axial);
  for (Index s = 0; s < 3; ++s)
    for (Index j = 0; j < I; ++j)
      out.residual[static_cast<std::size_t>(s)].middleRows(I * j, I) += rows.middleCols((s * I + j) * N, N);

  // int s_i s_j dx = l/2 for i = j.
  for (Index i = 0; i < I; ++i) {
    by_q.row(i + I * i).array() -= l / 2 * centrifugal;
    by_q1.row(i + I * i).array() += l / 2 * c_y;
    by_q2.row(i + I * i).array() += l / 2 * mu;
  }
  for (MatrixXd& derivative : out.residual) derivative *= 2 / (l * rod_.bending);
}

void BentRod::differentiate_by_surroundings(const RodSurroundings& at, RodDerivatives& out) const {
  const Index N = num_angles();
  const double mu = rod_.mass_per_length, c_x = rod_.damping_x, c_y = rod_.damping_y;
  const double scale = 2 / (rod_.length * rod_.bending);
  const auto phi1 = at.base.row(4);
  const auto W = rule_.weight.array();
  const MatrixXd s_W = rule_.weight.asDiagonal() * rule_.s;
  const auto transposed = [&](const Field& field) -> Field {
    return transposed_times(rule_.integral, field.colwise() * W).array();
  };
  const MatrixXd along = transposed_times(rule_.s1, g1_.colwise() * rule_.rest.array());  // int du/dq_i dx
  const MatrixXd across = rule_.sum_s.replicate(1, N);
  const MatrixXd p_across = transposed_times(s_W, p_);
  const MatrixXd w_along = transposed_times(rule_.s1, g1_ * transposed(w_));
  const MatrixXd rotary = transposed_times(rule_.s1, k_.colwise() * W);
  const Field moving_x = -2 * (p_.rowwise() * phi1) - 2 * w1_, moving_y = -2 * (w_.rowwise() * phi1) + 2 * u1_;

  out.by_base[0] = scale * c_x * along;
  out.by_base[1] = scale * c_y * across;
  out.by_base[2] = scale * mu * along;
  out.by_base[3] = scale * mu * across;
  out.by_base[4] =
      scale * (mu * (transposed_times(s_W, moving_y) + transposed_times(rule_.s1, g1_ * transposed(moving_x))) +
               c_y * p_across - c_x * w_along);
  out.by_base[5] = scale * (mu * (p_across - w_along) + rod_.rotary * rotary);
  out.by_axial_force = -scale * transposed_times(rule_.s1, g1_.colwise() * W);
}

// F_x = int f_x dx, F_y = int f_y dx, moment = int (x+u) f_y - w f_x + rho J (phi + psi)_tt dx. The moment's
// derivatives by the values of u, u_t, u_tt and w, w_t, w_tt at the points, then those by q through integral' and s.
void BentRod::differentiate_load(const RodSurroundings& at, const Loads& f, RodDerivatives& out) const {
  const Index N = num_angles();
  const double mu = rod_.mass_per_length, c_x = rod_.damping_x, c_y = rod_.damping_y;
  const auto phi1 = at.base.row(4), phi2 = at.base.row(5);
  const auto W = rule_.weight.array();
  const Angles turn_x = mu * phi2 + c_x * phi1, turn_y = mu * phi2 + c_y * phi1;
  const Angles coriolis = 2 * mu * phi1, centrifugal = mu * phi1.square();
  const MatrixXd rest_s1 = rule_.rest.asDiagonal() * rule_.s1;
  const auto along = [&](const Field& field) { return transposed_times(rest_s1, field); };
  const auto across = [&](const Angles& factor) -> MatrixXd { return rule_.sum_s * factor.matrix(); };

  auto& [F_x, F_y, moment] = out.load;
  F_x[0] = along(mu * h2_ - g1_.rowwise() * centrifugal + c_x * h1_) - across(turn_x);
  F_x[1] = along(2 * mu * h1_ + c_x * g1_) - across(coriolis);
  F_x[2] = along(mu * g1_);
  F_y[0] = along(g1_.rowwise() * turn_y + h1_.rowwise() * coriolis) - across(centrifugal);
  F_y[1] = along(g1_.rowwise() * coriolis) + across(Angles::Constant(N, c_y));
  F_y[2] = across(Angles::Constant(N, mu));

  const auto transposed = [&](const Field& field) -> Field {
    return transposed_times(rule_.integral, field.colwise() * W).array();
  };
  const Field by_u = transposed(f.f_y + p_.rowwise() * turn_y + w_.rowwise() * centrifugal);
  const Field by_u1 = transposed(p_.rowwise() * coriolis - c_x * w_);
  const Field by_u2 = transposed(-mu * w_);
  const Field by_w = (w_.rowwise() * turn_x - f.f_x - p_.rowwise() * centrifugal).colwise() * W;
  const Field by_w1 = (c_y * p_ + w_.rowwise() * coriolis).colwise() * W;
  const Field by_w2 = (mu * p_).colwise() * W;
  const Field K_ab = -a_ * g2_;
  const Field psi2_a = K_ab * a2_ - g2_ * k_ * k_ * (1 + 2 * a_ * a_) * a1_ * a1_;
  const Field rotary = (rod_.rotary * W).matrix().replicate(1, N).array();

  moment[0] = transposed_times(rule_.s1, g1_ * by_u + h1_ * by_u1 + h2_ * by_u2 + rotary * psi2_a) +
              transposed_times(rule_.s, by_w);
  moment[1] = transposed_times(rule_.s1, g1_ * by_u1 + 2 * h1_ * by_u2 + 2 * rotary * K_ab * a1_) +
              transposed_times(rule_.s, by_w1);
  moment[2] = transposed_times(rule_.s1, g1_ * by_u2 + rotary * k_) + transposed_times(rule_.s, by_w2);
}

}  // namespace hb::exact
