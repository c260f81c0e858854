#include "hb/engine/boundaries/encounters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace hb {

namespace {

using cplx = std::complex<double>;

// Growth of the exponents that belong to a mean exponent, or may belong to it where decays do not tell; -infinite:
// none.
struct MeanGrowth {
  double high = -HUGE_VAL;
  double low = -HUGE_VAL;  // where several may belong to it, each without what locks it
  double least = HUGE_VAL;  // of those that grow
};

std::vector<MeanGrowth> growth_at(const Place& place) {
  std::vector<MeanGrowth> growth(place.mean.size());
  for (std::size_t k = 0; k < place.strands.all.size(); ++k) {
    const Strand& strand = place.strands.all[k];
    const double s = strand.s.real(), alone = growth_by_itself(place.strands, k);
    for (const std::size_t n : strand.mean) {
      MeanGrowth& of = growth[n];
      const bool drifts = place.mean[n].drift > 0;
      if (n != strand.mean.front() && !drifts) continue;
      of.high = std::max(of.high, s);
      of.low = !drifts ? of.high : std::isinf(of.low) ? alone : std::min(of.low, alone);
      if (s > 0) of.least = std::min(of.least, s);
    }
  }
  return growth;
}

// The larger one of both places. One that is locked to another belongs to either: while unstable those without any
// count as its partners.
std::vector<double> highest_by_mean(const Place& p, const std::vector<MeanGrowth>& at_p, const Place& q,
                                    const std::vector<MeanGrowth>& at_q) {
  std::vector<double> growth(at_p.size());
  for (std::size_t k = 0; k < growth.size(); ++k) {
    growth[k] = std::max(at_p[k].high, at_q[k].high);
    if (std::isinf(growth[k]) && !p.unstable)
      growth[k] = std::max(p.mean[k].value.real() + p.mean[k].drift, q.mean[k].value.real() + q.mean[k].drift);
  }
  return growth;
}

// Two of which one grows leave a gap only if they decay together: not if the sum of both, at two places, is larger than
// it changes.
bool grow_together(double sum_p, double sum_q) { return std::min(sum_p, sum_q) > std::abs(sum_p - sum_q); }

// Of two that may belong to several mean exponents the one that grows least is quenched soonest.
double quenching_coupling(const std::vector<MeanGrowth>& growth, std::size_t i, std::size_t j, double larger,
                          double smaller, bool drifts) {
  if (drifts) return std::min({larger, growth[i].least, growth[j].least});
  return std::sqrt(larger * std::max(larger, std::isinf(smaller) ? 0 : -smaller));
}

// Imaginary part modulo 1/2 of where two strands meet.
double meeting_point(const Strands& s, std::size_t a, std::size_t b) {
  const double m = s.all[b].s.imag() + 0.5 * folded(s.all[a].s - s.all[b].s).imag();
  return m - 0.5 * std::round(2 * m);
}

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

bool locked(const Place& p, std::size_t k) { return p.strands.all[k].partner != no_strand; }

// Modulation may make it grow off any resonance.
bool may_drift(const Place& p, std::size_t k) {
  return std::ranges::any_of(p.strands.all[k].mean, [&](std::size_t n) { return p.mean[n].drift > 0; });
}

// Without what it is locked to.
double decay(const Place& p, std::size_t k) { return std::max(0.0, -growth_by_itself(p.strands, k)); }

// Upper estimate of the growth of two strands that move by `most` against each other: the faster growth and half of
// that, since |sqrt(Q)| of (B2) changes by no more than delta does and m stays.
double highest_together(const Strands& strands, std::size_t a, std::size_t b, double most) {
  return std::max(strands.all[a].s.real(), strands.all[b].s.real()) + 0.5 * most;
}

// Strand a is locked to one that comes, as itself, from one mean exponent and its conjugate, which no other's decay or
// frequency is taken for.
std::optional<std::array<std::size_t, 2>> own_lock(const Place& p, std::size_t a_strand) {
  const Strand& locked = p.strands.all[a_strand];
  if (locked.partner == no_strand || locked.mean.size() != 2) return std::nullopt;
  std::array<std::size_t, 2> names = {locked.mean[0], locked.mean[1]};
  std::ranges::sort(names);
  const Strand& partner = p.strands.all[locked.partner];
  if (!are_conjugate(p.mean[names[0]].value, p.mean[names[1]].value) ||
      !std::ranges::is_permutation(partner.mean, names))
    return std::nullopt;
  return names;
}

// Modulation shifts an exponent off its mean one in proportion to its square, hb/engine/README.md (B10). Which one it
// has come from is not known: from any that it may be named after, from all but the nearest no farther than (B4) shifts
// it.
double grown_shift(const Place& p, const Strand& at_p, const Place& q, const Strand& at_q) {
  const std::size_t nearest = at_p.mean.front();
  const bool up = p.mean[nearest].modulation <= q.mean[nearest].modulation;
  const Place &weak = up ? p : q, &strong = up ? q : p;
  const Strand& weaker = up ? at_p : at_q;
  double grown = 0;
  const auto count = [&](std::size_t n, double most) {
    const double E_weak = weak.mean[n].modulation, E_strong = strong.mean[n].modulation;
    if (E_weak == 0) return;
    const double shift = std::abs(folded(weaker.s - weak.mean[n].value).imag()) - weaker.error;
    grown = std::max(grown, std::min(shift, most) * (std::pow(E_strong / E_weak, 2) - 1));
  };
  count(nearest, HUGE_VAL);
  for (const std::size_t n : weaker.mean) count(n, shift_by_modulation(weak.mean[n]));
  return std::min(0.5, grown);
}

// The frequency that a mean exponent stands for, and how far from it modulation may shift the exponent.
double frequency(const MeanExponent& mean) { return mean.frozen != 0 ? mean.frozen : mean.value.imag(); }
double most_shift(const MeanExponent& mean) {
  return mean.frozen != 0 ? 0 : std::min(shift_by_modulation(mean), mean.modulation);
}
double order(const MeanExponent& n, const MeanExponent& r) { return frequency(r) - frequency(n); }

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

// Multiplier +1, -1 or complex, of a locked pair.
BoundaryKind kind_of(const Strand& strand) {
  constexpr double slack = 1e-7;
  const double turn = std::abs(strand.s.imag());
  return turn <= slack ? BoundaryKind::plus_one : turn >= 0.5 - slack ? BoundaryKind::minus_one : BoundaryKind::complex;
}

}  // namespace

