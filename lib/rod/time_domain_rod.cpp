#include "lib/rod/time_domain_rod.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "lib/constants.hpp"
#include "lib/dense.hpp"
#include "lib/linkage/kinematics.hpp"
#include "lib/rod/shear.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;

double cross(Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); }

// Gauss-Legendre rule on (0, l): roots of P_n by Newton's iteration, weights 2/((1-s^2) P_n'(s)^2).
struct Quadrature {
  Eigen::VectorXd x, weight;

  Quadrature(Eigen::Index n, double l) : x(n), weight(n) {
    for (Eigen::Index j = 0; j < n; ++j) {
      double s = std::cos(pi * (static_cast<double>(j) + 0.75) / (static_cast<double>(n) + 0.5)), slope = 1;
      for (int step = 0; step < 8; ++step) {
        double p0 = 1, p1 = s;
        for (Eigen::Index k = 2; k <= n; ++k) {
          const double kk = static_cast<double>(k);
          const double p2 = ((2 * kk - 1) * s * p1 - (kk - 1) * p0) / kk;
          p0 = p1;
          p1 = p2;
        }
        slope = static_cast<double>(n) * (s * p1 - p0) / (s * s - 1);
        s -= p1 / slope;
      }
      x(j) = l * (1 - s) / 2;
      weight(j) = l / ((1 - s * s) * slope * slope);
    }
  }
};

// ---- One global Newton-Euler system per crank angle ----
//
// Unknowns: crank pivot force (2), torque; per dyad joint 0 (2), joint 1 (2), then rocker pivot (2) or guide force (1).
// Rows: per body the two force balances in global x, y and, sliders apart, the moment about its joint 0.
struct Unknowns {
  Eigen::Index joint0, joint1, ground;
};

struct Layout {
  std::vector<Unknowns> dyads;
  std::vector<Eigen::Index> row;  // first row of each body
  Eigen::Index size = 3;

  explicit Layout(const Linkage& linkage) {
    row.push_back(0);
    Eigen::Index rows = 3;
    for (const Dyad& dyad : linkage.dyads) {
      const bool slides = std::holds_alternative<Slider>(dyad.closing);
      dyads.push_back({size, size + 2, size + 4});
      size += slides ? 5 : 6;
      row.push_back(rows);
      row.push_back(rows + 3);
      rows += slides ? 5 : 6;
    }
    assert(rows == size);
  }
};

// Coefficients of "unknown force (two columns from `column`) times sign acts on the body at `arm` from its joint 0".
void apply_force(Eigen::MatrixXd& A, Eigen::Index row, Eigen::Index column, Complex arm, double sign, bool has_moment) {
  A(row, column) += sign;
  A(row + 1, column + 1) += sign;
  if (has_moment) {
    A(row + 2, column) -= sign * arm.imag();
    A(row + 2, column + 1) += sign * arm.real();
  }
}

Eigen::MatrixXd equilibrium_matrix(const Linkage& linkage, const Layout& layout,
                                   const std::vector<BodyMotion>& motion) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(layout.size, layout.size);
  apply_force(A, 0, 0, 0.0, 1, true);
  A(2, 2) = 1;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const Dyad& dyad = linkage.dyads[d];
    const Unknowns& u = layout.dyads[d];
    const auto b = static_cast<std::size_t>(coupler_index(static_cast<int>(d)));
    const auto carrier = static_cast<std::size_t>(dyad.on.body);
    const Body* carrier_body = body_at(linkage, dyad.on.body);
    apply_force(A, layout.row[carrier], u.joint0, motion[carrier].e * dyad.on.point, 1, carrier_body != nullptr);
    apply_force(A, layout.row[b], u.joint0, 0.0, -1, true);
    apply_force(A, layout.row[b], u.joint1, motion[b].e * dyad.coupler.length, 1, true);
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      apply_force(A, layout.row[b + 1], u.joint1, motion[b + 1].e * rocker->body.length, -1, true);
      apply_force(A, layout.row[b + 1], u.ground, 0.0, 1, true);
    } else {
      const double gamma = std::get<Slider>(dyad.closing).direction;
      apply_force(A, layout.row[b + 1], u.joint1, 0.0, -1, false);
      A(layout.row[b + 1], u.ground) -= std::sin(gamma);
      A(layout.row[b + 1] + 1, u.ground) += std::cos(gamma);
    }
  }
  return A;
}

