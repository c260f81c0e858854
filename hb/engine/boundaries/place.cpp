#include "hb/engine/boundaries/place.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

// Modulation shifts an exponent off its mean one in proportion to its square, hb/engine/README.md (B10). Which one it
// has come from is not known: from any that it may be named after, from all but the nearest no farther than (B4) shifts
// it.
double grown_shift(const Place& p, const Strand& at_p, const Place& q, const Strand& at_q) {
  const std::size_t nearest = at_p.mean.front();
  const bool up = p.mean()[nearest].modulation <= q.mean()[nearest].modulation;
  const Place &weak = up ? p : q, &strong = up ? q : p;
  const Strand& weaker = up ? at_p : at_q;
  double grown = 0;
  const auto count = [&](std::size_t n, double most) {
    const double E_weak = weak.mean()[n].modulation, E_strong = strong.mean()[n].modulation;
    if (E_weak == 0) return;
    const double shift = std::abs(folded(weaker.s - weak.mean()[n].value).imag()) - weaker.error;
    grown = std::max(grown, std::min(shift, most) * (std::pow(E_strong / E_weak, 2) - 1));
  };
  count(nearest, HUGE_VAL);
  for (const std::size_t n : weaker.mean) count(n, shift_by_modulation(weak.mean()[n]));
  return std::min(0.5, grown);
}

}  // namespace

Place place_of(const StabilitySample& sample, const SystemAt& at) {
  Place made{.sample = sample};
  if (sample.mean.empty()) {
    if (const std::optional<ScaledSystem> system = at(sample.x)) made.sample.mean = mean_exponents(*system);
  }
  made.pair = leading_pair(sample);
  made.unstable = is_unstable(sample);
  return made;
}

const std::vector<std::size_t>& onward(const Place& p, const Place& q) {
  const auto known = p.continued_at.find(q.x());
  return known != p.continued_at.end()
             ? known->second
             : p.continued_at.emplace(q.x(), continued(p.strands(), q.strands())).first->second;
}

double apart(const Strands& strands, std::size_t a, std::size_t b) {
  return std::abs(folded(strands.all[a].s - strands.all[b].s).imag());
}

std::vector<double> unpredicted_motions(const Place& p, const Place& q) {
  const std::vector<std::size_t>& at_q = onward(p, q);
  std::vector<double> unpredicted(at_q.size(), 0);
  for (std::size_t k = 0; k < at_q.size(); ++k) {
    const Strand& strand = p.strands().all[k];
    if (at_q[k] == no_strand || strand.mean.empty() || p.mean().size() != q.mean().size()) continue;
    const double moved = (q.strands().all[at_q[k]].s - strand.s).imag();
    double least = HUGE_VAL;
    for (const std::size_t n : strand.mean) {
      const double apart = moved - (q.mean()[n].value - p.mean()[n].value).imag();
      least = std::min(least, std::abs(apart - std::round(apart)));
    }
    unpredicted[k] = std::max(least, grown_shift(p, strand, q, q.strands().all[at_q[k]]));
  }
  return unpredicted;
}

std::vector<double> motions(const Place& p, const Place& q) {
  const std::vector<std::size_t>& at_q = onward(p, q);
  std::vector<double> motion = unpredicted_motions(p, q);
  for (std::size_t k = 0; k < motion.size(); ++k) {
    motion[k] = 2 * (motion[k] + mean_motion(p.strands(), q.strands(), k));
    if (at_q[k] != no_strand) motion[k] += std::abs(folded(q.strands().all[at_q[k]].s - p.strands().all[k].s).imag());
  }
  return motion;
}
}  // namespace hb
