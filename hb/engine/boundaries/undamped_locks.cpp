#include "hb/engine/boundaries/undamped_locks.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hb/engine/boundaries/mirror_images.hpp"
#include "hb/engine/boundaries/pair_model.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

// A lock may be that of any mode, none of which turns farther from place to place; twice that where it is divided.
constexpr double lock_turns = 0.4, lock_too_far = 2;
constexpr std::size_t fewest_locks = 4, locks_beside = 2;
constexpr double slack = 1e-12;  // of a turn, beside a multiplier +1 or -1

// The stiffness is symmetric at all angles and nothing damps: exponents are s, -s in pairs.
bool is_undamped(const Place& place) {
  return place.strands().all.size() == place.mean().size() &&
         std::ranges::none_of(place.mean(), [](const MeanExponent& m) { return m.value.real() != 0 || m.drift != 0; });
}

// Half traces cosh 2 pi s beyond 1, of multipliers of one sign, descending.
std::vector<LeadingPair> locks_of(const Place& place, double sign) {
  std::vector<LeadingPair> locks;
  for (const Strand& strand : place.strands().all) {
    const double g = strand.s.real(), turn = std::abs(strand.s.imag()), away = sign > 0 ? turn : 0.5 - turn;
    if (strand.partner == no_strand || !(g > 4 * strand.error) || !(away <= slack)) continue;
    const Strand& partner = place.strands().all[strand.partner];
    if (!(std::abs(g + partner.s.real()) <= strand.error + partner.error)) continue;
    LeadingPair lock;
    lock.half_trace = sign * std::cosh(two_pi * g);
    const double d = two_pi * strand.error;
    lock.half_trace_error = std::sinh(two_pi * g) * std::sinh(d) + std::cosh(two_pi * g) * (std::cosh(d) - 1);
    if (std::isfinite(lock.half_trace)) locks.push_back(lock);
  }
  return locks;
}

// How far any of the mean exponents turns, with its shift by modulation.
double most_turned(const Place& p, const Place& q) {
  if (p.mean().size() != q.mean().size()) return HUGE_VAL;
  double most = 0;
  for (std::size_t n = 0; n < p.mean().size(); ++n) most = std::max(most, moved(p.mean()[n], q.mean()[n]));
  return most;
}

// Multipliers of a sign, and how many locks of that sign are stronger. Real ones exchange their places only by becoming
// complex together.
struct Lock {
  double sign;
  std::size_t rank;
};

std::optional<LeadingPair> lock_at(const Place& place, Lock lock) {
  if (!place.unstable || !is_undamped(place)) return std::nullopt;
  const std::vector<LeadingPair> all = locks_of(place, lock.sign);
  return lock.rank < all.size() ? std::optional(all[lock.rank]) : std::nullopt;
}

// p, q and up to two places on either side with this lock, a quarter of the interval apart, nearest first.
std::vector<PairNode> lock_nodes(const Places& places, const Place& p, const Place& q, Lock lock) {
  const double room = 0.25 * (q.x() - p.x());
  std::vector<const Place*> chosen = {&p, &q};
  const auto add = [&](const Place& place, double& last) {
    if (!lock_at(place, lock)) return false;
    if (std::abs(place.x() - last) > room) chosen.push_back(&place), last = place.x();
    return true;
  };
  double last = p.x();
  for (auto it = places.find(p.x()); it != places.begin() && chosen.size() < 2 + locks_beside;)
    if (--it; !add(it->second, last)) break;
  const std::size_t most = chosen.size() + locks_beside;
  last = q.x();
  for (auto it = std::next(places.find(q.x())); it != places.end() && chosen.size() < most; ++it)
    if (!add(it->second, last)) break;
  const auto away = [&](const Place* place) { return std::max(p.x() - place->x(), place->x() - q.x()); };
  std::stable_sort(chosen.begin() + 2, chosen.end(), [&](const Place* a, const Place* b) { return away(a) < away(b); });
  std::vector<PairNode> nodes;
  for (const Place* place : chosen)
    nodes.push_back({place->x(), *lock_at(*place, lock), std::copysign(most_turned(p, *place), place->x() - p.x())});
  nodes.front().turned = 0;
  return nodes;
}

// Half traces of one sign keep apart, and beyond 1, even where they change as much again as from p to q.
bool keeps_apart(const Place& p, const Place& q, Lock lock) {
  const std::vector<LeadingPair> at_p = locks_of(p, lock.sign), at_q = locks_of(q, lock.sign);
  const auto size = [](const std::vector<LeadingPair>& locks, std::size_t rank) {
    return rank < locks.size() ? std::abs(locks[rank].half_trace) : 1;
  };
  const auto away = [&](std::size_t upper, std::size_t lower) {
    const double a = size(at_p, upper) - size(at_p, lower), b = size(at_q, upper) - size(at_q, lower);
    return std::min(a, b) > std::abs(a - b);
  };
  if (lock.rank > 0 && !away(lock.rank - 1, lock.rank)) return false;
  const double one = size(at_p, lock.rank), other = size(at_q, lock.rank);
  return away(lock.rank, lock.rank + 1) && std::min(one, other) - std::abs(one - other) > 1;
}

// Growth that what comes to that multiplier between p and q may have there: an exponent that starts `away` from it,
// locks there and is gone at q moves by kappa + sqrt(kappa^2 + away^2) by itself, (B22), and may grow already by a lock
// elsewhere. `motions` count three times what they move.
double growth_of_comers(const Place& p, const Place& q, double sign) {
  const std::vector<double> motion = motions(p, q);
  double most = 0;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const Strand& strand = p.strands().all[k];
    const double turn = std::abs(strand.s.imag()), away = sign > 0 ? turn : 0.5 - turn, reach = 0.5 * motion[k];
    const bool locked_there = strand.partner != no_strand && away <= slack;
    if (!locked_there && away < reach)
      most = std::max(most, std::max(0.0, strand.s.real()) + 0.5 * (reach - away * away / reach));
  }
  return most;
}

bool lasts(const Places& places, const Place& p, const Place& q, Lock lock) {
  if (!keeps_apart(p, q, lock)) return false;
  std::vector<PairNode> nodes = lock_nodes(places, p, q, lock);
  if (nodes.size() < fewest_locks) return false;
  const PairModel model(std::move(nodes));
  const double others = std::max(growth_of_comers(p, q, lock.sign), growth_of_comers(q, p, lock.sign));
  return std::ranges::all_of(model.telling(), [&](double x) { return model.leading(x).low > others; });
}

}  // namespace

std::optional<double> doubtful_while_locked(const Places& places, const Place& p, const Place& q) {
  if (!p.unstable || !q.unstable || !is_undamped(p) || !is_undamped(q)) return std::nullopt;
  // Damping that the mean exponents do not show.
  if (lacks_an_image(p.sample) || lacks_an_image(q.sample)) return std::nullopt;
  const double turned = most_turned(p, q);
  if (!(turned <= lock_too_far * lock_turns)) return std::nullopt;
  bool at_both = false;
  for (const double sign : {1.0, -1.0}) {
    const std::size_t count = std::min(locks_of(p, sign).size(), locks_of(q, sign).size());
    at_both = at_both || count > 0;
    for (std::size_t rank = 0; rank < count && turned <= lock_turns; ++rank)
      if (lasts(places, p, q, {sign, rank})) return nan;
  }
  return at_both && turned > lock_turns ? std::optional(0.5 * (p.x() + q.x())) : std::nullopt;
}

}  // namespace hb