// Force per length that gravity, inertia and external damping ask of a rigid rod at distance x from joint 0.
Complex line_load(const Body& body, const BodyMotion& motion, double gravity, double Omega, double x) {
  const Elastic& elastic = *body.elastic;
  const double mu = body.mass / body.length;
  const Complex v = Omega * motion.velocity(x), a = Omega * Omega * motion.acceleration(x);
  const Complex v_rod = std::conj(motion.e) * v;
  const Complex drag(elastic.damping_x * v_rod.real(), elastic.damping_y * v_rod.imag());
  return mu * (a + Complex(0, gravity)) + motion.e * drag;
}

// Sum of forces and moment about joint 0 that a body's rigid motion needs. The rod's line load is linear in x, so two
// Gauss points integrate x * load exactly.
struct Wrench {
  Complex force;
  double moment;
};

Wrench rigid_wrench(const Body& body, const BodyMotion& motion, double gravity, double Omega) {
  if (!body.elastic) {
    const Complex force = body.mass * (Omega * Omega * motion.acceleration(body.com) + Complex(0, gravity));
    return {force, cross(motion.e * body.com, force) + body.inertia * Omega * Omega * motion.phi2};
  }
  const double l = body.length;
  Wrench wrench{0.0, body.elastic->density * body.elastic->second_moment * l * Omega * Omega * motion.phi2};
  for (const double s : {0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)}) {
    const Complex force = l / 2 * line_load(body, motion, gravity, Omega, s * l);
    wrench.force += force;
    wrench.moment += cross(motion.e * (s * l), force);
  }
  return wrench;
}

// Terms of the wrench linear in w. A point of the rod stands at z + e (x + i w), so that
//   v = z' + i phi' e (x + i w) + i e w',   a = z'' + (i phi'' - phi'^2) e (x + i w) - 2 phi' e w' + i e w'',
// and the moment gains w along y against the rigid line load.
Wrench elastic_wrench(const Body& body, const BodyMotion& motion, double gravity, double Omega,
                      const LinkDeflection& deflection) {
  const Elastic& elastic = *body.elastic;
  const double l = body.length, mu = body.mass / l;
  const Eigen::Index I = deflection.q.size();
  Wrench wrench{0.0, 0.0};
  const Quadrature rule(16 + I, l);
  for (Eigen::Index j = 0; j < rule.x.size(); ++j) {
    const double x = rule.x(j);
    double w = 0, w1 = 0, w2 = 0;
    for (Eigen::Index i = 0; i < I; ++i) {
      const double s = std::sin(static_cast<double>(i + 1) * pi * x / l);
      w += s * deflection.q(i);
      w1 += s * deflection.q1(i);
      w2 += s * deflection.q2(i);
    }
    const double phi1 = motion.phi1, phi2 = motion.phi2;
    const Complex a(-phi2 * w - 2 * phi1 * w1, -phi1 * phi1 * w + w2);
    const Complex v(-phi1 * w, w1);
    const Complex load =
        Omega * Omega * mu * a + Omega * Complex(elastic.damping_x * v.real(), elastic.damping_y * v.imag());
    const Complex rigid_load = std::conj(motion.e) * line_load(body, motion, gravity, Omega, x);
    wrench.force += rule.weight(j) * motion.e * load;
    wrench.moment += rule.weight(j) * (x * load.imag() + cross(Complex(0, w), rigid_load));
  }
  return wrench;
}

