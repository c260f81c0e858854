// The mechanism whose elastic links are bent: bodies moving as the closure with given chords demands, joint forces that
// balance gravity, inertia and damping of the bent shapes. Over Lanes of crank angles, or over Dual for derivatives.
// ' and _t are derivatives in time. Used inside the library.
#pragma once

#include <complex>
#include <vector>

#include "lib/exact/dual.hpp"
#include "lib/linkage/linkage.hpp"

namespace hb::exact {

// Distance of a link's joints with its rates: constant for a rigid link.
template <class T>
struct Chord {
  T c{}, c1{}, c2{};
};

// Motion of a body's frame: origin (joint 0; a slider's joint), direction e = e^{i phi} (a bent link's chord).
template <class T>
struct BentMotion {
  Plane<T> z, z1, z2, e;
  T phi1{}, phi2{};
};

// Motion of joint 0 and of the chord as a rod feels it: velocity and acceleration less gravity, a + i g, along and
// across the chord; angular velocity and acceleration.
template <class T>
struct BaseMotion {
  T v_x{}, v_y{}, a_x{}, a_y{}, phi1{}, phi2{};
};

// Sum of forces (global frame) and moment about joint 0 that a body's gravity, inertia and damping ask of its joints.
template <class T>
struct BentLoad {
  Plane<T> force;
  T moment{};
};

// Integrals over one rod of its bent shape in the frame of its chord, p = (x + u) + i w, and of its rates: all that
// the mechanism feels of it.
struct ShapeIntegrals {
  Lanes X, U1, U2;  // x + u, u_t, u_tt
  Lanes W, W1, W2;  // w, w_t, w_tt
  Lanes XX, WW;  // (x + u)^2, w^2
  Lanes X_U1_W_W1;  // (x + u) u_t + w w_t
  Lanes X_W1, W_U1;  // (x + u) w_t, w u_t
  Lanes X_W2_W_U2;  // (x + u) w_tt - w u_tt
  Lanes psi2;  // psi_tt
};

struct RodConstants {
  double length = 0, mass_per_length = 0, rotary = 0, bending = 0;  // l, mu, rho J, EJ
  double internal_damping = 0, damping_x = 0, damping_y = 0;  // alpha_c, c_x, c_y
};

[[nodiscard]] inline RodConstants constants_of(const Body& body) {
  const Elastic& elastic = *body.elastic;
  return {.length = body.length,
          .mass_per_length = body.mass / body.length,
          .rotary = elastic.density * elastic.second_moment,
          .bending = elastic.youngs_modulus * elastic.second_moment,
          .internal_damping = elastic.internal_damping,
          .damping_x = elastic.damping_x,
          .damping_y = elastic.damping_y};
}

// One elastic link in one state: what the mechanism needs to know, and what it answers.
template <class T>
struct RodState {
  Chord<T> chord;
  ShapeIntegrals shape;
  BaseMotion<T> base;  // answer
  T axial_force{};  // answer: X, on the rod at joint 1, tension positive
};

template <class T>
struct BentDyadForces {
  Plane<T> joint0, joint1, ground;  // as DyadForces
};

// All bodies at one crank angle in each lane. Scratch that is kept from one block of angles to the next.
template <class T>
struct BentMechanism {
  std::vector<RodState<T>> rods;
  std::vector<BentMotion<T>> motion;
  std::vector<BentLoad<T>> loads;
  std::vector<BentDyadForces<T>> forces;
  Plane<T> crank_pivot;
  T torque{};
};

// With p = (x + u) + i w and r_tt + i g = e [ a + (i phi_tt - phi_t^2) p + 2 i phi_t p_t + p_tt ],
//     force = e (F_x + i F_y) = int mu (r_tt + i g) + damping dx,
//     moment = int Im(conj(p) (f_x + i f_y)) dx + rho J int (phi + psi)_tt dx.
template <class T>
BentLoad<T> rod_load(const RodConstants& rod, const ShapeIntegrals& S, const BaseMotion<T>& b, const Plane<T>& e) {
  const double l = rod.length, mu = rod.mass_per_length, c_x = rod.damping_x, c_y = rod.damping_y;
  const T square = b.phi1 * b.phi1;
  const T F_x = mu * (l * b.a_x - S.X * square - S.W * b.phi2 - 2 * S.W1 * b.phi1 + S.U2) +
                c_x * (l * b.v_x - S.W * b.phi1 + S.U1);
  const T F_y = mu * (l * b.a_y + S.X * b.phi2 - S.W * square + 2 * S.U1 * b.phi1 + S.W2) +
                c_y * (l * b.v_y + S.X * b.phi1 + S.W1);
  const T moment = mu * (S.X * b.a_y - S.W * b.a_x + (S.XX + S.WW) * b.phi2 + 2 * S.X_U1_W_W1 * b.phi1 + S.X_W2_W_U2) +
                   c_y * (S.X * b.v_y + S.XX * b.phi1 + S.X_W1) - c_x * (S.W * b.v_x - S.WW * b.phi1 + S.W_U1) +
                   rod.rotary * (l * b.phi2 + S.psi2);
  return {e * Plane<T>{F_x, F_y}, moment};
}

// Closing with lengths that change. Coupler (length l) from D, rocker (length L) from the pivot P:
//     D + l e^{i phi} = P + L e^{i psi}, the triangle as in kinematics.cpp. One derivative, with Delta = sin(phi -
//     psi): V = D' + l' e^{i phi} - L' e^{i psi},   phi' = Re(V e^{-i psi})/(l Delta),   psi' = Re(V e^{-i phi})/(L
//     Delta);
// the second has the same form with
//     V = D'' + (l'' - l phi'^2 + 2 i l' phi') e^{i phi} - (L'' - L psi'^2 + 2 i L' psi') e^{i psi}.
template <class T>
void close_rocker(const BentMotion<T>& D, const Chord<T>& l, const Chord<T>& L, const Plane<T>& P, int branch,
                  BentMotion<T>& coupler, BentMotion<T>& rocker) {
  using std::sqrt;
  const Plane<T> d = D.z - P;
  const T r = sqrt(norm(d));
  const T one_minus = (l.c - (r - L.c)) * (l.c + (r - L.c)) / (2 * r * L.c);
  const T one_plus = (r + L.c - l.c) * (r + L.c + l.c) / (2 * r * L.c);
  const T cos_beta = 0.5 * (one_plus - one_minus);
  const T sin_beta = sqrt(one_minus * one_plus);
  const Plane<T> toward{d.x / r, d.y / r};
  const Plane<T> e_psi = toward * Plane<T>{cos_beta, branch > 0 ? sin_beta : -sin_beta};
  const Plane<T> end = L.c * e_psi - d;
  const Plane<T> e_phi{end.x / l.c, end.y / l.c};

  const T Delta = cross(e_psi, e_phi);
  const T per_phi = 1 / (l.c * Delta), per_psi = 1 / (L.c * Delta);
  const Plane<T> V1 = D.z1 + l.c1 * e_phi - L.c1 * e_psi;
  const T phi1 = dot(V1, e_psi) * per_phi, psi1 = dot(V1, e_phi) * per_psi;
  const Plane<T> V2 = D.z2 + Plane<T>{l.c2 - l.c * phi1 * phi1, 2 * l.c1 * phi1} * e_phi -
                      Plane<T>{L.c2 - L.c * psi1 * psi1, 2 * L.c1 * psi1} * e_psi;
  coupler = {D.z, D.z1, D.z2, e_phi, phi1, dot(V2, e_psi) * per_phi};
  rocker = {P, {}, {}, e_psi, psi1, dot(V2, e_phi) * per_psi};
}

// Coupler from D to a point s of the guide G + s u:  D + l e^{i phi} = G + s u. With e^{i phi}/u = c + i n,
//     V = D' + l' e^{i phi},   phi' = -Im(V/u)/(l c),   s' = Re(V/u) - l phi' n;
// the second derivative the same with V = D'' + (l'' - l phi'^2 + 2 i l' phi') e^{i phi}.
template <class T>
void close_slider(const BentMotion<T>& D, const Chord<T>& l, const Plane<T>& guide, const Plane<T>& u, int branch,
                  BentMotion<T>& coupler, BentMotion<T>& slider) {
  using std::sqrt;
  const Plane<T> foot_h = conj(u) * (D.z - guide);
  const T h = foot_h.y, root = sqrt((l.c - h) * (l.c + h));
  const T reach = branch > 0 ? root : -root;
  const Plane<T> direction{reach / l.c, -h / l.c};
  const Plane<T> e_phi = u * direction;
  const T s = foot_h.x + reach;
  const auto rates = [&](const Plane<T>& V) {
    const Plane<T> along = conj(u) * V;
    const T angular = -along.y / reach;
    return Plane<T>{angular, along.x + angular * h};  // l n = -h
  };
  const Plane<T> first = rates(D.z1 + l.c1 * e_phi);
  const T phi1 = first.x;
  const Plane<T> second = rates(D.z2 + Plane<T>{l.c2 - l.c * phi1 * phi1, 2 * l.c1 * phi1} * e_phi);
  coupler = {D.z, D.z1, D.z2, e_phi, phi1, second.x};
  slider = {guide + s * u, first.y * u, second.y * u, u, {}, {}};
}

template <class T>
Plane<T> plane(std::complex<double> z) {
  return {T(z.real()), T(z.imag())};
}

// Motion of a point of a body, given in the body's frame, as the frame of something that hangs there.
template <class T>
BentMotion<T> at_point(const BentMotion<T>& body, std::complex<double> point) {
  const Plane<T> arm = body.e * plane<T>(point);
  BentMotion<T> result;
  result.z = body.z + arm;
  result.z1 = body.z1 + body.phi1 * turned(arm);
  result.z2 = body.z2 + Plane<T>{-(body.phi1 * body.phi1), body.phi2} * arm;
  return result;
}

// rod_of[body]: place of the body in mechanism.rods, -1 for a rigid one.
template <class T>
Chord<T> chord_of(const BentMechanism<T>& mechanism, const std::vector<int>& rod_of, int body, double length) {
  const int rod = rod_of[static_cast<std::size_t>(body)];
  return rod >= 0 ? mechanism.rods[static_cast<std::size_t>(rod)].chord : Chord<T>{T(length), {}, {}};
}

// The bodies' motion; crank = e^{i tau}.
template <class T>
void move(const Linkage& linkage, const std::vector<int>& rod_of, const Plane<Lanes>& crank, const T& speed,
          BentMechanism<T>& mechanism) {
  std::vector<BentMotion<T>>& motion = mechanism.motion;
  motion.resize(static_cast<std::size_t>(linkage.num_bodies()));
  motion[0] = {plane<T>(linkage.crank.pivot), {}, {}, {T(crank.x), T(crank.y)}, speed, {}};
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    const Dyad& dyad = linkage.dyads[d];
    const int coupler = coupler_index(static_cast<int>(d));
    const BentMotion<T> D = at_point(motion[static_cast<std::size_t>(dyad.on.body)], dyad.on.point);
    const Chord<T> l = chord_of(mechanism, rod_of, coupler, dyad.coupler.length);
    BentMotion<T>&first = motion[2 * d + 1], &second = motion[2 * d + 2];
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing))
      close_rocker(D, l, chord_of(mechanism, rod_of, coupler + 1, rocker->body.length), plane<T>(rocker->pivot),
                   dyad.branch, first, second);
    else {
      const Slider& slider = std::get<Slider>(dyad.closing);
      close_slider(D, l, plane<T>(slider.guide), plane<T>(std::polar(1.0, slider.direction)), dyad.branch, first,
                   second);
    }
  }
}