const std::vector<std::size_t>& onward(const Place& p, const Place& q) {
  const auto known = p.continued_at.find(q.x());
  return known != p.continued_at.end() ? known->second
                                       : p.continued_at.emplace(q.x(), continued(p.strands, q.strands)).first->second;
}

double apart(const Strands& strands, std::size_t a, std::size_t b) {
  return std::abs(folded(strands.all[a].s - strands.all[b].s).imag());
}

std::vector<double> unpredicted_motions(const Place& p, const Place& q) {
  const std::vector<std::size_t>& at_q = onward(p, q);
  std::vector<double> unpredicted(at_q.size(), 0);
  for (std::size_t k = 0; k < at_q.size(); ++k) {
    const Strand& strand = p.strands.all[k];
    if (at_q[k] == no_strand || strand.mean.empty() || p.mean.size() != q.mean.size()) continue;
    const double moved = (q.strands.all[at_q[k]].s - strand.s).imag();
    double least = HUGE_VAL;
    for (const std::size_t n : strand.mean) {
      const double apart = moved - (q.mean[n].value - p.mean[n].value).imag();
      least = std::min(least, std::abs(apart - std::round(apart)));
    }
    unpredicted[k] = std::max(least, grown_shift(p, strand, q, q.strands.all[at_q[k]]));
  }
  return unpredicted;
}

std::vector<double> motions(const Place& p, const Place& q) {
  const std::vector<std::size_t>& at_q = onward(p, q);
  std::vector<double> motion = unpredicted_motions(p, q);
  for (std::size_t k = 0; k < motion.size(); ++k) {
    motion[k] = 2 * (motion[k] + mean_motion(p.strands, q.strands, k));
    if (at_q[k] != no_strand) motion[k] += std::abs(folded(q.strands.all[at_q[k]].s - p.strands.all[k].s).imag());
  }
  return motion;
}