double applied_force(const Slider& slider, double tau) {
  double force = 0;
  for (Eigen::Index k = 0; k < slider.force.c.cols(); ++k) {
    const double kt = static_cast<double>(k) * tau;
    const Complex c = slider.force.c(0, k);
    force += (k == 0 ? 1 : 2) * (c.real() * std::cos(kt) - c.imag() * std::sin(kt));
  }
  return force;
}

Eigen::VectorXd required_wrenches(const Linkage& linkage, const Layout& layout, const std::vector<BodyMotion>& motion,
                                  double Omega, double tau, const std::vector<LinkDeflection>& deflections) {
  Eigen::VectorXd b = Eigen::VectorXd::Zero(layout.size);
  for (int k = 0; k < linkage.num_bodies(); ++k) {
    const auto n = static_cast<std::size_t>(k);
    const Eigen::Index row = layout.row[n];
    if (const Body* body = body_at(linkage, k)) {
      const Wrench wrench = rigid_wrench(*body, motion[n], linkage.gravity, Omega);
      b(row) = wrench.force.real();
      b(row + 1) = wrench.force.imag();
      b(row + 2) = wrench.moment;
    } else {
      const auto& slider = std::get<Slider>(linkage.dyads[(n - 2) / 2].closing);
      const Complex force = slider.mass * (Omega * Omega * motion[n].z2 + Complex(0, linkage.gravity)) -
                            applied_force(slider, tau) * std::polar(1.0, slider.direction);
      b(row) = force.real();
      b(row + 1) = force.imag();
    }
  }
  for (const LinkDeflection& deflection : deflections) {
    const auto n = static_cast<std::size_t>(deflection.link);
    const Wrench wrench =
        elastic_wrench(*body_at(linkage, deflection.link), motion[n], linkage.gravity, Omega, deflection);
    b(layout.row[n]) += wrench.force.real();
    b(layout.row[n] + 1) += wrench.force.imag();
    b(layout.row[n] + 2) += wrench.moment;
  }
  return b;
}

Eigen::VectorXd solve_forces(const Linkage& linkage, const Layout& layout, const std::vector<BodyMotion>& motion,
                             double Omega, double tau, const std::vector<LinkDeflection>& deflections) {
  const Eigen::MatrixXd A = equilibrium_matrix(linkage, layout, motion);
  return dense::Lu<double>(A).solve(required_wrenches(linkage, layout, motion, Omega, tau, deflections));
}

Complex force_at(const Eigen::VectorXd& forces, Eigen::Index column) { return {forces(column), forces(column + 1)}; }

// Force on an elastic link at its joint 1, global frame.
Complex force_at_joint1(const Layout& layout, const Eigen::VectorXd& forces, int link) {
  assert(link > 0);
  const auto d = static_cast<std::size_t>((link - 1) / 2);
  const Complex force = force_at(forces, layout.dyads[d].joint1);
  return link == coupler_index(static_cast<int>(d)) ? force : -force;
}

// Integrals over (0, l) that the weak form needs, times 2/l, with s_i = sin(i pi x/l):
//   slope[p] = (x/l)^p s_i' s_k'  (p = 0, 1, 2)     bend = s_i'' s_k''     first[p] = (x/l)^p s_i  (p = 0, 1)
struct ShapeIntegrals {
  std::array<Eigen::MatrixXd, 3> slope;
  Eigen::MatrixXd product, bend;
  std::array<Eigen::VectorXd, 2> first;

