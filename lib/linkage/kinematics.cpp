#include "lib/linkage/kinematics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"

namespace hb {

namespace {

using Complex = std::complex<double>;

// Position, first and second derivative of a dyad's driving joint.
struct Joint {
  Complex D, D1, D2;
};

Joint driving_joint(const Dyad& dyad, const std::vector<BodyMotion>& motion) {
  const BodyMotion& body = motion[static_cast<std::size_t>(dyad.on.body)];
  return {body.position(dyad.on.point), body.velocity(dyad.on.point), body.acceleration(dyad.on.point)};
}

// Coupler (length l) from D, rocker (length L) from the pivot P:  D + l e^{i phi} = P + L e^{i psi}.
// With d = D - P, r = |d| and the triangle's angle beta at the pivot, psi = arg d + branch beta,
//     1 - cos beta = (l - (r-L))(l + (r-L)) / 2rL,   1 + cos beta = (r+L-l)(r+L+l) / 2rL.
// One derivative:   D' + i l phi' e^{i phi} = i L psi' e^{i psi}, so, with Delta = sin(phi - psi),
//     phi' = Re(D' e^{-i psi}) / (l Delta),   psi' = Re(D' e^{-i phi}) / (L Delta);
// the second has the same form with D'' - l phi'^2 e^{i phi} + L psi'^2 e^{i psi} in place of D'.
void close_rocker(const Joint& joint, const Dyad& dyad, const Rocker& rocker, BodyMotion& coupler_motion,
                  BodyMotion& rocker_motion) {
  const double l = dyad.coupler.length, L = rocker.body.length;
  const Complex d = joint.D - rocker.pivot;
  const double r = std::sqrt(std::norm(d));
  const double one_minus = (l - (r - L)) * (l + (r - L)) / (2 * r * L);
  const double one_plus = (r + L - l) * (r + L + l) / (2 * r * L);
  const double cos_beta = one_minus < one_plus ? 1 - one_minus : one_plus - 1;
  const double sin_beta = std::sqrt(one_minus * one_plus);
  Complex e_psi = (d / r) * Complex(cos_beta, dyad.branch * sin_beta);
  e_psi /= std::sqrt(std::norm(e_psi));
  Complex e_phi = L * e_psi - d;
  e_phi /= std::sqrt(std::norm(e_phi));

  const double Delta = (std::conj(e_psi) * e_phi).imag();
  const auto angular = [&](Complex v) {
    return std::pair{(v * std::conj(e_psi)).real() / (l * Delta), (v * std::conj(e_phi)).real() / (L * Delta)};
  };
  const auto [phi1, psi1] = angular(joint.D1);
  const auto [phi2, psi2] = angular(joint.D2 - l * phi1 * phi1 * e_phi + L * psi1 * psi1 * e_psi);
  coupler_motion = {joint.D, joint.D1, joint.D2, e_phi, phi1, phi2};
  rocker_motion = {rocker.pivot, 0, 0, e_psi, psi1, psi2};
}

// Coupler from D to a point s of the guide G + s u, u = e^{i gamma}:  D + l e^{i phi} = G + s u.
// With conj(u)(D - G) = foot + i h:   s = foot + branch sqrt(l^2 - h^2),   e^{i phi} = u (s - foot - i h) / l.
// One derivative:   D' + i l phi' e^{i phi} = s' u, so, with e^{i phi}/u = c + i n,
//     phi' = -Im(D'/u) / (l c),   s' = Re(D'/u) - l phi' n;
// the second has the same form with D'' - l phi'^2 e^{i phi} in place of D'.
void close_slider(const Joint& joint, const Dyad& dyad, const Slider& slider, BodyMotion& coupler_motion,
                  BodyMotion& slider_motion) {
  const double l = dyad.coupler.length;
  const Complex u = std::polar(1.0, slider.direction);
  const Complex foot_h = std::conj(u) * (joint.D - slider.guide);
  const double h = foot_h.imag();
  const double reach = dyad.branch * std::sqrt((l - h) * (l + h));
  const double s = foot_h.real() + reach;
  const Complex direction(reach / l, -h / l);
  const Complex e_phi = u * direction;

  const auto rates = [&](Complex v) {
    const Complex along = v * std::conj(u);
    const double angular = -along.imag() / (l * direction.real());
    return std::pair{angular, along.real() - l * angular * direction.imag()};
  };
  const auto [phi1, s1] = rates(joint.D1);
  const auto [phi2, s2] = rates(joint.D2 - l * phi1 * phi1 * e_phi);
  coupler_motion = {joint.D, joint.D1, joint.D2, e_phi, phi1, phi2};
  slider_motion = {slider.guide + s * u, s1 * u, s2 * u, u, 0, 0};
}

// Crank and the first num_dyads dyads.
void motion_of_first(const Linkage& linkage, double crank_angle, std::size_t num_dyads,
                     std::vector<BodyMotion>& motion) {
  motion.resize(static_cast<std::size_t>(linkage.num_bodies()));
  motion[0] = {linkage.crank.pivot, 0, 0, std::polar(1.0, crank_angle), 1, 0};
  for (std::size_t d = 0; d < num_dyads; ++d) {
    const Dyad& dyad = linkage.dyads[d];
    const Joint joint = driving_joint(dyad, motion);
    BodyMotion &coupler = motion[2 * d + 1], &closing = motion[2 * d + 2];
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing))
      close_rocker(joint, dyad, *rocker, coupler, closing);
    else
      close_slider(joint, dyad, std::get<Slider>(dyad.closing), coupler, closing);
  }
}

}  // namespace

