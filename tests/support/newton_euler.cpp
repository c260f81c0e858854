#include "tests/support/newton_euler.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace hb::newton_euler {
namespace {

using Real = long double;
using Complex = std::complex<Real>;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

constexpr Real pi = std::numbers::pi_v<Real>;
const Complex i{0, 1};

Complex wide(std::complex<double> z) { return {z.real(), z.imag()}; }
std::complex<double> narrow(Complex z) { return {static_cast<double>(z.real()), static_cast<double>(z.imag())}; }
Complex direction(Real angle) { return {std::cos(angle), std::sin(angle)}; }
Real dot(Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); }
Real cross(Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); }

// ---------------------------------------------------------------------------------------------------------- positions

struct Frame {
  Complex z, e;
};

// Where two circles meet; the solution to the left of the line from the first centre to the second if side > 0.
Complex circles_meet(Complex centre1, Real radius1, Complex centre2, Real radius2, int side) {
  const Complex d = centre2 - centre1;
  const Real along = (radius1 * radius1 - radius2 * radius2 + std::norm(d)) / (2 * std::abs(d));
  const Real across = std::sqrt(radius1 * radius1 - along * along);
  return centre1 + d / std::abs(d) * Complex(along, side > 0 ? across : -across);
}

// Where a circle meets the line p + s e^{i gamma}; the larger s if side > 0.
Complex circle_meets_line(Complex centre, Real radius, Complex p, Complex e, int side) {
  const Complex foot = p + e * dot(e, centre - p);
  const Real s = std::sqrt(radius * radius - std::norm(centre - foot));
  return foot + e * (side > 0 ? s : -s);
}

std::vector<Frame> positions(const Linkage& linkage, Real tau) {
  std::vector<Frame> frames{{wide(linkage.crank.pivot), direction(tau)}};
  for (const Dyad& dyad : linkage.dyads) {
    const Frame& on = frames[static_cast<std::size_t>(dyad.on.body)];
    const Complex start = on.z + on.e * wide(dyad.on.point);
    const Real l = dyad.coupler.length;
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      const Complex pivot = wide(rocker->pivot);
      const Complex end = circles_meet(pivot, rocker->body.length, start, l, dyad.branch);
      frames.push_back({start, (end - start) / l});
      frames.push_back({pivot, (end - pivot) / Real(rocker->body.length)});
    } else {
      const auto& slider = std::get<Slider>(dyad.closing);
      const Complex e = direction(slider.direction);
      const Complex end = circle_meets_line(start, l, wide(slider.guide), e, dyad.branch);
      frames.push_back({start, (end - start) / l});
      frames.push_back({end, e});
    }
  }
  return frames;
}

// -------------------------------------------------------------------------------------------------------- derivatives

// Functions of the crank angle with their first two derivatives.
struct Jet {
  std::vector<Complex> f, f1, f2;
};

// Central differences on 2p+1 points: f' = sum_k a_k [f(kh) - f(-kh)]/h, a_k = (-1)^{k+1} p!^2/(k (p-k)! (p+k)!), and
// f'' = sum_k (2 a_k/k) [f(kh) + f(-kh) - 2 f(0)]/h^2. Harmonic n is wrong by about (n h/2)^{2p}; rounding is
// 1e-19/h^2.
Jet differences(const std::function<std::vector<Complex>(Real)>& f, Real tau) {
  constexpr int p = 12;
  constexpr Real h = 0.003L;
  Jet jet{f(tau), {}, {}};
  jet.f1.assign(jet.f.size(), 0);
  jet.f2.assign(jet.f.size(), 0);
  Real ratio = 1;  // p!^2/((p-k)! (p+k)!)
  for (int k = 1; k <= p; ++k) {
    ratio *= Real(p - k + 1) / Real(p + k);
    const Real a = (k % 2 == 1 ? ratio : -ratio) / Real(k);
    const std::vector<Complex> forward = f(tau + k * h);
    const std::vector<Complex> backward = f(tau - k * h);
    for (std::size_t j = 0; j < jet.f.size(); ++j) {
      jet.f1[j] += a / h * (forward[j] - backward[j]);
      jet.f2[j] += 2 * a / (k * h * h) * (forward[j] + backward[j] - Real(2) * jet.f[j]);
    }
  }
  return jet;
}