  // s_i s_k oscillates at most 2 I half waves: 2 I + 24 Gauss points are exact to rounding.
  ShapeIntegrals(Eigen::Index I, double l) {
    const Quadrature rule(2 * I + 24, l);
    Eigen::MatrixXd s(I, rule.x.size()), s1(I, rule.x.size()), s2(I, rule.x.size());
    for (Eigen::Index i = 0; i < I; ++i) {
      const double k = static_cast<double>(i + 1) * pi / l;
      s.row(i) = (k * rule.x.array()).sin();
      s1.row(i) = k * (k * rule.x.array()).cos();
      s2.row(i) = -k * k * s.row(i);
    }
    const Eigen::VectorXd u = rule.x / l, weight = 2 / l * rule.weight;
    Eigen::VectorXd factor = weight;
    for (std::size_t p = 0; p < 3; ++p) {
      slope[p] = s1 * factor.asDiagonal() * s1.transpose();
      if (p < 2) first[p] = s * factor;
      factor = factor.cwiseProduct(u).eval();
    }
    product = s * weight.asDiagonal() * s.transpose();
    bend = s2 * weight.asDiagonal() * s2.transpose();
  }
};

}  // namespace

// Virtual work of a deflection s_k on the rod, per EJ and times 2/l:
//   EJ int s_i'' s_k'' (q_i + alpha_c q_i,t) + int N s_i' s_k' q_i + int mu s_i s_k (q_i,tt - phi_t^2 q_i)
//   + rho J int s_i' s_k' q_i,tt + c_y int s_i s_k q_i,t = - int s_k p_y
// with the rigid line load p: N = X - int_x^l p_x, quadratic in x; p_y linear in x.
// With shear the section's rotation sum p_i s_i' takes the place of w' in bending and rotary inertia, and
//   k G F int (s_k' (w' - rotation)) of both signs and with (1 + alpha_c d/dt) couples q and p.
TimeDomainSystem time_domain_rod(const Linkage& linkage, int link, Eigen::Index num_modes, double speed) {
  if (!(speed > 0 && std::isfinite(speed)))
    throw std::invalid_argument("time_domain_rod: speed must be positive and finite, is " + std::to_string(speed));
  const Body* body = body_at(linkage, link);
  if (body == nullptr || !body->elastic || num_modes < 1)
    throw std::invalid_argument("time_domain_rod: body " + std::to_string(link) + " with " + std::to_string(num_modes) +
                                " modes is no elastic link");
  const Elastic elastic = *body->elastic;
  const double l = body->length, mu = body->mass / l, EJ = elastic.youngs_modulus * elastic.second_moment;
  const ShapeIntegrals shapes(num_modes, l);

  TimeDomainSystem system;
  system.speed = speed;
  // Orthogonal shapes: what quadrature leaves beside the diagonal is rounding.
  const Eigen::MatrixXd product = shapes.product.diagonal().asDiagonal();
  const Eigen::MatrixXd slope = shapes.slope[0].diagonal().asDiagonal();
  const Eigen::MatrixXd bend = shapes.bend.diagonal().asDiagonal();
  system.mass = mu / EJ * product + elastic.density / elastic.youngs_modulus * slope;
  system.damping = elastic.internal_damping * bend + elastic.damping_y / EJ * product;
  Eigen::MatrixXd at_rest = bend;
  if (num_unknowns(*body, num_modes) > num_modes) {
    const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(num_modes, num_modes);
    const Eigen::MatrixXd shear = elastic.shear->coefficient * elastic.shear->modulus * elastic.area / EJ * slope;
    const auto blocks = [&](const Eigen::MatrixXd& qq, const Eigen::MatrixXd& qp, const Eigen::MatrixXd& pp) {
      Eigen::MatrixXd whole(2 * num_modes, 2 * num_modes);
      whole << qq, qp, qp, pp;
      return whole;
    };
    at_rest = blocks(shear, -shear, shear + bend);
    system.mass = blocks(mu / EJ * product, zero, elastic.density / elastic.youngs_modulus * slope);
    system.damping = elastic.internal_damping * at_rest + blocks(elastic.damping_y / EJ * product, zero, zero);
  }
  const Layout layout(linkage);
  std::vector<BodyMotion> motion;

  system.evaluate = [linkage, link, num_modes, speed, shapes, at_rest, product, layout, motion, l, mu, EJ](
                        double tau, Eigen::Ref<Eigen::MatrixXd> C, Eigen::Ref<Eigen::VectorXd> h) mutable {
    motion_at(linkage, tau, motion);
    const Eigen::VectorXd forces = solve_forces(linkage, layout, motion, speed, tau, {});
    const BodyMotion& rod = motion[static_cast<std::size_t>(link)];
    const Body& body = *body_at(linkage, link);
    const Complex turn = std::conj(rod.e);
    const double X = (turn * force_at_joint1(layout, forces, link)).real();
    // p = p0 + (p1 - p0) x/l from its ends; N = X - l [ (p0 + p1)/2 - u p0 - u^2 (p1 - p0)/2 ], u = x/l.
    const Complex p0 = turn * line_load(body, rod, linkage.gravity, speed, 0);
    const Complex p1 = turn * line_load(body, rod, linkage.gravity, speed, l);
    const double N0 = X - l * (p0.real() + p1.real()) / 2, N1 = l * p0.real(), N2 = l * (p1 - p0).real() / 2;
    const double phi_t = speed * rod.phi1;
    C = at_rest;
    C.topLeftCorner(num_modes, num_modes) = at_rest.topLeftCorner(num_modes, num_modes) +
                                            (N0 * shapes.slope[0] + N1 * shapes.slope[1] + N2 * shapes.slope[2]) / EJ -
                                            mu * phi_t * phi_t / EJ * product;
    h.setZero();
    h.head(num_modes) = (-p0.imag() * shapes.first[0] - (p1 - p0).imag() * shapes.first[1]) / EJ;
  };
  return system;
}