void motion_at(const Linkage& linkage, double crank_angle, std::vector<BodyMotion>& motion) {
  motion_of_first(linkage, crank_angle, linkage.dyads.size(), motion);
}

std::vector<BodyMotion> motion_at(const Linkage& linkage, double crank_angle) {
  std::vector<BodyMotion> motion;
  motion_at(linkage, crank_angle, motion);
  return motion;
}

// --- the closing margin over the turn ---

namespace {

// sin^2 of the transmission angle and its derivative over the crank angle; negative where the dyad does not close.
// Smooth as far as the earlier dyads' motion is, beyond closing too.
struct Margin {
  double tau = 0, g = 0, g1 = 0;
};

class ClosingMargin {
 public:
  ClosingMargin(const Linkage& linkage, std::size_t dyad) : linkage_(linkage), dyad_(dyad) {}

  Joint joint(double tau) {
    motion_of_first(linkage_, tau, dyad_, motion_);
    return driving_joint(linkage_.dyads[dyad_], motion_);
  }

  // Rocker: cos mu = (l^2 + L^2 - r^2) / 2lL between coupler and rocker. Slider: cos mu = h/l to the guide.
  Margin operator()(double tau) {
    const Dyad& dyad = linkage_.dyads[dyad_];
    const double l = dyad.coupler.length;
    const Joint at = joint(tau);
    if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
      const double L = rocker->body.length;
      const Complex d = at.D - rocker->pivot;
      const double r = std::sqrt(std::norm(d));
      const double one_minus = (r - (L - l)) * (r + (L - l)) / (2 * l * L);
      const double one_plus = (L + l - r) * (L + l + r) / (2 * l * L);
      const double cos_mu = (one_plus - one_minus) / 2;
      return {tau, one_minus * one_plus, 2 * cos_mu * (std::conj(d) * at.D1).real() / (l * L)};
    }
    const Slider& slider = std::get<Slider>(dyad.closing);
    const Complex u = std::polar(1.0, slider.direction);
    const double h = (std::conj(u) * (at.D - slider.guide)).imag();
    return {tau, (1 - h / l) * (1 + h / l), -2 * (h / l) * (std::conj(u) * at.D1).imag() / l};
  }

 private:
  const Linkage& linkage_;
  std::size_t dyad_;
  std::vector<BodyMotion> motion_;
};

bool lower(const Margin& a, const Margin& b) { return !(a.g >= b.g); }  // NaN counts as lowest

// The minimum between a and b, where the derivative changes sign.
Margin minimum_between(ClosingMargin& margin, Margin a, Margin b) {
  Margin best = lower(a, b) ? a : b;
  while (b.tau - a.tau > 1e-15 * (1 + b.tau)) {
    // Secant of the derivative, kept off the ends; a bisection where it would crawl.
    const double width = b.tau - a.tau;
    double share = a.g1 / (a.g1 - b.g1);
    if (!(share > 0.01 && share < 0.99)) share = 0.5;
    const Margin m = margin(a.tau + share * width);
    if (lower(m, best)) best = m;
    if (!std::isfinite(m.g) || m.g1 == 0) return best;
    (m.g1 < 0 ? a : b) = m;
    if (b.tau - a.tau > 0.6 * width) {
      const Margin half = margin((a.tau + b.tau) / 2);
      if (lower(half, best)) best = half;
      (half.g1 < 0 ? a : b) = half;
    }
  }
  return best;
}

// Lowest margin between a and b: halved until the Hermite cubic through the ends foretells the middle to a small part
// of the margin itself, so that no dip to zero hides between samples; then minima by the sign of g'.
Margin lowest_between(ClosingMargin& margin, const Margin& a, const Margin& b, int depth) {
  const double width = b.tau - a.tau;
  const Margin m = margin(a.tau + width / 2);
  const double foretold = (a.g + b.g) / 2 + width / 8 * (a.g1 - b.g1);
  Margin best = std::min({a, m, b}, lower);
  if (!std::isfinite(best.g)) return best;
  if (depth > 0 && !(std::abs(m.g - foretold) <= 0.02 * std::abs(best.g)))
    return std::min(lowest_between(margin, a, m, depth - 1), lowest_between(margin, m, b, depth - 1), lower);
  if (a.g1 < 0 && m.g1 > 0) best = std::min(best, minimum_between(margin, a, m), lower);
  if (m.g1 < 0 && b.g1 > 0) best = std::min(best, minimum_between(margin, m, b), lower);
  return best;
}

