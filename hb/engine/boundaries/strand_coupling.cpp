#include "hb/engine/boundaries/strand_coupling.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

// What an exponent that is known modulo 1 may be, having come from a mean one: the nearest to that, and all as near as
// modulation may shift it.
struct Unfolded {
  double first;
  int count;
};
Unfolded unfolded(const Strand& strand, const MeanExponent& mean) {
  const double s = strand.s.imag(), f = frequency(mean), nearest = s + std::round(f - s), shift = most_shift(mean);
  const double below = std::max(0.0, std::floor(nearest - f + shift)),
               above = std::max(0.0, std::floor(f - nearest + shift));
  return {nearest - below, static_cast<int>(below + above) + 1};
}

// Whether at(k) holds for an order k of the resonance between two strands that have come from the mean exponents n, r.
template <class At>
bool any_order(const Strand& s, const MeanExponent& n, const Strand& t, const MeanExponent& r, const At& at) {
  const Unfolded from = unfolded(s, n), to = unfolded(t, r);
  const int first = static_cast<int>(std::round(to.first - from.first)) - (from.count - 1);
  for (int k = first; k < first + from.count + to.count - 1; ++k)
    if (at(k)) return true;
  return false;
}

}  // namespace

double highest_together(const Strands& strands, std::size_t a, std::size_t b, double most) {
  return std::max(strands.all[a].s.real(), strands.all[b].s.real()) + 0.5 * most;
}

bool grow_together(double sum_p, double sum_q) { return std::min(sum_p, sum_q) > std::abs(sum_p - sum_q); }

const ParametricCoupling* StrandCoupling::of(const Place& p) const {
  if (!p.coupling) {
    const std::optional<ScaledSystem> system = at_(p.x());
    if (!system) return nullptr;
    p.coupling = std::make_shared<ParametricCoupling>(*system, options_.max_order);
  }
  return p.coupling.get();
}

// Two exponents that meet grow if their coupling exceeds the root of the product of their decays.
double StrandCoupling::needed(double growth, double other) const {
  return std::max(std::sqrt(std::max(-growth, 0.0) * std::max(-other, 0.0)), options_.least_growth);
}

// How far two strands of p that may excite each other (or one quench the other) move against each other on the way to q
// at most, twice as far as their mean exponents, by the stronger coupling of both places; negative: they do not.
double StrandCoupling::motion_towards(const Place& p, const Place& q, std::size_t a, std::size_t b, double needed,
                                      Effect effect) const {
  const Strand &s = p.strands().all[a], &t = p.strands().all[b];
  const bool comparable = p.mean().size() == q.mean().size();
  double motion = s.mean.empty() || t.mean.empty() ? HUGE_VAL : -1;
  for (const std::size_t n : s.mean) {
    for (const std::size_t r : t.mean) {
      const double in = p.mean()[n].value.imag(), ir = p.mean()[r].value.imag();
      const double moved =
          !comparable ? HUGE_VAL
                      : 2 * (std::abs(q.mean()[n].value.imag() - in) + std::abs(q.mean()[r].value.imag() - ir));
      const auto weaker = [&](const Place& place) {
        return std::min(place.mean()[n].coupling, place.mean()[r].coupling);
      };
      if (n == r || moved <= motion || std::max(weaker(p), comparable ? weaker(q) : 0) < needed) continue;
      const ParametricCoupling *of_p = of(p), *of_q = comparable ? of(q) : of_p;
      if (of_p == nullptr || of_q == nullptr) return HUGE_VAL;
      const auto coupled = [&](std::size_t from_n, std::size_t to_r, int order) {
        const auto of = [&](const ParametricCoupling& c) {
          return effect == Effect::quenches ? c.either_way(from_n, to_r, order) : c(from_n, to_r, order);
        };
        return std::max(of(*of_p), of(*of_q));
      };
      const bool acts = any_order(s, p.mean()[n], t, p.mean()[r], [&](int k) {
        return k == 0 ? !(of_p->symmetric() && in * ir > 0)
                      : !((k > 0 ? coupled(n, r, k) : coupled(r, n, -k)) < needed);
      });
      if (acts) motion = moved;
    }
  }
  return motion;
}

// Upper estimate of the coupling of two strands of p; infinite if they cannot be named.
double StrandCoupling::largest(const Place& p, std::size_t a, std::size_t b, Effect effect) const {
  const Strand &s = p.strands().all[a], &t = p.strands().all[b];
  const ParametricCoupling* strength = of(p);
  if (strength == nullptr || s.mean.empty() || t.mean.empty()) return HUGE_VAL;
  const auto coupled = [&](std::size_t from_n, std::size_t to_r, int order) {
    return effect == Effect::quenches ? strength->either_way(from_n, to_r, order) : (*strength)(from_n, to_r, order);
  };
  double largest = 0;
  for (const std::size_t n : s.mean) {
    for (const std::size_t r : t.mean) {
      if (n == r) continue;
      const double in = p.mean()[n].value.imag(), ir = p.mean()[r].value.imag();
      (void)any_order(s, p.mean()[n], t, p.mean()[r], [&](int k) {
        if (k == 0)
          largest = strength->symmetric() && in * ir > 0 ? largest : HUGE_VAL;
        else
          largest = std::max(largest, k > 0 ? coupled(n, r, k) : coupled(r, n, -k));
        return std::isinf(largest);
      });
    }
  }
  return largest;
}

// Strand a grows like g by itself, b decays like d: where their mean decays a falls to zero if kappa^2 >= g d (B9).
bool StrandCoupling::quenched(const Place& p, const Place& q, std::size_t a, std::size_t b) const {
  const double g = p.strands().all[a].s.real(), d = -growth_by_itself(p.strands(), b);
  if (!(d > 0)) return false;
  const std::vector<std::size_t>& at_q = onward(p, q);
  if (at_q[a] != no_strand && at_q[b] != no_strand &&
      grow_together(g - d, q.strands().all[at_q[a]].s.real() + q.strands().all[at_q[b]].s.real()))
    return false;
  return motion_towards(p, q, a, b, std::sqrt(g * d), Effect::quenches) >= 0;
}

// kappa^2 >= g max(d, g/4), hb/engine/README.md (B21).
bool StrandCoupling::ended(const Place& p, const Place& q, std::size_t a, std::size_t c, double g) const {
  const double d = std::max(0.0, -growth_by_itself(p.strands(), c));
  const auto with_partner = [](const Strands& at, std::size_t k) {
    return (at.all[k].partner == no_strand ? 1 : 2) * growth_by_itself(at, k);
  };
  const auto all_grow = [&](const Strands& at, std::size_t i, std::size_t j) {
    return with_partner(at, i) + with_partner(at, j);
  };
  const std::vector<std::size_t>& at_q = onward(p, q);
  if (at_q[a] != no_strand && at_q[c] != no_strand &&
      grow_together(all_grow(p.strands(), a, c), all_grow(q.strands(), at_q[a], at_q[c])))
    return false;
  return motion_towards(p, q, a, c, std::sqrt(g * std::max(d, 0.25 * g)), Effect::quenches) >= 0;
}

}  // namespace hb
