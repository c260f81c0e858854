#include "hb/engine/boundaries/locks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace hb {

namespace {

// What a strand is locked to, or nearly so: with unlike damping two go on exciting each other some way apart.
std::size_t companion(const Strands& strands, std::size_t a) {
  constexpr double farthest = 0.05;
  if (strands.all[a].partner != no_strand) return strands.all[a].partner;
  std::size_t nearest = no_strand;
  double least = farthest;
  for (std::size_t k = 0; k < strands.all.size(); ++k) {
    if (k == a) continue;
    if (const double distance = apart(strands, a, k); distance < least) {
      least = distance;
      nearest = k;
    }
  }
  return nearest;
}

bool locked(const Place& p, std::size_t k) { return p.strands().all[k].partner != no_strand; }

// Modulation may make it grow off any resonance.
bool may_drift(const Place& p, std::size_t k) {
  return std::ranges::any_of(p.strands().all[k].mean, [&](std::size_t n) { return p.mean()[n].drift > 0; });
}

// Without what it is locked to.
double decay(const Place& p, std::size_t k) { return std::max(0.0, -growth_by_itself(p.strands(), k)); }

// Strand a is locked to one that comes, as itself, from one mean exponent and its conjugate, which no other's decay or
// frequency is taken for.
std::optional<std::array<std::size_t, 2>> own_lock(const Place& p, std::size_t a_strand) {
  const Strand& locked = p.strands().all[a_strand];
  if (locked.partner == no_strand || locked.mean.size() != 2) return std::nullopt;
  std::array<std::size_t, 2> names = {locked.mean[0], locked.mean[1]};
  std::ranges::sort(names);
  const Strand& partner = p.strands().all[locked.partner];
  if (!are_conjugate(p.mean()[names[0]].value, p.mean()[names[1]].value) ||
      !std::ranges::is_permutation(partner.mean, names))
    return std::nullopt;
  return names;
}

// Multiplier +1, -1 or complex, of a locked pair.
BoundaryKind kind_of(const Strand& strand) {
  constexpr double slack = 1e-7;
  const double turn = std::abs(strand.s.imag());
  return turn <= slack ? BoundaryKind::plus_one : turn >= 0.5 - slack ? BoundaryKind::minus_one : BoundaryKind::complex;
}

// Strand c beside strand k, which grows, on the way from p to q.
struct Passing {
  double here, there;  // how far apart they are at either end, along the axis
  double growth;  // of k where c is nearest, Q being linear in between; the less as that is known to a part of the way
};
Passing passing(const Place& p, std::size_t k, std::size_t c, const Place& q) {
  constexpr double part = 0.2;
  const std::vector<std::size_t>& at_q = onward(p, q);
  const double g = p.strands().all[k].s.real(), here = apart(p.strands(), k, c);
  if (at_q[k] == no_strand || at_q[c] == no_strand) return {here, 0, g};
  const double h = std::max(0.0, q.strands().all[at_q[k]].s.real()), there = apart(q.strands(), at_q[k], at_q[c]);
  const double nearest = here + there > 0 ? here / (here + there) : 0.5;
  const double beside = std::clamp(nearest + (g < h ? -part : part), 0.0, 1.0);
  return {here, there, std::sqrt(std::lerp(g * g, h * h, beside))};
}

}  // namespace

// One that ends a growth of g is coupled by g/2 or more, so that what it changes of Q is as wide in delta: it shows at
// p or q if it moves by less, which `motions` count three times. The slower one of another lock is farther off than the
// faster one.
bool Locks::undisturbed(const Place& p, std::size_t k, const Place& q) const {
  const std::vector<double> motion = motions(p, q);
  const std::vector<Strand>& all = p.strands().all;
  for (std::size_t c = 0; c < motion.size(); ++c) {
    if (c == k || c == all[k].partner || (locked(p, c) && all[c].partner < c)) continue;
    const Passing by = passing(p, k, c, q);
    const double most = motion[k] + motion[c];
    if (by.here + by.there <= most && most > 1.5 * by.growth && coupling_.ended(p, q, k, c, by.growth)) return false;
  }
  return true;
}

