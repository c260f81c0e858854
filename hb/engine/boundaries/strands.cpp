#include "hb/engine/boundaries/strands.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

using cplx = std::complex<double>;

// A mean exponent this much farther than the nearest one is still a candidate: modulation shifts exponents.
constexpr double doubt = 0.15;
// Detuning of a resonance that shifts an exponent, (coupling)^2/detuning.
constexpr double detuning = 0.25;
// ... but not one that decays so many times faster or slower. What the solver names an exponent does not count: in a
// group of coupled modes it is a guess.
constexpr double unlike_decay = 3;

// What modulation may shift an exponent by, of second order.
double shift(const MeanExponent& mean) { return mean.coupling * mean.coupling / (9 * detuning); }

std::vector<std::size_t> candidates(cplx s, const std::vector<MeanExponent>& mean) {
  std::vector<std::pair<double, std::size_t>> distances;
  for (std::size_t n = 0; n < mean.size(); ++n) {
    const double decay = -mean[n].value.real(), seen = -s.real();
    const bool alike = decay <= unlike_decay * seen && seen <= unlike_decay * decay;
    distances.emplace_back(std::abs(folded(s - mean[n].value).imag()) + (alike ? 0 : 2 * doubt), n);
  }
  std::sort(distances.begin(), distances.end());
  std::vector<std::size_t> found;
  for (const auto& [distance, n] : distances)
    if (distance <= distances.front().first + std::max(doubt, shift(mean[n]))) found.push_back(n);
  return found;
}

// Of several that are locked at one place the fastest goes with the one that decays likewise.
void find_partners(std::vector<Strand>& all) {
  constexpr double same_place = 1e-7;
  for (std::size_t a = 0; a < all.size(); ++a) {
    if (all[a].partner != no_strand) continue;
    double least = HUGE_VAL;
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      const cplx apart = folded(all[a].s - all[b].s);
      const double error = all[a].error + all[b].error;
      if (all[b].partner != no_strand || std::abs(apart.imag()) > same_place + 2 * error || apart.real() <= 4 * error)
        continue;
      if (const double sum = std::abs(all[a].s.real() + all[b].s.real()); sum < least) {
        least = sum;
        all[a].partner = b;
      }
    }
    if (all[a].partner != no_strand) all[all[a].partner].partner = a;
  }
}

}  // namespace

cplx folded(cplx s) {
  double im = s.imag() - std::floor(s.imag() + 0.5);
  if (im <= -0.5) im += 1;
  return {s.real(), im};
}

Strands strands_of(const StabilitySample& sample, const std::vector<MeanExponent>& mean) {
  Strands strands;
  strands.x = sample.x;
  strands.growth_error = sample.stability.growth_error / sample.speed;
  for (const MeanExponent& exponent : mean) strands.mean.push_back(exponent.value);
  for (const std::vector<Exponent>* list : {&sample.stability.exponents, &sample.stability.uncertain}) {
    for (const Exponent& e : *list) {
      if (!std::isfinite(e.error)) continue;
      const cplx s = folded(e.value / sample.speed);
      strands.all.push_back({s, e.error / sample.speed, candidates(s, mean)});
    }
  }
  std::stable_sort(strands.all.begin(), strands.all.end(),
                   [](const Strand& a, const Strand& b) { return a.s.real() > b.s.real(); });
  find_partners(strands.all);
  return strands;
}

double mean_motion(const Strands& p, const Strands& q, std::size_t k) {
  double motion = 0;
  if (p.mean.size() != q.mean.size()) return motion;
  for (const std::size_t n : p.all[k].mean) motion = std::max(motion, std::abs(q.mean[n].imag() - p.mean[n].imag()));
  return motion;
}

std::vector<std::size_t> continued(const Strands& p, const Strands& q) {
  struct Match {
    double distance;
    std::size_t from, to;
  };
  std::vector<Match> matches;
  for (std::size_t a = 0; a < p.all.size(); ++a) {
    cplx motion = 0;
    if (!p.all[a].mean.empty() && p.mean.size() == q.mean.size()) {
      const std::size_t n = p.all[a].mean.front();
      motion = q.mean[n] - p.mean[n];
    }
    for (std::size_t b = 0; b < q.all.size(); ++b) {
      const cplx apart = q.all[b].s - p.all[a].s;
      matches.push_back({std::min(std::abs(folded(apart)), std::abs(folded(apart - motion))), a, b});
    }
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Match& a, const Match& b) { return a.distance < b.distance; });
  std::vector<std::size_t> result(p.all.size(), no_strand);
  std::vector<bool> taken(q.all.size(), false);
  for (const Match& match : matches) {
    if (result[match.from] != no_strand || taken[match.to]) continue;
    result[match.from] = match.to;
    taken[match.to] = true;
  }
  return result;
}

}  // namespace hb