struct Motion {
  Complex z, z1, z2, e, e1, e2;
  Real turn1() const { return cross(e, e1); }  // phi' and phi'': e' = i phi' e, e'' = (i phi'' - phi'^2) e
  Real turn2() const { return cross(e, e2); }
  Complex position(Complex p) const { return z + e * p; }
  Complex velocity(Complex p) const { return z1 + e1 * p; }
  Complex acceleration(Complex p) const { return z2 + e2 * p; }
};

std::vector<Motion> motions(const Linkage& linkage, Real tau) {
  const Jet jet = differences(
      [&](Real t) {
        std::vector<Complex> values;
        for (const Frame& frame : positions(linkage, t)) {
          values.push_back(frame.z);
          values.push_back(frame.e);
        }
        return values;
      },
      tau);
  std::vector<Motion> result;
  for (std::size_t j = 0; j < jet.f.size(); j += 2)
    result.push_back({jet.f[j], jet.f1[j], jet.f2[j], jet.f[j + 1], jet.f1[j + 1], jet.f2[j + 1]});
  return result;
}

Real series_value(const FourierSeries& series, Eigen::Index component, Real tau) {
  Real value = series.c.cols() > 0 ? Real(series.c(component, 0).real()) : 0;
  for (Eigen::Index n = 1; n < series.c.cols(); ++n)
    value += 2 * (wide(series.c(component, n)) * direction(Real(n) * tau)).real();
  return value;
}

// --------------------------------------------------------------------------------------------------------- quadrature

struct Gauss {
  std::vector<Real> x, weight;  // on [0, 1]
};