// The load of every body; slider_forces(d) are the forces applied to the slider of dyad d.
template <class T, class SliderForces>
void load(const Linkage& linkage, const std::vector<int>& rod_of, const std::vector<RodConstants>& constants,
          const SliderForces& slider_forces, BentMechanism<T>& mechanism) {
  mechanism.loads.resize(mechanism.motion.size());
  for (std::size_t index = 0; index < mechanism.motion.size(); ++index) {
    const BentMotion<T>& m = mechanism.motion[index];
    BentLoad<T>& out = mechanism.loads[index];
    const Plane<T> gravity{T(0.0), T(linkage.gravity)};
    if (const int rod = rod_of[index]; rod >= 0) {
      RodState<T>& state = mechanism.rods[static_cast<std::size_t>(rod)];
      const Plane<T> v = conj(m.e) * m.z1, a = conj(m.e) * (m.z2 + gravity);
      state.base = {v.x, v.y, a.x, a.y, m.phi1, m.phi2};
      out = rod_load(constants[static_cast<std::size_t>(rod)], state.shape, state.base, m.e);
    } else if (const Body* body = body_at(linkage, static_cast<int>(index))) {
      const BentMotion<T> com = at_point(m, body->com);
      out.force = T(body->mass) * (com.z2 + gravity);
      out.moment = cross(com.z - m.z, out.force) + body->inertia * m.phi2;
    } else {
      const std::size_t d = (index - 1) / 2;
      const Slider& slider = std::get<Slider>(linkage.dyads[d].closing);
      const Lanes applied = slider_forces(static_cast<Eigen::Index>(d));
      out.force = T(slider.mass) * (m.z2 + gravity) - T(applied) * m.e;
      out.moment = T(0.0);
    }
  }
}