Place Encounters::place(const StabilitySample& sample) const {
  Place made;
  made.sample = sample;
  made.mean = sample.mean;
  if (made.mean.empty()) {
    if (const std::optional<ScaledSystem> system = at_(sample.x)) made.mean = mean_exponents(*system);
  }
  made.strands = strands_of(sample, made.mean);
  made.pair = leading_pair(sample);
  made.alone = leading_alone(sample);
  made.unstable = is_unstable(sample);
  return made;
}

const ParametricCoupling* Encounters::coupling(Place& p) const {
  if (!p.coupling) {
    const std::optional<ScaledSystem> system = at_(p.x());
    if (!system) return nullptr;
    p.coupling = std::make_shared<ParametricCoupling>(*system, options_.max_order);
  }
  return p.coupling.get();
}

// Two exponents that meet grow if their coupling exceeds the root of the product of their decays.
double Encounters::needed_coupling(double growth, double other) const {
  return std::max(std::sqrt(std::max(-growth, 0.0) * std::max(-other, 0.0)), options_.least_growth);
}

bool Encounters::resolved(Place& p, Place& q, double most) const {
  if (p.mean.size() != q.mean.size()) return true;
  const std::size_t n = p.mean.size();
  const std::vector<MeanGrowth> growth_p = growth_at(p), growth_q = growth_at(q);
  const std::vector<double> growth = highest_by_mean(p, growth_p, q, growth_q);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double at_p = p.mean[j].value.imag() - p.mean[i].value.imag();
      const double at_q = q.mean[j].value.imag() - q.mean[i].value.imag();
      if (!(std::abs(at_p - at_q) > most)) continue;
      const double larger = std::max(growth[i], growth[j]), smaller = std::min(growth[i], growth[j]);
      if (p.unstable && (larger < options_.least_growth ||
                         grow_together(growth_p[i].low + growth_p[j].low, growth_q[i].low + growth_q[j].low)))
        continue;
      const bool drifts = std::max(p.mean[i].drift, p.mean[j].drift) > 0;
      const double needed = !p.unstable ? needed_coupling(larger, smaller)
                                        : std::min(quenching_coupling(growth_p, i, j, larger, smaller, drifts),
                                                   quenching_coupling(growth_q, i, j, larger, smaller, drifts));
      if (std::max(std::min(p.mean[i].coupling, p.mean[j].coupling), std::min(q.mean[i].coupling, q.mean[j].coupling)) <
          needed)
        continue;
      const ParametricCoupling *of_p = coupling(p), *of_q = coupling(q);
      if (of_p == nullptr || of_q == nullptr) return false;
      const double shift =
          0.5 + std::max(most_shift(p.mean[i]) + most_shift(p.mean[j]), most_shift(q.mean[i]) + most_shift(q.mean[j]));
      const double low = std::min(order(p.mean[i], p.mean[j]), order(q.mean[i], q.mean[j])) - shift,
                   high = std::max(order(p.mean[i], p.mean[j]), order(q.mean[i], q.mean[j])) + shift;
      const int first = std::max(1, static_cast<int>(std::ceil(low)));
      const int last = static_cast<int>(std::floor(std::min(high, static_cast<double>(options_.max_order))));
      const auto strength = [&](const ParametricCoupling& of, int k) {
        return p.unstable ? of.either_way(i, j, k) : of(i, j, k);
      };
      for (int k = first; k <= last; ++k)
        if (!(std::max(strength(*of_p, k), strength(*of_q, k)) < needed)) return false;
    }
  }
  return true;
}