std::vector<ForceLabel> force_labels(const Linkage& linkage) {
  std::vector<ForceLabel> labels;
  const auto vector = [&](const std::string& joint) {
    labels.push_back({joint, "x"});
    labels.push_back({joint, "y"});
  };
  vector(linkage.crank.body.name + ".pivot");
  for (const Dyad& dyad : linkage.dyads) {
    vector(dyad.coupler.name + ".0");
    vector(dyad.coupler.name + ".1");
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      if (rocker->body.elastic) {
        vector(rocker->body.name + ".0");
        vector(rocker->body.name + ".1");
      }
      vector(rocker->body.name + ".pivot");
    } else {
      labels.push_back({std::get<Slider>(dyad.closing).name + ".guide", "n"});
    }
  }
  labels.push_back({"torque", ""});
  return labels;
}

Eigen::VectorXd joint_forces_at(const Linkage& linkage, double speed, double crank_angle,
                                const std::vector<LinkDeflection>& deflections) {
  const Layout layout(linkage);
  const std::vector<BodyMotion> motion = motion_at(linkage, crank_angle);
  const Eigen::VectorXd forces = solve_forces(linkage, layout, motion, speed, crank_angle, deflections);
  std::vector<double> listed;
  const auto vector = [&](Complex force, Complex e) {
    const Complex resolved = std::conj(e) * force;
    listed.push_back(resolved.real());
    listed.push_back(resolved.imag());
  };
  vector(force_at(forces, 0), linkage.dyads.empty() ? motion[0].e : motion[1].e);
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const Unknowns& u = layout.dyads[d];
    const auto b = static_cast<std::size_t>(coupler_index(static_cast<int>(d)));
    const Complex joint1 = force_at(forces, u.joint1);
    vector(force_at(forces, u.joint0), motion[b].e);
    vector(joint1, motion[b].e);
    if (const auto* rocker = std::get_if<Rocker>(&linkage.dyads[d].closing)) {
      const Complex pivot = force_at(forces, u.ground);
      if (rocker->body.elastic) {
        vector(-pivot, motion[b + 1].e);
        vector(-joint1, motion[b + 1].e);
      }
      vector(pivot, motion[b].e);
    } else {
      listed.push_back(forces(u.ground));
    }
  }
  listed.push_back(forces(2));
  return Eigen::Map<const Eigen::VectorXd>(listed.data(), static_cast<Eigen::Index>(listed.size()));
}

}  // namespace hb