// The pair of strand k of p and that of strand l of q are the same: of one kind, and no others that could take its
// place with half of what both grow are about to lock or have just unlocked beside it.
bool Locks::same(const Place& p, std::size_t k, const Place& q, std::size_t l) const {
  const std::vector<Strand>& all = p.strands().all;
  const Strand& other = q.strands().all[l];
  const BoundaryKind kind = kind_of(all[k]);
  if (kind != kind_of(other)) return false;
  // At +1 and -1 an exponent locks to its conjugate: one that decays faster than these grow does not take its place.
  const auto names = own_lock(p, k);
  const bool own = kind != BoundaryKind::complex && names && names == own_lock(q, l);
  const double highest = std::max(all[k].s.real(), other.s.real());
  const std::vector<double> motion = motions(p, q);
  const std::size_t b = companion(p.strands(), k);
  if (kind == BoundaryKind::complex && std::abs(std::abs(all[k].s.imag()) - std::abs(other.s.imag())) > motion[k])
    return false;
  const auto belongs = [&](std::size_t c, std::size_t to) {
    return c == to || std::abs(folded(all[c].s - std::conj(all[to].s))) <= 1e-7 + 2 * (all[c].error + all[to].error);
  };
  const double g = 0.5 * std::min(all[k].s.real(), other.s.real());
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (belongs(c, k) || belongs(c, b) || locked(p, c) || apart(p.strands(), k, c) > motion[k] + motion[c]) continue;
    for (std::size_t d = 0; d < all.size(); ++d) {
      if (d == c || apart(p.strands(), c, d) > motion[c] + motion[d]) continue;
      if (own && decay(p, c) > highest && (belongs(d, k) || belongs(d, b))) continue;
      if (highest_together(p.strands(), c, d, motion[c] + motion[d]) < g) continue;
      if (coupling_.exciting_motion(p, q, c, d, std::sqrt((g + decay(p, c)) * (g + decay(p, d)))) >= 0) return false;
    }
  }
  return true;
}

// Q = kappa^2 - delta^2 of the pair of strand k, delta half of what the two would be apart, cannot fall to zero:
// |dQ| <= 2 kappa |d delta|.
bool Locks::throughout(const Place& p, std::size_t k, const Place& q) const {
  const std::size_t b = p.strands().all[k].partner;
  if (b == no_strand) return false;
  const std::vector<double> motion = motions(p, q);
  const double half = 0.5 * std::abs(p.strands().all[k].s.real() - p.strands().all[b].s.real());
  const double mean = 0.5 * (p.strands().all[k].s.real() + p.strands().all[b].s.real());
  // What is left of Q has to exceed what the two decay.
  const double Q = half * half - std::min(mean, 0.0) * std::min(mean, 0.0);
  const double moved = motion[k] + motion[b];
  if (!(Q > moved * half)) return false;
  return Q > moved * std::max(half, coupling_.largest(p, k, b, StrandCoupling::Effect::excites));
}

bool Locks::leading_holds(const Place& p, const Place& q) const {
  for (const Place* place : {&p, &q}) {
    const std::size_t b = companion(place->strands(), 0);
    if (b == no_strand) return false;
    // One that grows by itself is not held by a neighbour that does not excite it, nor by one that may quench it.
    const Place& other = place == &p ? q : p;
    if (!locked(*place, 0) &&
        (may_drift(*place, 0) || coupling_.exciting_motion(*place, other, 0, b, coupling_.least_growth()) < 0 ||
         coupling_.quenched(*place, other, 0, b)))
      return false;
  }
  if (!undisturbed(p, 0, q) || !undisturbed(q, 0, p)) return false;
  if (same(p, 0, q, 0) && same(q, 0, p, 0)) return true;
  return throughout(p, 0, q) || throughout(q, 0, p);
}

// The faster strand of each lock that surely grows.
std::vector<std::size_t> Locks::growing(const Place& p) const {
  std::vector<std::size_t> growing;
  for (std::size_t k = 0; k < p.strands().all.size(); ++k) {
    const Strand& strand = p.strands().all[k];
    if (strand.partner != no_strand && strand.partner > k &&
        strand.s.real() > std::max(coupling_.least_growth(), 4 * strand.error))
      growing.push_back(k);
  }
  return growing;
}

bool Locks::hold(const Place& p, const Place& q) const {
  if (leading_holds(p, q)) return true;
  // Where two locks grow alike each may lead at one of the places: it suffices that one of them holds.
  const std::vector<std::size_t> at_p = growing(p), at_q = growing(q);
  for (const std::size_t k : at_p)
    for (const std::size_t l : at_q)
      if ((k != 0 || l != 0) && undisturbed(p, k, q) && undisturbed(q, l, p) && same(p, k, q, l) && same(q, l, p, k))
        return true;
  return false;
}

bool locked_alike(const Place& p, const Place& q) {
  return !p.strands().all.empty() && !q.strands().all.empty() && locked(p, 0) && locked(q, 0) &&
         kind_of(p.strands().all[0]) == kind_of(q.strands().all[0]);
}

}  // namespace hb