// How far two strands of p that may excite each other (or one quench the other) move against each other on the way to q
// at most, twice as far as their mean exponents, by the stronger coupling of both places; negative: they do not.
double Encounters::motion_towards(Place& p, Place& q, std::size_t a, std::size_t b, double needed,
                                  Effect effect) const {
  const Strand &s = p.strands.all[a], &t = p.strands.all[b];
  const bool comparable = p.mean.size() == q.mean.size();
  double motion = s.mean.empty() || t.mean.empty() ? HUGE_VAL : -1;
  for (const std::size_t n : s.mean) {
    for (const std::size_t r : t.mean) {
      const double in = p.mean[n].value.imag(), ir = p.mean[r].value.imag();
      const double moved =
          !comparable ? HUGE_VAL : 2 * (std::abs(q.mean[n].value.imag() - in) + std::abs(q.mean[r].value.imag() - ir));
      const auto weaker = [&](const Place& place) { return std::min(place.mean[n].coupling, place.mean[r].coupling); };
      if (n == r || moved <= motion || std::max(weaker(p), comparable ? weaker(q) : 0) < needed) continue;
      const ParametricCoupling *of_p = coupling(p), *of_q = comparable ? coupling(q) : of_p;
      if (of_p == nullptr || of_q == nullptr) return HUGE_VAL;
      const auto coupled = [&](std::size_t from_n, std::size_t to_r, int order) {
        const auto of = [&](const ParametricCoupling& c) {
          return effect == Effect::quenches ? c.either_way(from_n, to_r, order) : c(from_n, to_r, order);
        };
        return std::max(of(*of_p), of(*of_q));
      };
      const bool acts = any_order(s, p.mean[n], t, p.mean[r], [&](int k) {
        return k == 0 ? !(of_p->symmetric() && in * ir > 0)
                      : !((k > 0 ? coupled(n, r, k) : coupled(r, n, -k)) < needed);
      });
      if (acts) motion = moved;
    }
  }
  return motion;
}

namespace {

// Two that are no farther apart than this part of what they decay do not grow by being together.
constexpr double together = 0.2;

// How near two strands come at both ends of the way from p to q, where together these are no more than they move.
struct Approach {
  double here, there;  // along the axis
  double there_all;
};

std::optional<Approach> approach(const Strands& p, const Strands& q, const std::vector<double>& motion, std::size_t a,
                                 std::size_t b) {
  const double most = motion[a] + motion[b] + 1e-12, here = apart(p, a, b), point = meeting_point(p, a, b);
  if (here > most) return std::nullopt;
  double there = HUGE_VAL, there_all = HUGE_VAL;
  for (std::size_t c = 0; c < q.all.size(); ++c)
    for (std::size_t d = c + 1; d < q.all.size(); ++d) {
      const double away = meeting_point(q, c, d) - point;
      if (std::abs(away - 0.5 * std::round(2 * away)) > most || apart(q, c, d) > there) continue;
      there = apart(q, c, d);
      there_all = std::abs(folded(q.all[c].s - q.all[d].s));
    }
  if (!(here + there <= most)) return std::nullopt;
  return Approach{here, there, there_all};
}

}  // namespace

std::vector<Meeting> Encounters::meetings(Place& p, Place& q, double least) const {
  std::vector<Meeting> found;
  const Strands &sp = p.strands, &sq = q.strands;
  const std::vector<double> motion = motions(p, q);
  std::vector<double> mean_part;
  for (std::size_t k = 0; k < motion.size(); ++k) mean_part.push_back(2 * mean_motion(sp, sq, k));
  for (std::size_t a = 0; a < sp.all.size(); ++a) {
    for (std::size_t b = a + 1; b < sp.all.size(); ++b) {
      const double most = motion[a] + motion[b];
      // What they move is more than what locks them, and than the growth that this gives.
      if (apart(sp, a, b) > most + 1e-12 || highest_together(sp, a, b, most + 1e-12) < 0) continue;
      if (meeting_point(sp, a, b) < -1e-12) continue;  // the conjugate pair's
      const std::optional<Approach> near = approach(sp, sq, motion, a, b);
      if (!near) continue;
      // Two that stay together, so near that nothing grows.
      constexpr double far = 0.9;
      const double mean = 0.5 * (sp.all[a].s.real() + sp.all[b].s.real());
      if (std::max(std::abs(folded(sp.all[a].s - sp.all[b].s)), near->there_all) < -together * mean && most < far)
        continue;
      const double needed = needed_coupling(sp.all[a].s.real(), sp.all[b].s.real());
      const double exciting = exciting_motion(p, q, a, b, std::max(needed, least));
      const double sum = near->here + near->there,
                   moved = exciting + motion[a] + motion[b] - mean_part[a] - mean_part[b];
      if (exciting < 0 || sum > moved + 1e-12) continue;
      // Where they have hardly come nearer than they may have moved, nothing is known of the place.
      const double part = sum > 0.15 * moved ? near->here / sum : 0.5;
      found.push_back({a, b, p.x() + (q.x() - p.x()) * part});
    }
  }
  return found;
}