// Joint forces, dyads in reverse order, as in balance.cpp with chords for lengths: linear in the loads. Uses them up.
template <class T>
void balance(const Linkage& linkage, const std::vector<int>& rod_of, BentMechanism<T>& mechanism) {
  std::vector<BentLoad<T>>& loads = mechanism.loads;
  mechanism.forces.resize(linkage.dyads.size());
  for (std::size_t d = linkage.dyads.size(); d-- > 0;) {
    const Dyad& dyad = linkage.dyads[d];
    const int first = coupler_index(static_cast<int>(d));
    const BentLoad<T>&coupler = loads[2 * d + 1], &closing = loads[2 * d + 2];
    const Plane<T>&e_phi = mechanism.motion[2 * d + 1].e, &e = mechanism.motion[2 * d + 2].e;
    const Plane<T> relative = conj(e) * e_phi;
    const T Y = coupler.moment / chord_of(mechanism, rod_of, first, dyad.coupler.length).c;
    BentDyadForces<T>& out = mechanism.forces[d];
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      const T L = chord_of(mechanism, rod_of, first + 1, rocker->body.length).c;
      const T X = (-(closing.moment / L) - Y * relative.x) / relative.y;
      out.joint1 = Plane<T>{X, Y} * e_phi;
      out.ground = closing.force + out.joint1;
    } else {
      const T X = (Y * relative.y - dot(e, closing.force)) / relative.x;
      out.joint1 = Plane<T>{X, Y} * e_phi;
      out.ground = cross(e, closing.force + out.joint1) * turned(e);
    }
    out.joint0 = out.joint1 - coupler.force;
    const auto carrier = static_cast<std::size_t>(dyad.on.body);
    loads[carrier].force = loads[carrier].force - out.joint0;
    const Plane<T> arm = mechanism.motion[carrier].e * plane<T>(dyad.on.point);
    loads[carrier].moment = loads[carrier].moment - cross(arm, out.joint0);
    for (const int body : {first, first + 1})
      if (const int rod = rod_of[static_cast<std::size_t>(body)]; rod >= 0) {
        const T along = dot(mechanism.motion[static_cast<std::size_t>(body)].e, out.joint1);
        mechanism.rods[static_cast<std::size_t>(rod)].axial_force = body == first ? along : -along;
      }
  }
  mechanism.crank_pivot = loads[0].force;
  mechanism.torque = loads[0].moment;
}

}  // namespace hb::exact