// Roots of the Legendre polynomial by Newton.
Gauss gauss_rule(int n) {
  Gauss rule;
  for (int k = 0; k < n; ++k) {
    Real x = std::cos(pi * (k + 0.75L) / (n + 0.5L));
    Real slope = 0;
    for (int iteration = 0; iteration < 20; ++iteration) {
      Real before = 1;
      Real now = x;
      for (int j = 2; j <= n; ++j) {
        const Real next = ((2 * j - 1) * x * now - (j - 1) * before) / j;
        before = now;
        now = next;
      }
      slope = n * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    rule.x.push_back((1 + x) / 2);
    rule.weight.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

const Gauss& fine_rule() {  // products of two sine shapes up to 20 half waves
  static const Gauss rule = gauss_rule(64);
  return rule;
}

const Gauss& coarse_rule() {  // polynomials
  static const Gauss rule = gauss_rule(4);
  return rule;
}

// -------------------------------------------------------------------------------------------------------------- loads

// What the forces of the joints on a body must add up to, and their moment about `about`.
struct Load {
  Complex about, force;
  Real moment = 0;
};

// d'Alembert's load per length of a point of a rod with velocity v, acceleration a: mu (a - g) + damping.
Complex load_density(const Linkage& linkage, const Body& rod, Complex e, Complex v, Complex a) {
  const Elastic& elastic = *rod.elastic;
  const Real mu = Real(rod.mass) / Real(rod.length);
  const Complex drag = Real(elastic.damping_x) * dot(e, v) + i * (Real(elastic.damping_y) * cross(e, v));
  return mu * (a + i * Real(linkage.gravity)) + e * drag;
}

// The rod bent to z + e (x + i w): q[k] the jets of e q_k, sign = +1, 0, -1 times w.
Load bent_rod_load(const Linkage& linkage, const Body& rod, const Motion& motion, Real Omega, const Jet& eq,
                   Real sign) {
  const Real l = rod.length;
  const Real rho_J = Real(rod.elastic->density) * Real(rod.elastic->second_moment);
  Load load{motion.position(l / 2), 0, 0};
  for (std::size_t m = 0; m < fine_rule().x.size(); ++m) {
    const Real x = l * fine_rule().x[m];
    const Real dx = l * fine_rule().weight[m];
    Complex r = motion.position(x), v = motion.velocity(x), a = motion.acceleration(x);
    Complex tangent2 = motion.e2;  // second derivative of the section's direction, to first order in w'
    Complex tangent = motion.e;
    for (std::size_t k = 0; k < eq.f.size(); ++k) {
      const Real kappa = Real(k + 1) * pi / l;
      const Complex shape = sign * i * std::sin(kappa * x);
      r += shape * eq.f[k];
      v += shape * eq.f1[k];
      a += shape * eq.f2[k];
      tangent += sign * i * kappa * std::cos(kappa * x) * eq.f[k];
      tangent2 += sign * i * kappa * std::cos(kappa * x) * eq.f2[k];
    }
    const Complex f = load_density(linkage, rod, motion.e, Omega * v, Omega * Omega * a);
    load.force += f * dx;
    load.moment += (cross(r - load.about, f) + rho_J * Omega * Omega * cross(tangent, tangent2)) * dx;
  }
  return load;
}

Load rod_load(const Linkage& linkage, int link, const Motion& motion, Real tau, Real Omega,
              const std::vector<LinkResponse>& responses) {
  const Body& rod = *body_at(linkage, link);
  Load load = bent_rod_load(linkage, rod, motion, Omega, {}, 0);
  for (const LinkResponse& response : responses) {
    if (response.link != link) continue;
    const Jet eq = differences(
        [&](Real t) {
          const Complex e = positions(linkage, t)[static_cast<std::size_t>(link)].e;
          std::vector<Complex> values;
          for (Eigen::Index k = 0; k < response.q.num_components(); ++k)
            values.push_back(e * series_value(response.q, k, t));
          return values;
        },
        tau);
    // The part odd in w is the linear one: the load has no higher power than the second.
    const Load plus = bent_rod_load(linkage, rod, motion, Omega, eq, 1);
    const Load minus = bent_rod_load(linkage, rod, motion, Omega, eq, -1);
    load.force += (plus.force - minus.force) / Real(2);
    load.moment += (plus.moment - minus.moment) / 2;
  }
  return load;
}

Load body_load(const Linkage& linkage, int index, const Motion& motion, Real tau, Real Omega,
               const std::vector<LinkResponse>& responses) {
  const Complex gravity = -i * Real(linkage.gravity);
  const Body* body = body_at(linkage, index);
  if (!body) {
    const auto& slider = std::get<Slider>(linkage.dyads[static_cast<std::size_t>(index / 2 - 1)].closing);
    const Complex inertia = Real(slider.mass) * (Omega * Omega * motion.z2 - gravity);
    const Real applied = slider.force.c.size() > 0 ? series_value(slider.force, 0, tau) : 0;
    return {motion.z, inertia - applied * motion.e, 0};
  }
  if (body->elastic) return rod_load(linkage, index, motion, tau, Omega, responses);
  const Complex com = wide(body->com);
  return {motion.position(com), Real(body->mass) * (Omega * Omega * motion.acceleration(com) - gravity),
          Real(body->inertia) * Omega * Omega * motion.turn2()};
}

// ------------------------------------------------------------------------------------------------------ Newton, Euler

struct WideForces {
  std::vector<std::array<Complex, 3>> dyads;  // joint0 as passed on, joint1 on the coupler, ground
  Complex crank_pivot;
  Real torque = 0;
};

// Unknown column c acts on body b at `point` in the direction `u`: two force rows and one moment row per body.
struct Equations {
  Matrix A;
  Vector right;
  std::vector<Load> loads;

  void force(int body, Eigen::Index column, Complex point, Complex u) {
    A(3 * body, column) += u.real();
    A(3 * body + 1, column) += u.imag();
    A(3 * body + 2, column) += cross(point - loads[static_cast<std::size_t>(body)].about, u);
  }
  void vector_force(int body, Eigen::Index column, Complex point, Real sign) {
    force(body, column, point, sign);
    force(body, column + 1, point, sign * i);
  }
};

WideForces solve(const Linkage& linkage, Real tau, Real Omega, const std::vector<LinkResponse>& responses) {
  const std::vector<Motion> motion = motions(linkage, tau);
  const int num_bodies = linkage.num_bodies();
  Equations equations{Matrix::Zero(3 * num_bodies, 3 * num_bodies), Vector::Zero(3 * num_bodies), {}};
  for (int b = 0; b < num_bodies; ++b) {
    const Load load = body_load(linkage, b, motion[static_cast<std::size_t>(b)], tau, Omega, responses);
    equations.loads.push_back(load);
    equations.right.segment(3 * b, 3) << load.force.real(), load.force.imag(), load.moment;
  }
  // Columns: crank pivot (2), torque (1); per dyad joint 0 (2), joint 1 (2), and pivot (2) or guide's force and moment.
  equations.vector_force(0, 0, motion[0].z, 1);
  equations.A(2, 2) = 1;
  for (int d = 0; d < static_cast<int>(linkage.dyads.size()); ++d) {
    const Dyad& dyad = linkage.dyads[static_cast<std::size_t>(d)];
    const Motion& coupler = motion[static_cast<std::size_t>(coupler_index(d))];
    const Motion& closing = motion[static_cast<std::size_t>(closing_index(d))];
    const Complex end = coupler.position(dyad.coupler.length);
    const Eigen::Index column = 3 + 6 * d;
    equations.vector_force(coupler_index(d), column, coupler.z, -1);
    equations.vector_force(dyad.on.body, column, coupler.z, 1);
    equations.vector_force(coupler_index(d), column + 2, end, 1);
    equations.vector_force(closing_index(d), column + 2, end, -1);
    if (std::holds_alternative<Rocker>(dyad.closing)) {
      equations.vector_force(closing_index(d), column + 4, closing.z, 1);
    } else {
      equations.force(closing_index(d), column + 4, closing.z, i * closing.e);
      equations.A(3 * closing_index(d) + 2, column + 5) = 1;
    }
  }
  const Vector u = equations.A.partialPivLu().solve(equations.right);

  WideForces result;
  result.crank_pivot = {u(0), u(1)};
  result.torque = u(2);
  for (int d = 0; d < static_cast<int>(linkage.dyads.size()); ++d) {
    const Eigen::Index c = 3 + 6 * d;
    const bool slides = std::holds_alternative<Slider>(linkage.dyads[static_cast<std::size_t>(d)].closing);
    const Complex normal = i * motion[static_cast<std::size_t>(closing_index(d))].e;
    result.dyads.push_back({Complex(u(c), u(c + 1)), Complex(u(c + 2), u(c + 3)),
                            slides ? u(c + 4) * normal : Complex(u(c + 4), u(c + 5))});
  }
  return result;
}

// Rigid force of joint 1 on an elastic link, a coupler or a rocker.
Complex end_force(const WideForces& forces, int link) {
  const auto& dyad = forces.dyads[static_cast<std::size_t>((link - 1) / 2)];
  return link % 2 == 1 ? dyad[1] : -dyad[1];
}

}  // namespace

double closing_margin(const Linkage& linkage, double crank_angle) {
  const std::vector<Frame> frames = positions(linkage, crank_angle);
  Real margin = std::numeric_limits<Real>::infinity();
  for (int d = 0; d < static_cast<int>(linkage.dyads.size()); ++d) {
    const Complex e = frames[static_cast<std::size_t>(coupler_index(d))].e;
    const Complex other = frames[static_cast<std::size_t>(closing_index(d))].e;
    const bool slides = std::holds_alternative<Slider>(linkage.dyads[static_cast<std::size_t>(d)].closing);
    const Real sine = std::abs(slides ? dot(e, other) : cross(e, other));
    if (!(std::abs(std::abs(e) - 1) <= 1e-9L)) return std::numeric_limits<double>::quiet_NaN();
    if (!(sine >= margin)) margin = sine;
  }
  return static_cast<double>(margin);
}

std::complex<double> place(const Linkage& linkage, double crank_angle, int body, std::complex<double> point) {
  const Frame frame = positions(linkage, crank_angle)[static_cast<std::size_t>(body)];
  return narrow(frame.z + frame.e * wide(point));
}

std::vector<BodyMotion> motion(const Linkage& linkage, double crank_angle) {
  std::vector<BodyMotion> result;
  for (const Motion& m : motions(linkage, crank_angle))
    result.push_back({narrow(m.z), narrow(m.z1), narrow(m.z2), narrow(m.e), static_cast<double>(m.turn1()),
                      static_cast<double>(m.turn2())});
  return result;
}

MechanismForces forces(const Linkage& linkage, double crank_angle, double speed,
                       const std::vector<LinkResponse>& responses) {
  const WideForces wide_forces = solve(linkage, crank_angle, speed, responses);
  MechanismForces result;
  for (const auto& dyad : wide_forces.dyads)
    result.dyads.push_back({narrow(dyad[0]), narrow(dyad[1]), narrow(dyad[2])});
  result.crank_pivot = narrow(wide_forces.crank_pivot);
  result.torque = static_cast<double>(wide_forces.torque);
  return result;
}

std::map<std::string, std::vector<double>> joint_components(const Linkage& linkage, double crank_angle,
                                                            const MechanismForces& forces) {
  const std::vector<Motion> motion = motions(linkage, crank_angle);
  std::map<std::string, std::vector<double>> result;
  const auto put = [&](const std::string& name, std::complex<double> force, int frame) {
    const std::complex<double> resolved = std::conj(narrow(motion[static_cast<std::size_t>(frame)].e)) * force;
    result[name] = {resolved.real(), resolved.imag()};
  };
  put(linkage.crank.body.name + ".pivot", forces.crank_pivot, coupler_index(0));
  for (int d = 0; d < static_cast<int>(linkage.dyads.size()); ++d) {
    const Dyad& dyad = linkage.dyads[static_cast<std::size_t>(d)];
    const DyadForces& at = forces.dyads[static_cast<std::size_t>(d)];
    put(dyad.coupler.name + ".0", at.joint0, coupler_index(d));
    put(dyad.coupler.name + ".1", at.joint1, coupler_index(d));
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      put(rocker->body.name + ".pivot", at.ground, coupler_index(d));
      if (rocker->body.elastic) {
        put(rocker->body.name + ".0", -at.ground, closing_index(d));
        put(rocker->body.name + ".1", -at.joint1, closing_index(d));
      }
    } else {
      const std::complex<double> e = narrow(motion[static_cast<std::size_t>(closing_index(d))].e);
      result[std::get<Slider>(dyad.closing).name + ".guide"] = {(std::conj(e) * at.ground).imag()};
    }
  }
  return result;
}

double lost_power(const Linkage& linkage, double crank_angle, double speed) {
  const Real Omega = speed;
  const std::vector<Motion> motion = motions(linkage, crank_angle);
  Real power = 0;
  for (int b = 0; b < linkage.num_bodies(); ++b) {
    const Motion& m = motion[static_cast<std::size_t>(b)];
    const Body* body = body_at(linkage, b);
    if (!body) {
      const auto& slider = std::get<Slider>(linkage.dyads[static_cast<std::size_t>(b / 2 - 1)].closing);
      if (slider.force.c.size() > 0) power -= series_value(slider.force, 0, crank_angle) * Omega * dot(m.e, m.z1);
    } else if (body->elastic) {
      const Real l = body->length;
      for (std::size_t k = 0; k < coarse_rule().x.size(); ++k) {
        const Complex v = Omega * m.velocity(l * coarse_rule().x[k]);
        power += l * coarse_rule().weight[k] *
                 (Real(body->elastic->damping_x) * dot(m.e, v) * dot(m.e, v) +
                  Real(body->elastic->damping_y) * cross(m.e, v) * cross(m.e, v));
      }
    }
  }
  return static_cast<double>(power);
}

// Virtual displacement s_i = sin(i pi x/l) in (3.3), times 2/l:
//   M = int [rho/E s_i' s_k' + mu/EJ s_i s_k],  B = int [alpha_c s_i'' s_k'' + c_y/EJ s_i s_k],
//   C = int [s_i'' s_k'' + N/EJ s_i' s_k' + mu/EJ s_i a_k],  h = -int p_y/EJ s_i,
// with N(x) = X - int_x^l p_x, p the rigid load density and a_k the transverse acceleration of the frozen shape s_k.
Ritz ritz(const Linkage& linkage, int link, double crank_angle, double speed, Eigen::Index num_modes) {
  const Real Omega = speed;
  const Body& rod = *body_at(linkage, link);
  const Elastic& elastic = *rod.elastic;
  const Real l = rod.length;
  const Real mu = Real(rod.mass) / l;
  const Real EJ = Real(elastic.youngs_modulus) * Real(elastic.second_moment);
  const Motion m = motions(linkage, crank_angle)[static_cast<std::size_t>(link)];
  const Real X = dot(m.e, end_force(solve(linkage, crank_angle, Omega, {}), link));
  const auto p = [&](Real x) {
    const Complex f = load_density(linkage, rod, m.e, Omega * m.velocity(x), Omega * Omega * m.acceleration(x));
    return Complex(dot(m.e, f), cross(m.e, f));
  };
  const Real frozen = Omega * Omega * cross(m.e, i * m.e2);  // transverse acceleration of i e w, per w

  const Eigen::Index I = num_modes;
  Matrix M = Matrix::Zero(I, I), B = M, C = M;
  Vector h = Vector::Zero(I), s(I), s1(I), s2(I);
  for (std::size_t j = 0; j < fine_rule().x.size(); ++j) {
    const Real x = l * fine_rule().x[j];
    const Real dx = 2 * fine_rule().weight[j];  // (2/l) dx
    Real N = X;
    for (std::size_t k = 0; k < coarse_rule().x.size(); ++k)
      N -= (l - x) * coarse_rule().weight[k] * p(x + (l - x) * coarse_rule().x[k]).real();
    for (Eigen::Index k = 0; k < I; ++k) {
      const Real kappa = Real(k + 1) * pi / l;
      s(k) = std::sin(kappa * x);
      s1(k) = kappa * std::cos(kappa * x);
      s2(k) = -kappa * kappa * s(k);
    }
    M +=
        dx * (Real(elastic.density) / Real(elastic.youngs_modulus) * s1 * s1.transpose() + mu / EJ * s * s.transpose());
    B += dx * (Real(elastic.internal_damping) * s2 * s2.transpose() + Real(elastic.damping_y) / EJ * s * s.transpose());
    C += dx * (s2 * s2.transpose() + N / EJ * s1 * s1.transpose() + mu / EJ * frozen * s * s.transpose());
    h -= dx * p(x).imag() / EJ * s;
  }
  return {M.cast<double>(), B.cast<double>(), C.cast<double>(), h.cast<double>()};
}

// The interpolant through N = 2H+1 angles has u'(tau_j) = sum_k D_jk u_k, D_jk = (-1)^{j-k}/(2 sin((tau_j-tau_k)/2)).
FourierSeries steady_state(const Linkage& linkage, int link, double speed, Eigen::Index num_modes,
                           Eigen::Index num_harmonics) {
  const Eigen::Index I = num_modes, N = 2 * num_harmonics + 1;
  const double step = 2 * std::numbers::pi / static_cast<double>(N);
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(N, N);
  for (Eigen::Index j = 0; j < N; ++j)
    for (Eigen::Index k = 0; k < N; ++k)
      if (j != k) D(j, k) = ((j - k) % 2 == 0 ? 0.5 : -0.5) / std::sin(static_cast<double>(j - k) * step / 2);
  const Eigen::MatrixXd D2 = D * D;

  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(I * N, I * N);
  Eigen::VectorXd b(I * N);
  for (Eigen::Index j = 0; j < N; ++j) {
    const Ritz at = ritz(linkage, link, static_cast<double>(j) * step, speed, I);
    for (Eigen::Index k = 0; k < N; ++k)
      A.block(I * j, I * k, I, I) = speed * speed * D2(j, k) * at.mass + speed * D(j, k) * at.damping;
    A.block(I * j, I * j, I, I) += at.stiffness;
    b.segment(I * j, I) = at.load;
  }
  const Eigen::VectorXd u = A.partialPivLu().solve(b);

  FourierSeries q(I, num_harmonics);
  for (Eigen::Index n = 0; n <= num_harmonics; ++n)
    for (Eigen::Index j = 0; j < N; ++j)
      q.c.col(n) +=
          u.segment(I * j, I) * std::polar(1.0 / static_cast<double>(N), -step * static_cast<double>(n * j % N));
  return q;
}

}  // namespace hb::newton_euler
