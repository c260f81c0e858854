#include "lib/exact/bent_rod.hpp"

#include <algorithm>

#include "lib/constants.hpp"

namespace hb::exact {

using Eigen::Index;

namespace {

std::size_t place(Index k) { return static_cast<std::size_t>(k); }

}  // namespace

BentRod::BentRod(const RodQuadrature& rule, const RodConstants& rod)
    : rule_(rule),
      rod_(rod),
      q_(place(rule.num_modes())),
      points_(place(rule.num_points())),
      slopes_(points_.size()),
      u_(points_.size()),
      loads_(points_.size()),
      residual_(place(rule.num_modes())) {}

// With a = w', k = 1/cos psi = (1 - a^2)^(-1/2):
//     u' = -a^2/(1 + cos psi),   u'_t = g1 a_t,   u'_tt = g1 a_tt + g2 a_t^2,   g1 = -a k,   g2 = -k^3,
//     psi_t = k a_t,   psi_tt = k a_tt + a k^3 a_t^2.
void BentRod::bend(const Samples& q, const Samples& q1, const Samples& q2, Index first) {
  const Index I = rule_.num_modes(), last = q.cols() - 1;
  for (Index i = 0; i < I; ++i) {
    const auto at = [&](const Samples& samples) {
      return Lanes::of([&](Index lane) { return samples(i, std::min(first + lane, last)); });
    };
    q_[place(i)] = {at(q), at(q1), at(q2)};
  }
  steepest_ = 0;
  for (Index n = 0; n < rule_.num_points(); ++n) {
    Point at;
    const RodQuadrature::Shape* shape = rule_.shapes_at(n);
    const Along* own = q_.data();
    for (Index i = 0; i < I; ++i) {
      const auto [s, s1, s2] = shape[i];
      const auto [u, u1, u2] = own[i];
      at.w += s * u, at.w1 += s * u1, at.w2 += s * u2;
      at.a += s1 * u, at.a1 += s1 * u1, at.a2 += s1 * u2;
      at.b += s2 * u, at.b1 += s2 * u1;
    }
    const Lanes square = 1 - at.a * at.a, cosine = sqrt(square), inverse = 1 / square;
    at.k = cosine * inverse;
    const Lanes cube = at.k * inverse;
    at.g1 = -at.a * at.k;
    at.g2 = -cube;
    at.h1 = at.g2 * at.a1;
    at.h2 = at.g2 * at.a2 - 3 * at.a * cube * inverse * at.a1 * at.a1;
    at.psi2 = at.k * at.a2 - at.a * at.h1 * at.a1;
    slopes_[place(n)] = {-at.a * at.a / (1 + cosine), at.g1 * at.a1, at.g1 * at.a2 + at.h1 * at.a1};
    steepest_ = max(abs(at.a), steepest_);
    points_[place(n)] = at;
  }
  at_0_ = at_l_ = 0;
  for (Index i = 0; i < I; ++i) {
    const double wave = pi / rule_.length * static_cast<double>(i + 1);
    at_0_ += wave * q_[place(i)].u;
    at_l_ += (i % 2 == 0 ? -wave : wave) * q_[place(i)].u;
  }
  steepest_ = max(abs(at_0_), max(abs(at_l_), steepest_));
  integrate_shape();
}

// result_k = sum_m integral_km derivative_m, of so many columns at each point; two points k at a time.
void BentRod::integrate(const std::vector<Along>& derivative, Index columns, std::vector<Along>& result) const {
  const Index Q = rule_.num_points();
  for (Index k = 0; k < Q; k += 2) {
    const Index next = std::min(k + 1, Q - 1);
    const double *factor = &rule_.integral(k, 0), *next_factor = &rule_.integral(next, 0);
    for (Index column = 0; column < columns; ++column) {
      Along sum, next_sum;
      const Along* of = &derivative[place(column)];
      for (Index m = 0; m < Q; ++m, of += columns) {
        const Lanes a = factor[m], b = next_factor[m];
        sum.u += a * of->u, sum.u1 += a * of->u1, sum.u2 += a * of->u2;
        next_sum.u += b * of->u, next_sum.u1 += b * of->u1, next_sum.u2 += b * of->u2;
      }
      result[place(next * columns + column)] = next_sum;
      result[place(k * columns + column)] = sum;
    }
  }
}

void BentRod::integrate_shape() {
  integrate(slopes_, 1, u_);
  Chord<Lanes> chord{rule_.length, 0, 0};
  ShapeIntegrals sum;
  for (Index n = 0; n < rule_.num_points(); ++n) {
    const Lanes W = rule_.weight(n);
    const Along& slope = slopes_[place(n)];
    chord.c += W * slope.u, chord.c1 += W * slope.u1, chord.c2 += W * slope.u2;
    const Point& at = points_[place(n)];
    Along& u = u_[place(n)];
    u.u += rule_.x(n);
    const Lanes X = W * u.u, w = W * at.w;
    sum.X += X, sum.U1 += W * u.u1, sum.U2 += W * u.u2;
    sum.W += w, sum.W1 += W * at.w1, sum.W2 += W * at.w2;
    sum.XX += X * u.u, sum.WW += w * at.w;
    sum.X_U1_W_W1 += X * u.u1 + w * at.w1;
    sum.X_W1 += X * at.w1, sum.W_U1 += w * u.u1;
    sum.X_W2_W_U2 += X * at.w2 - w * u.u2;
    sum.psi2 += W * at.psi2;
  }
  chord_ = chord;
  shape_ = sum;
}

// Load per length along and across the chord:
//     f_x = mu [ a_x - phi_t^2 (x+u) - phi_tt w - 2 phi_t w_t + u_tt ] + c_x [ v_x - phi_t w + u_t ]
//     f_y = mu [ a_y + phi_tt (x+u) - phi_t^2 w + 2 phi_t u_t + w_tt ] + c_y [ v_y + phi_t (x+u) + w_t ]
void BentRod::surround(const BaseMotion<Lanes>& base, const Lanes& axial_force) {
  const double mu = rod_.mass_per_length, c_x = rod_.damping_x, c_y = rod_.damping_y;
  base_ = base;
  axial_force_ = axial_force;
  rates_ = {mu * base.phi2 + c_x * base.phi1, mu * base.phi2 + c_y * base.phi1, 2 * mu * base.phi1,
            mu * base.phi1 * base.phi1};
  const Lanes all_x = mu * base.a_x + c_x * base.v_x, all_y = mu * base.a_y + c_y * base.v_y;
  const auto [turn_x, turn_y, coriolis, centrifugal] = rates_;
  const Index Q = rule_.num_points();
  for (Index n = 0; n < Q; ++n) {
    const Point& at = points_[place(n)];
    const Along& u = u_[place(n)];
    Load f;
    const double W = rule_.weight(n);
    f.f_x = all_x + mu * u.u2 + c_x * u.u1 - u.u * centrifugal - at.w * turn_x - at.w1 * coriolis;
    f.f_y = all_y + mu * at.w2 + c_y * at.w1 + u.u * turn_y - at.w * centrifugal + u.u1 * coriolis;
    f.K_a = -at.a * at.b * at.g2;
    const Lanes kappa1 = f.K_a * at.a1 + at.k * at.b1;
    f.m = W * rod_.bending * (at.k * at.b + rod_.internal_damping * kappa1);
    f.rotary = W * rod_.rotary * (at.psi2 + base.phi2);
    loads_[place(n)] = f;
  }
  for (Index k = 0; k < Q; ++k) {
    const double* factor = &rule_.weighted_integral(0, k);
    const Load* of = loads_.data();
    Lanes sum = -axial_force * rule_.weight(k);
    for (Index m = 0; m < Q; ++m) sum += factor[m] * of[m].f_x;
    loads_[place(k)].axial = sum;
  }
}

const std::vector<Lanes>& BentRod::residual() {
  const Index I = rule_.num_modes();
  const double scale = 2 / (rod_.length * rod_.bending);
  std::fill(residual_.begin(), residual_.end(), Lanes());
  for (Index n = 0; n < rule_.num_points(); ++n) {
    const Point& at = points_[place(n)];
    const Load& f = loads_[place(n)];
    const Lanes across = scale * rule_.weight(n) * f.f_y, curvature = scale * f.m * at.k,
                slope = scale * (at.g1 * f.axial + f.rotary * at.k + f.m * f.K_a);
    const RodQuadrature::Shape* shape = rule_.shapes_at(n);
    Lanes* r = residual_.data();
    for (Index i = 0; i < I; ++i) r[i] += shape[i].s * across + shape[i].s1 * slope + shape[i].s2 * curvature;
  }
  return residual_;
}

std::vector<Lanes> BentRod::tension(const Lanes& Y) const {
  const Index Q = rule_.num_points();
  Lanes base_x = axial_force_, base_y = Y;
  for (Index n = 0; n < Q; ++n) {
    base_x -= rule_.weight(n) * loads_[place(n)].f_x;
    base_y -= rule_.weight(n) * loads_[place(n)].f_y;
  }
  std::vector<Lanes> result;
  for (Index k = 0; k < Q; ++k) {
    Lanes F_x = base_x, F_y = base_y;
    for (Index m = 0; m < Q; ++m) {
      F_x += rule_.integral(k, m) * loads_[place(m)].f_x;
      F_y += rule_.integral(k, m) * loads_[place(m)].f_y;
    }
    result.push_back(F_x / points_[place(k)].k + F_y * points_[place(k)].a);
  }
  result.push_back(base_x * sqrt(1 - at_0_ * at_0_) + base_y * at_0_);
  result.push_back(axial_force_ * sqrt(1 - at_l_ * at_l_) + Y * at_l_);
  return result;
}

}  // namespace hb::exact
