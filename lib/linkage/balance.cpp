#include "lib/linkage/balance.hpp"

#include <algorithm>
#include <numbers>

namespace hb {

namespace {

using Complex = std::complex<double>;

double dot(Complex a, Complex b) { return (std::conj(a) * b).real(); }
double cross(Complex a, Complex b) { return (std::conj(a) * b).imag(); }

// The applied force's series, nullptr if there is none.
const FourierSeries* slider_force(const Dyad& dyad) {
  const auto* slider = std::get_if<Slider>(&dyad.closing);
  return slider && slider->force.c.size() > 0 ? &slider->force : nullptr;
}

// Gravity, damping and inertia of one body; elastic links carry damping along their length.
void add_body_loads(const Body& body, double gravity, const BodyMotion& m, int index,
                    std::array<std::vector<BodyLoad>, 3>& loads) {
  const Complex r = m.e * body.com, weight(0, body.mass * gravity);
  loads[0][at(index)] = {weight, cross(r, weight)};
  const Complex inertia = body.mass * m.acceleration(body.com);
  loads[2][at(index)] = {inertia, cross(r, inertia) + body.inertia * m.phi2};
  if (!body.elastic) return;
  // (c_x v_x, c_y v_y) dx along the rod, v = v0 + i phi' x in the body frame.
  const double l = body.length;
  const Complex v0 = std::conj(m.e) * m.z1;
  const double along = body.elastic->damping_x * v0.real() * l;
  const double across = body.elastic->damping_y * (v0.imag() * l + m.phi1 * l * l / 2);
  const double moment = body.elastic->damping_y * (v0.imag() * l * l / 2 + m.phi1 * l * l * l / 3);
  loads[1][at(index)] = {m.e * Complex(along, across), moment};
}

}  // namespace

void rigid_loads(const Linkage& linkage, const std::vector<BodyMotion>& motion,
                 const Eigen::Ref<const Eigen::VectorXd>& slider_forces, std::array<std::vector<BodyLoad>, 3>& loads) {
  for (auto& power : loads) power.assign(at(linkage.num_bodies()), BodyLoad{});
  for (int index = 0; index < linkage.num_bodies(); ++index) {
    const BodyMotion& m = motion[at(index)];
    if (const Body* body = body_at(linkage, index)) {
      add_body_loads(*body, linkage.gravity, m, index, loads);
      continue;
    }
    const int d = (index - 1) / 2;
    const Slider& slider = std::get<Slider>(linkage.dyads[at(d)].closing);
    loads[0][at(index)].force = Complex(0, slider.mass * linkage.gravity) - slider_forces(d) * m.e;
    loads[2][at(index)].force = slider.mass * m.z2;
  }
}

std::array<std::vector<BodyLoad>, 3> rigid_loads(const Linkage& linkage, const std::vector<BodyMotion>& motion,
                                                 double crank_angle) {
  Eigen::VectorXd slider_forces = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(linkage.dyads.size()));
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d)
    if (const FourierSeries* force = slider_force(linkage.dyads[d]))
      slider_forces(static_cast<Eigen::Index>(d)) = fourier::evaluate(*force, crank_angle)(0);
  std::array<std::vector<BodyLoad>, 3> loads;
  rigid_loads(linkage, motion, slider_forces, loads);
  return loads;
}

// lib/README.md (M10) to (M12). Dyads in reverse order; what a later dyad passes on at its joint 0 is taken off the
// load of the body it hangs on. With the coupler's load (K, k) about its joint 0, F1 = (X + i Y) e^{i phi} on it at
// joint 1 and F0 passed on:
//     coupler:  l Y = k,   F0 = F1 - K
//     rocker, load (K', k') about its pivot, psi its angle:  L [X sin(phi-psi) + Y cos(phi-psi)] = -k',  G = K' + F1
//     slider, load K', guide direction u = e^{i gamma}:  X cos(phi-gamma) - Y sin(phi-gamma) = -Re(K'/u),
//                                                        N = i u Im((K' + F1)/u)
void balance(const Linkage& linkage, const std::vector<BodyMotion>& motion, std::vector<BodyLoad>& loads,
             MechanismForces& forces) {
  forces.dyads.resize(linkage.dyads.size());
  for (std::size_t d = linkage.dyads.size(); d-- > 0;) {
    const Dyad& dyad = linkage.dyads[d];
    const BodyLoad &coupler = loads[2 * d + 1], &closing = loads[2 * d + 2];
    const Complex e_phi = motion[2 * d + 1].e, e = motion[2 * d + 2].e;
    const Complex relative = std::conj(e) * e_phi;  // e^{i(phi - psi)}, e^{i(phi - gamma)}
    const double Y = coupler.moment / dyad.coupler.length;
    DyadForces& out = forces.dyads[d];
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      const double X = (-closing.moment / rocker->body.length - Y * relative.real()) / relative.imag();
      out.joint1 = Complex(X, Y) * e_phi;
      out.ground = closing.force + out.joint1;
    } else {
      const double X = (-dot(e, closing.force) + Y * relative.imag()) / relative.real();
      out.joint1 = Complex(X, Y) * e_phi;
      out.ground = Complex(0, 1) * e * cross(e, closing.force + out.joint1);
    }
    out.joint0 = out.joint1 - coupler.force;
    BodyLoad& carrier = loads[at(dyad.on.body)];
    carrier.force -= out.joint0;
    carrier.moment -= cross(motion[at(dyad.on.body)].e * dyad.on.point, out.joint0);
  }
  forces.crank_pivot = loads[0].force;
  forces.torque = loads[0].moment;
}