std::vector<std::vector<std::size_t>> Encounters::crowds(Place& p, const Place& q,
                                                         const std::vector<Meeting>& meetings) const {
  const std::vector<double> motion = motions(p, q);
  std::vector<std::vector<std::size_t>> found;
  for (const Meeting& m : meetings) {
    // A third one bends Q by kappa^2; one that stays with either of the two by no more than what they are apart.
    constexpr double part = 0.5;
    const double growth = growth_by_itself(p.strands, m.a), other = growth_by_itself(p.strands, m.b);
    const double needed = part * needed_coupling(growth, other);
    const auto bends = [&](std::size_t c, std::size_t one) {
      const std::optional<Approach> near = approach(p.strands, q.strands, motion, c, one);
      if (!near) return false;
      const double here = std::abs(folded(p.strands.all[c].s - p.strands.all[one].s));
      if (std::max(here, near->there_all) < -together * 0.5 * (growth + other)) return false;
      return !(largest_coupling(p, c, one, Effect::quenches) < needed);
    };
    std::vector<std::size_t> crowd;
    for (std::size_t c = 0; c < motion.size(); ++c)
      if (c == m.a || c == m.b || bends(c, m.a) || bends(c, m.b)) crowd.push_back(c);
    if (crowd.size() > 2 && std::ranges::find(found, crowd) == found.end()) found.push_back(std::move(crowd));
  }
  return found;
}

