#include "hb/engine/boundaries/encounters.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hb {

namespace {

// Growth of the exponents that belong to a mean exponent, or may belong to it where decays do not tell; -infinite:
// none.
struct MeanGrowth {
  double high = -HUGE_VAL;
  double low = -HUGE_VAL;  // where several may belong to it, each without what locks it
  double least = HUGE_VAL;  // of those that grow
};

std::vector<MeanGrowth> growth_at(const Place& place) {
  std::vector<MeanGrowth> growth(place.mean().size());
  for (std::size_t k = 0; k < place.strands().all.size(); ++k) {
    const Strand& strand = place.strands().all[k];
    const double s = strand.s.real(), alone = growth_by_itself(place.strands(), k);
    for (const std::size_t n : strand.mean) {
      MeanGrowth& of = growth[n];
      const bool drifts = place.mean()[n].drift > 0;
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
      growth[k] = std::max(p.mean()[k].value.real() + p.mean()[k].drift, q.mean()[k].value.real() + q.mean()[k].drift);
  }
  return growth;
}

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

double order(const MeanExponent& n, const MeanExponent& r) { return frequency(r) - frequency(n); }

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

bool Encounters::resolved(const Place& p, const Place& q, double most) const {
  if (p.mean().size() != q.mean().size()) return true;
  const std::size_t n = p.mean().size();
  const std::vector<MeanGrowth> growth_p = growth_at(p), growth_q = growth_at(q);
  const std::vector<double> growth = highest_by_mean(p, growth_p, q, growth_q);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double at_p = p.mean()[j].value.imag() - p.mean()[i].value.imag();
      const double at_q = q.mean()[j].value.imag() - q.mean()[i].value.imag();
      if (!(std::abs(at_p - at_q) > most)) continue;
      const double larger = std::max(growth[i], growth[j]), smaller = std::min(growth[i], growth[j]);
      if (p.unstable && (larger < coupling_.least_growth() ||
                         grow_together(growth_p[i].low + growth_p[j].low, growth_q[i].low + growth_q[j].low)))
        continue;
      const bool drifts = std::max(p.mean()[i].drift, p.mean()[j].drift) > 0;
      const double needed = !p.unstable ? coupling_.needed(larger, smaller)
                                        : std::min(quenching_coupling(growth_p, i, j, larger, smaller, drifts),
                                                   quenching_coupling(growth_q, i, j, larger, smaller, drifts));
      if (std::max(std::min(p.mean()[i].coupling, p.mean()[j].coupling),
                   std::min(q.mean()[i].coupling, q.mean()[j].coupling)) < needed)
        continue;
      const ParametricCoupling *of_p = coupling_.of(p), *of_q = coupling_.of(q);
      if (of_p == nullptr || of_q == nullptr) return false;
      const double shift = 0.5 + std::max(most_shift(p.mean()[i]) + most_shift(p.mean()[j]),
                                          most_shift(q.mean()[i]) + most_shift(q.mean()[j]));
      const double low = std::min(order(p.mean()[i], p.mean()[j]), order(q.mean()[i], q.mean()[j])) - shift,
                   high = std::max(order(p.mean()[i], p.mean()[j]), order(q.mean()[i], q.mean()[j])) + shift;
      const int first = std::max(1, static_cast<int>(std::ceil(low)));
      const int last = static_cast<int>(std::floor(std::min(high, static_cast<double>(coupling_.max_order()))));
      const auto strength = [&](const ParametricCoupling& of, int k) {
        return p.unstable ? of.either_way(i, j, k) : of(i, j, k);
      };
      for (int k = first; k <= last; ++k)
        if (!(std::max(strength(*of_p, k), strength(*of_q, k)) < needed)) return false;
    }
  }
  return true;
}

std::vector<Meeting> Encounters::meetings(const Place& p, const Place& q, double least) const {
  std::vector<Meeting> found;
  const Strands &sp = p.strands(), &sq = q.strands();
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
      const double needed = coupling_.needed(sp.all[a].s.real(), sp.all[b].s.real());
      const double exciting = coupling_.exciting_motion(p, q, a, b, std::max(needed, least));
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

std::vector<std::vector<std::size_t>> Encounters::crowds(const Place& p, const Place& q,
                                                         const std::vector<Meeting>& meetings) const {
  const std::vector<double> motion = motions(p, q);
  std::vector<std::vector<std::size_t>> found;
  for (const Meeting& m : meetings) {
    // A third one bends Q by kappa^2; one that stays with either of the two by no more than what they are apart.
    constexpr double part = 0.5;
    const double growth = growth_by_itself(p.strands(), m.a), other = growth_by_itself(p.strands(), m.b);
    const double needed = part * coupling_.needed(growth, other);
    const auto bends = [&](std::size_t c, std::size_t one) {
      const std::optional<Approach> near = approach(p.strands(), q.strands(), motion, c, one);
      if (!near) return false;
      const double here = std::abs(folded(p.strands().all[c].s - p.strands().all[one].s));
      if (std::max(here, near->there_all) < -together * 0.5 * (growth + other)) return false;
      return !(coupling_.largest(p, c, one, StrandCoupling::Effect::quenches) < needed);
    };
    std::vector<std::size_t> crowd;
    for (std::size_t c = 0; c < motion.size(); ++c)
      if (c == m.a || c == m.b || bends(c, m.a) || bends(c, m.b)) crowd.push_back(c);
    if (crowd.size() > 2 && std::ranges::find(found, crowd) == found.end()) found.push_back(std::move(crowd));
  }
  return found;
}

std::vector<std::size_t> Encounters::neighbours(const Place& p, const Place& q, std::size_t k) const {
  const std::vector<double> motion = motions(p, q);
  std::vector<std::size_t> near;
  for (std::size_t c = 0; c < p.strands().all.size(); ++c) {
    if (c == k || apart(p.strands(), k, c) > motion[k] + motion[c]) continue;
    if (coupling_.exciting_motion(p, q, k, c, coupling_.least_growth()) >= 0 || coupling_.quenched(p, q, k, c))
      near.push_back(c);
  }
  return near;
}

}  // namespace hb