Margin lowest_over_turn(ClosingMargin& margin) {
  constexpr int panels = 48, depth = 14;  // down to 1e-5 rad where the margin nears zero
  Margin left = margin(0), best = left;
  for (int j = 1; j <= panels; ++j) {
    const Margin right = margin(2 * pi * j / panels);
    best = std::min(best, lowest_between(margin, left, right, depth), lower);
    left = right;
  }
  return best;
}

// Where the margin, negative at tau, rises through zero in the direction given; nullopt if it never does.
std::optional<double> edge(ClosingMargin& margin, double tau, double direction) {
  constexpr int steps = 720;
  double inside = tau, outside = tau;
  for (int j = 1; j <= steps; ++j) {
    outside = tau + direction * 2 * pi * j / steps;
    if (margin(outside).g > 0) break;
    if (j == steps) return std::nullopt;
    inside = outside;
  }
  for (int j = 0; j < 60; ++j) {
    const double middle = (inside + outside) / 2;
    (margin(middle).g > 0 ? outside : inside) = middle;
  }
  return inside;
}

double degrees(double tau) {
  const double turn = std::fmod(tau, 2 * pi);
  return (turn < 0 ? turn + 2 * pi : turn) * 180 / pi;
}

std::string where_open(ClosingMargin& margin, double tau) {
  const auto from = edge(margin, tau, -1), to = edge(margin, tau, +1);
  if (!from || !to) return "at any crank angle";
  return fmt::format("at crank angle {:.6g} deg (open from {:.6g} to {:.6g} deg)", degrees(tau), degrees(*from),
                     degrees(*to));
}

std::string what_happens(const Dyad& dyad, const Joint& joint, bool dead_centre) {
  const double l = dyad.coupler.length;
  if (const auto* rocker = std::get_if<Rocker>(&dyad.closing)) {
    const double L = rocker->body.length, r = std::abs(joint.D - rocker->pivot);
    if (dead_centre) return fmt::format("{} and {} stand in line", dyad.coupler.name, rocker->body.name);
    return r > (l + L) / 2 + std::abs(L - l) / 2
               ? fmt::format(
                     "the distance {:.6g} from its driving joint to the pivot exceeds {:.6g}, the sum of the "
                     "lengths, in the scene's unit of length",
                     r, l + L)
               : fmt::format(
                     "the distance {:.6g} from its driving joint to the pivot is below {:.6g}, the difference "
                     "of the lengths, in the scene's unit of length",
                     r, std::abs(L - l));
  }
  const Slider& slider = std::get<Slider>(dyad.closing);
  if (dead_centre) return fmt::format("{} stands at right angles to the guide of {}", dyad.coupler.name, slider.name);
  const double h = (std::polar(1.0, -slider.direction) * (joint.D - slider.guide)).imag();
  return fmt::format(
      "the distance {:.6g} from its driving joint to the guide exceeds {:.6g}, the coupler's length, in the "
      "scene's unit of length",
      std::abs(h), l);
}

}  // namespace

std::optional<Obstruction> find_obstruction(const Linkage& linkage) {
  constexpr double smallest_sine = 1e-6;
  for (std::size_t d = 0; d < linkage.dyads.size(); ++d) {
    ClosingMargin margin(linkage, d);
    const Margin lowest = lowest_over_turn(margin);
    if (lowest.g >= smallest_sine * smallest_sine) continue;
    const Dyad& dyad = linkage.dyads[d];
    Obstruction found;
    found.dyad = static_cast<int>(d);
    found.crank_angle = degrees(lowest.tau) * pi / 180;
    // Rounding of the margin is 1e-16: closer to zero than that, closing and not closing cannot be told apart.
    found.dead_centre = std::abs(lowest.g) <= smallest_sine * smallest_sine;
    const std::string place = found.dead_centre ? fmt::format("at crank angle {:.6g} deg", degrees(lowest.tau))
                                                : where_open(margin, lowest.tau);
    found.message =
        fmt::format("the dyad ({}, {}) {} {}: {}", dyad.coupler.name, body_name(linkage, closing_index(found.dyad)),
                    found.dead_centre ? "is in a dead centre" : "does not close", place,
                    what_happens(dyad, margin.joint(lowest.tau), found.dead_centre));
    return found;
  }
  return std::nullopt;
}

}  // namespace hb