// Upper estimate of the coupling of two strands of p; infinite if they cannot be named.
double Encounters::largest_coupling(Place& p, std::size_t a, std::size_t b, Effect effect) const {
  const Strand &s = p.strands.all[a], &t = p.strands.all[b];
  const ParametricCoupling* strength = coupling(p);
  if (strength == nullptr || s.mean.empty() || t.mean.empty()) return HUGE_VAL;
  const auto coupled = [&](std::size_t from_n, std::size_t to_r, int order) {
    return effect == Effect::quenches ? strength->either_way(from_n, to_r, order) : (*strength)(from_n, to_r, order);
  };
  double largest = 0;
  for (const std::size_t n : s.mean) {
    for (const std::size_t r : t.mean) {
      if (n == r) continue;
      const double in = p.mean[n].value.imag(), ir = p.mean[r].value.imag();
      (void)any_order(s, p.mean[n], t, p.mean[r], [&](int k) {
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

// The pair of strand k of p and that of strand l of q are the same: of one kind, and no others that could take its
// place with half of what both grow are about to lock or have just unlocked beside it.
bool Encounters::same_lock(Place& p, std::size_t k, Place& q, std::size_t l) const {
  const std::vector<Strand>& all = p.strands.all;
  const Strand& other = q.strands.all[l];
  const BoundaryKind kind = kind_of(all[k]);
  if (kind != kind_of(other)) return false;
  // At +1 and -1 an exponent locks to its conjugate: one that decays faster than these grow does not take its place.
  const auto names = own_lock(p, k);
  const bool own = kind != BoundaryKind::complex && names && names == own_lock(q, l);
  const double highest = std::max(all[k].s.real(), other.s.real());
  const std::vector<double> motion = motions(p, q);
  const std::size_t b = companion(p.strands, k);
  if (kind == BoundaryKind::complex && std::abs(std::abs(all[k].s.imag()) - std::abs(other.s.imag())) > motion[k])
    return false;
  const auto belongs = [&](std::size_t c, std::size_t to) {
    return c == to || std::abs(folded(all[c].s - std::conj(all[to].s))) <= 1e-7 + 2 * (all[c].error + all[to].error);
  };
  const double g = 0.5 * std::min(all[k].s.real(), other.s.real());
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (belongs(c, k) || belongs(c, b) || locked(p, c) || apart(p.strands, k, c) > motion[k] + motion[c]) continue;
    for (std::size_t d = 0; d < all.size(); ++d) {
      if (d == c || apart(p.strands, c, d) > motion[c] + motion[d]) continue;
      if (own && decay(p, c) > highest && (belongs(d, k) || belongs(d, b))) continue;
      if (highest_together(p.strands, c, d, motion[c] + motion[d]) < g) continue;
      if (exciting_motion(p, q, c, d, std::sqrt((g + decay(p, c)) * (g + decay(p, d)))) >= 0) return false;
    }
  }
  return true;
}

// Q = kappa^2 - delta^2 of the pair of strand k, delta half of what the two would be apart, cannot fall to zero:
// |dQ| <= 2 kappa |d delta|.
bool Encounters::locked_throughout(Place& p, std::size_t k, Place& q) const {
  const std::size_t b = p.strands.all[k].partner;
  if (b == no_strand) return false;
  const std::vector<double> motion = motions(p, q);
  const double half = 0.5 * std::abs(p.strands.all[k].s.real() - p.strands.all[b].s.real());
  const double mean = 0.5 * (p.strands.all[k].s.real() + p.strands.all[b].s.real());
  // What is left of Q has to exceed what the two decay.
  const double Q = half * half - std::min(mean, 0.0) * std::min(mean, 0.0);
  const double moved = motion[k] + motion[b];
  if (!(Q > moved * half)) return false;
  return Q > moved * std::max(half, largest_coupling(p, k, b, Effect::excites));
}

bool Encounters::leading_lock_holds(Place& p, Place& q) const {
  for (Place* place : {&p, &q}) {
    const std::size_t b = companion(place->strands, 0);
    if (b == no_strand) return false;
    // One that grows by itself is not held by a neighbour that does not excite it, nor by one that may quench it.
    Place& other = place == &p ? q : p;
    if (!locked(*place, 0) &&
        (may_drift(*place, 0) || exciting_motion(*place, other, 0, b, options_.least_growth) < 0 ||
         quenched(*place, other, 0, b)))
      return false;
  }
  if (same_lock(p, 0, q, 0) && same_lock(q, 0, p, 0)) return true;
  return locked_throughout(p, 0, q) || locked_throughout(q, 0, p);
}

// The faster strand of each lock that surely grows.
std::vector<std::size_t> Encounters::growing_locks(const Place& p) const {
  std::vector<std::size_t> growing;
  for (std::size_t k = 0; k < p.strands.all.size(); ++k) {
    const Strand& strand = p.strands.all[k];
    if (strand.partner != no_strand && strand.partner > k &&
        strand.s.real() > std::max(options_.least_growth, 4 * strand.error))
      growing.push_back(k);
  }
  return growing;
}

bool Encounters::lock_holds(Place& p, Place& q) const {
  if (leading_lock_holds(p, q)) return true;
  // Where two locks grow alike each may lead at one of the places: it suffices that one of them holds.
  const std::vector<std::size_t> at_p = growing_locks(p), at_q = growing_locks(q);
  for (const std::size_t k : at_p)
    for (const std::size_t l : at_q)
      if ((k != 0 || l != 0) && same_lock(p, k, q, l) && same_lock(q, l, p, k)) return true;
  return false;
}

bool Encounters::locked_alike(const Place& p, const Place& q) {
  return !p.strands.all.empty() && !q.strands.all.empty() && locked(p, 0) && locked(q, 0) &&
         kind_of(p.strands.all[0]) == kind_of(q.strands.all[0]);
}

// Strand a grows like g by itself, b decays like d: where their mean decays a falls to zero if kappa^2 >= g d (B9).
bool Encounters::quenched(Place& p, Place& q, std::size_t a, std::size_t b) const {
  const double g = p.strands.all[a].s.real(), d = -growth_by_itself(p.strands, b);
  if (!(d > 0)) return false;
  const std::vector<std::size_t>& at_q = onward(p, q);
  if (at_q[a] != no_strand && at_q[b] != no_strand &&
      grow_together(g - d, q.strands.all[at_q[a]].s.real() + q.strands.all[at_q[b]].s.real()))
    return false;
  return motion_towards(p, q, a, b, std::sqrt(g * d), Effect::quenches) >= 0;
}

std::vector<std::size_t> Encounters::neighbours(Place& p, Place& q, std::size_t k) const {
  const std::vector<double> motion = motions(p, q);
  std::vector<std::size_t> near;
  for (std::size_t c = 0; c < p.strands.all.size(); ++c) {
    if (c == k || apart(p.strands, k, c) > motion[k] + motion[c]) continue;
    if (exciting_motion(p, q, k, c, options_.least_growth) >= 0 || quenched(p, q, k, c)) near.push_back(c);
  }
  return near;
}

}  // namespace hb