MechanismForces balance(const Linkage& linkage, const std::vector<BodyMotion>& motion,
                        const std::vector<BodyLoad>& loads) {
  std::vector<BodyLoad> remaining = loads;
  MechanismForces forces;
  balance(linkage, motion, remaining, forces);
  return forces;
}

namespace {

// int w dx and int x w dx of w = sin(i pi x/l):  (1 - (-1)^i) l/(i pi),  -(-1)^i l^2/(i pi).
Eigen::Vector2d integrals_of_mode(double l, Eigen::Index i) {
  const double i_pi = static_cast<double>(i) * std::numbers::pi;
  const bool odd = i % 2 == 1;
  return {odd ? 2 * l / i_pi : 0.0, (odd ? 1 : -1) * l * l / i_pi};
}

}  // namespace

RodMotion rod_motion(const BodyMotion& m) { return {m.phi1, m.phi2, m.e.imag(), dot(m.e, m.z1), dot(m.e, m.z2)}; }

Eigen::Vector3d deflection_load(const Body& link, double gravity, const RodMotion& motion, double speed,
                                const Eigen::Ref<const DeflectionIntegrals>& at) {
  const double mu = link.mass / link.length, Omega = speed;
  const double c_x = link.elastic->damping_x, c_y = link.elastic->damping_y;
  const double w = at(0), w_t = Omega * at(2), w_tt = Omega * Omega * at(4);
  const double xw = at(1), xw_t = Omega * at(3), xw_tt = Omega * Omega * at(5);
  const double phi_t = Omega * motion.phi1, phi_tt = Omega * Omega * motion.phi2;

  const double along = mu * (-2 * phi_t * w_t - phi_tt * w) - c_x * phi_t * w;
  const double across = mu * (w_tt - phi_t * phi_t * w) + c_y * w_t;
  // int x p_y dx - int w p_x dx with the rigid axial density p_x = mu (g sin phi + a0x - phi_t^2 x) + c_x v0x; the
  // rotary inertia of w integrates to rho J [w_tt]_0^l = 0.
  const double a0x = Omega * Omega * motion.along2, v0x = Omega * motion.along1;
  const double p_x0 = mu * (gravity * motion.sine + a0x) + c_x * v0x;
  const double moment = mu * (xw_tt - phi_t * phi_t * xw) + c_y * xw_t - (p_x0 * w - mu * phi_t * phi_t * xw);
  return {along, across, moment};
}

BodyLoad elastic_load(const Linkage& linkage, const std::vector<BodyMotion>& motion, int link, double speed,
                      const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& q1,
                      const Eigen::Ref<const Eigen::VectorXd>& q2) {
  const double l = body_at(linkage, link)->length;
  DeflectionIntegrals sum = DeflectionIntegrals::Zero();
  for (Eigen::Index i = 1; i <= q.size(); ++i) {
    const Eigen::Vector2d of_mode = integrals_of_mode(l, i);
    sum.segment<2>(0) += of_mode * q(i - 1);
    sum.segment<2>(2) += of_mode * q1(i - 1);
    sum.segment<2>(4) += of_mode * q2(i - 1);
  }
  const BodyMotion& m = motion[static_cast<std::size_t>(link)];
  const Eigen::Vector3d load = deflection_load(*body_at(linkage, link), linkage.gravity, rod_motion(m), speed, sum);
  return {m.e * Complex(load(0), load(1)), load(2)};
}

Eigen::MatrixXd deflection_samples(const Linkage& linkage, const LinkResponse& response, Eigen::Index num_samples) {
  const double l = body_at(linkage, response.link)->length;
  const FourierSeries& q = response.q;
  Eigen::Matrix2Xd of_modes(2, q.num_components());
  for (Eigen::Index i = 1; i <= q.num_components(); ++i) of_modes.col(i - 1) = integrals_of_mode(l, i);
  const Eigen::Matrix2Xcd sums = of_modes * q.c;
  FourierSeries integrals(6, q.num_harmonics());
  for (Eigen::Index k = 0; k <= q.num_harmonics(); ++k) {
    const double n = static_cast<double>(k);
    integrals.c.col(k) << sums.col(k), Complex(0, n) * sums.col(k), -n * n * sums.col(k);
  }
  return fourier::synthesise(integrals, num_samples);
}

Eigen::MatrixXd slider_force_samples(const Linkage& linkage, Eigen::Index num_samples) {
  Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(linkage.dyads.size()), num_samples);
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d)
    if (const FourierSeries* force = slider_force(linkage.dyads[d]))
      samples.row(static_cast<Eigen::Index>(d)) = fourier::synthesise(*force, num_samples);
  return samples;
}

Eigen::Index slider_force_harmonics(const Linkage& linkage) {
  Eigen::Index H = 0;
  for (const Dyad& dyad : linkage.dyads)
    if (const FourierSeries* force = slider_force(dyad)) H = std::max(H, force->num_harmonics());
  return H;
}

}  // namespace hb
