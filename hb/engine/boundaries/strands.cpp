#include "hb/engine/boundaries/strands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory_resource>
#include <tuple>

namespace hb {

namespace {

using cplx = std::complex<double>;

// A mean exponent this much farther than the nearest one is still a candidate: modulation shifts exponents.
constexpr double doubt = 0.15;
// ... but not one that decays so many times faster or slower. What the solver names an exponent does not count: in a
// group of coupled modes it is a guess.
constexpr double unlike_decay = 3;

// Short lists that are needed for a moment: on the stack unless they are long.
template <class Element>
using ShortList = std::pmr::vector<Element>;
class ShortMemory : public std::pmr::monotonic_buffer_resource {
 public:
  ShortMemory() : std::pmr::monotonic_buffer_resource(bytes_.data(), bytes_.size()) {}

 private:
  std::array<std::byte, 2048> bytes_;
};

// Lines Re = const that part exponents and mean ones alike: as many of either beyond, those next to the line moved by
// no more than a part of its distance from them, and none that modulation may take across. What locks two exponents
// moves both; their mean counts.
ShortList<double> parting_lines(const Strands& strands, const std::vector<MeanExponent>& mean, ShortMemory& memory) {
  constexpr double most_moved = 0.25;
  struct Seen {
    double growth, error;
    auto operator<=>(const Seen&) const = default;
  };
  ShortList<double> lines(&memory), means(&memory);
  if (strands.all.size() != mean.size()) return lines;
  ShortList<Seen> seen(&memory);
  seen.reserve(mean.size());
  means.reserve(mean.size());
  for (std::size_t k = 0; k < mean.size(); ++k) {
    seen.push_back({growth_by_itself(strands, k), strands.all[k].error});
    means.push_back(mean[k].value.real());
  }
  std::ranges::sort(seen, std::greater<>());
  std::ranges::sort(means, std::greater<>());
  const auto moved = [&](std::size_t k) { return std::abs(seen[k].growth - means[k]) + seen[k].error; };
  for (std::size_t k = 0; k + 1 < means.size(); ++k) {
    const double low = std::max(means[k + 1], seen[k + 1].growth), high = std::min(means[k], seen[k].growth);
    const double line = 0.5 * (low + high);
    const auto stays = [&](const MeanExponent& m) { return m.drift < std::abs(m.value.real() - line); };
    if (std::max(moved(k), moved(k + 1)) < most_moved * (high - low) && std::ranges::all_of(mean, stays))
      lines.push_back(line);
  }
  return lines;
}

// s: its real part as it would be without what locks it.
std::vector<std::size_t> candidates(cplx s, const std::vector<MeanExponent>& mean, const ShortList<double>& lines,
                                    ShortMemory& memory) {
  const auto parted = [&](double x, double y) {
    return std::ranges::any_of(lines, [&](double line) { return (x < line) != (y < line); });
  };
  ShortList<std::pair<double, std::size_t>> distances(&memory);
  distances.reserve(mean.size());
  for (std::size_t n = 0; n < mean.size(); ++n) {
    if (parted(s.real(), mean[n].value.real())) continue;
    const double decay = -mean[n].value.real(), seen = -s.real();
    const bool alike =
        (decay <= unlike_decay * seen && seen <= unlike_decay * decay) || std::abs(decay - seen) <= mean[n].drift;
    distances.emplace_back(std::abs(folded(s - mean[n].value).imag()) + (alike ? 0 : 2 * doubt), n);
  }
  std::sort(distances.begin(), distances.end());
  std::vector<std::size_t> found;
  found.reserve(distances.size());
  for (const auto& [distance, n] : distances)
    if (distance <= distances.front().first + std::max(doubt, shift_by_modulation(mean[n]))) found.push_back(n);
  return found;
}

// Names by frozen frequencies, the nearest first. They are taken where all strands but one pair have frozen ones of
// their own that near: then the others' are no chance. Two that are mistaken for each other are as near to each other
// as both are to the names of the other, so that all names in reach of the farthest one are listed. Empty: none are
// taken.
std::vector<std::vector<std::size_t>> frozen_names(const std::vector<Strand>& all,
                                                   const std::vector<MeanExponent>& mean) {
  constexpr double near = 0.02, nearest = 5e-4;
  constexpr std::size_t most_left_out = 2;
  if (all.size() != mean.size() || std::ranges::any_of(mean, [](const auto& m) { return m.frozen == 0; })) return {};
  struct Match {
    double distance;
    std::size_t strand, mean;
    auto operator<=>(const Match&) const = default;
  };
  std::vector<Match> matches;
  for (std::size_t k = 0; k < all.size(); ++k)
    for (std::size_t n = 0; n < mean.size(); ++n)
      matches.push_back({std::abs(folded({0, all[k].s.imag() - mean[n].frozen}).imag()), k, n});
  std::ranges::sort(matches);
  std::vector<bool> named(all.size(), false), taken(mean.size(), false);
  std::size_t found = 0;
  double farthest = nearest;
  for (const Match& m : matches) {
    if (m.distance > near) break;
    if (named[m.strand] || taken[m.mean]) continue;
    named[m.strand] = taken[m.mean] = true;
    farthest = std::max(farthest, m.distance);
    ++found;
  }
  if (found + most_left_out < all.size()) return {};
  std::vector<std::vector<std::size_t>> names(all.size());
  for (const Match& m : matches)
    if (named[m.strand] && m.distance <= std::min(4 * farthest, 2 * near)) names[m.strand].push_back(m.mean);
  return names;
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

double growth_by_itself(const Strands& strands, std::size_t k) {
  const Strand& strand = strands.all[k];
  return strand.partner == no_strand ? strand.s.real() : 0.5 * (strand.s.real() + strands.all[strand.partner].s.real());
}

cplx folded(cplx s) {
  double im = s.imag() - std::floor(s.imag() + 0.5);
  if (im <= -0.5) im += 1;
  return {s.real(), im};
}

Strands strands_of(const StabilitySample& sample, const std::vector<MeanExponent>& mean) {
  Strands strands;
  strands.x = sample.x;
  strands.growth_error = sample.stability.growth_error / sample.speed;
  strands.mean.reserve(mean.size());
  for (const MeanExponent& exponent : mean) strands.mean.push_back(exponent.value);
  strands.all.reserve(sample.stability.exponents.size() + sample.stability.uncertain.size());
  for (const std::vector<Exponent>* list : {&sample.stability.exponents, &sample.stability.uncertain}) {
    for (const Exponent& e : *list) {
      if (!std::isfinite(e.error)) continue;
      const cplx s = folded(e.value / sample.speed);
      strands.all.push_back({s, e.error / sample.speed, {}});
    }
  }
  const auto faster = [](const Strand& a, const Strand& b) { return a.s.real() > b.s.real(); };
  if (!std::ranges::is_sorted(strands.all, faster)) std::ranges::stable_sort(strands.all, faster);
  find_partners(strands.all);
  ShortMemory memory;
  const ShortList<double> lines = parting_lines(strands, mean, memory);
  const std::vector<std::vector<std::size_t>> frozen = frozen_names(strands.all, mean);
  for (std::size_t k = 0; k < strands.all.size(); ++k)
    strands.all[k].mean =
        !frozen.empty() && !frozen[k].empty()
            ? frozen[k]
            : candidates({growth_by_itself(strands, k), strands.all[k].s.imag()}, mean, lines, memory);
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
    bool unlike;  // no mean exponent may have become both
    double distance;  // squared
    std::size_t from, to;
  };
  const auto alike = [](const Strand& a, const Strand& b) {
    return a.mean.empty() || b.mean.empty() ||
           std::ranges::any_of(a.mean, [&](std::size_t n) { return std::ranges::count(b.mean, n) > 0; });
  };
  std::vector<Match> matches;
  matches.reserve(p.all.size() * q.all.size());
  for (std::size_t a = 0; a < p.all.size(); ++a) {
    cplx motion = 0;
    if (!p.all[a].mean.empty() && p.mean.size() == q.mean.size()) {
      const std::size_t n = p.all[a].mean.front();
      motion = q.mean[n] - p.mean[n];
    }
    for (std::size_t b = 0; b < q.all.size(); ++b) {
      const bool unlike = p.mean.size() == q.mean.size() && !alike(p.all[a], q.all[b]);
      const cplx apart = q.all[b].s - p.all[a].s;
      matches.push_back({unlike, std::min(std::norm(folded(apart)), std::norm(folded(apart - motion))), a, b});
    }
  }
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
    return std::tie(a.unlike, a.distance, a.from, a.to) < std::tie(b.unlike, b.distance, b.from, b.to);
  });
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
