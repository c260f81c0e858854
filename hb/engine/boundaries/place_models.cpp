#include "hb/engine/boundaries/place_models.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

using cplx = std::complex<double>;

// Models take places no farther away than that.
constexpr double most_motion_of_models = 0.5;

bool usable(const Place& place, const Place& like) {
  return !place.strands().all.empty() && !like.strands().all.empty();
}

// Where strands of p are at another place of its window, from place to place.
std::optional<std::vector<std::size_t>> followed(const Places& places, const Place& p, const Place& to,
                                                 std::vector<std::size_t> strands) {
  auto it = places.find(p.x());
  const bool up = to.x() > p.x();
  while (it->first != to.x()) {
    const auto next = up ? std::next(it) : std::prev(it);
    if (!usable(next->second, p)) return std::nullopt;
    const std::vector<std::size_t>& there = onward(it->second, next->second);
    for (std::size_t& k : strands) {
      k = there[k];
      if (k == no_strand) return std::nullopt;
    }
    it = next;
  }
  return strands;
}

std::optional<GrowthModel> consistent_model(std::vector<GrowthNode> nodes, const Place& p, const Place& q) {
  if (nodes.size() < 4 || nodes[0].x != p.x() || nodes[1].x != q.x()) return std::nullopt;
  GrowthModel model(std::move(nodes));
  if (!model.consistent()) return std::nullopt;
  return model;
}

}  // namespace

std::vector<const Place*> window(const Places& places, const Place& p, const Place& q) {
  const double room = 1e-4 * std::abs(q.x() - p.x());
  const auto low = places.find(std::min(p.x(), q.x())), high = places.find(std::max(p.x(), q.x()));
  std::vector<const Place*> left, right;
  for (auto it = low; it != places.begin() && left.size() < 2;) {
    --it;
    if (low->first - it->first > room && usable(it->second, p)) left.push_back(&it->second);
  }
  for (auto it = std::next(high); it != places.end() && right.size() < 2; ++it)
    if (it->first - high->first > room && usable(it->second, p)) right.push_back(&it->second);
  // One far off tells less than a second one on the other side.
  constexpr double far = 16;
  const auto away = [&](const Place* place) { return std::max(low->first - place->x(), place->x() - high->first); };
  const auto is_far = [&](const Place* place) { return away(place) > far * (high->first - low->first); };
  std::vector<const Place*> chosen = {&p, &q};
  std::size_t l = 0, r = 0;
  const auto left_is_next = [&] {
    if (l == left.size() || r == right.size()) return l < left.size();
    if (is_far(left[l]) != is_far(right[r])) return is_far(right[r]);
    return l < r || (l == r && away(left[l]) <= away(right[r]));
  };
  while (chosen.size() < 4 && (l < left.size() || r < right.size())) {
    const bool take_left = left_is_next();
    chosen.push_back(take_left ? left[l++] : right[r++]);
  }
  return chosen;
}

std::vector<const Place*> apart_beside(const Places& places, const Place& p, const Place& q, Apart what) {
  constexpr std::size_t on_a_side = 2;
  // Nodes nearer to each other would tell of the exponents' errors.
  const double room = 0.25 * (q.x() - p.x());
  const auto alike = [&](const Place& place) {
    return is_apart(place, what) && (what == Apart::pair || place.alone()->half_trace == p.alone()->half_trace);
  };
  if (!is_apart(p, what) || !alike(q)) return {};
  std::vector<const Place*> chosen = {&p, &q};
  double last = p.x();
  for (auto it = places.find(p.x()); it != places.begin() && chosen.size() < 2 + on_a_side;) {
    --it;
    if (!alike(it->second)) break;
    if (last - it->first > room) chosen.push_back(&it->second), last = it->first;
  }
  const std::size_t most = chosen.size() + on_a_side;
  last = q.x();
  for (auto it = std::next(places.find(q.x())); it != places.end() && chosen.size() < most; ++it) {
    if (!alike(it->second)) break;
    if (it->first - last > room) chosen.push_back(&it->second), last = it->first;
  }
  const auto away = [&](const Place* place) { return std::max(p.x() - place->x(), place->x() - q.x()); };
  std::stable_sort(chosen.begin() + 2, chosen.end(), [&](const Place* a, const Place* b) { return away(a) < away(b); });
  return chosen;
}

std::optional<GrowthModel> single_model(const Places& places, const Place& p, std::size_t k, const Place& q) {
  std::vector<GrowthNode> nodes;
  for (const Place* place : window(places, p, q)) {
    const auto at = followed(places, p, *place, {k});
    if (!at) continue;
    if (place != &p && place != &q && mean_motion(p.strands(), place->strands(), k) > most_motion_of_models) continue;
    const Strand& s = place->strands().all[(*at)[0]];
    nodes.push_back({place->x(), s.s.real(), s.s.imag(), 0, s.error, 0});
  }
  return consistent_model(std::move(nodes), p, q);
}

std::optional<GrowthModel> pair_model(const Places& places, const Place& p, std::size_t a, std::size_t b,
                                      const Place& q) {
  std::vector<GrowthNode> nodes;
  for (const Place* place : window(places, p, q)) {
    const auto at = followed(places, p, *place, {a, b});
    if (!at) continue;
    const Strand &s = place->strands().all[(*at)[0]], &t = place->strands().all[(*at)[1]];
    // Farther apart they are nearer on the other side.
    constexpr double farthest = 0.4;
    if (!(std::abs(folded(s.s - t.s).imag()) <= farthest)) continue;
    if (place != &p && place != &q &&
        mean_motion(p.strands(), place->strands(), a) + mean_motion(p.strands(), place->strands(), b) >
            most_motion_of_models)
      continue;
    nodes.push_back(pair_node(place->x(), s.s, t.s, s.error, t.error));
  }
  if (nodes.size() < 4 || nodes[0].x != p.x() || nodes[1].x != q.x()) return std::nullopt;
  return consistent_model(std::move(nodes), p, q);
}

std::optional<ClusterModel> cluster_model(const Places& places, const Place& p, const std::vector<std::size_t>& strands,
                                          const Place& q) {
  std::vector<ClusterNode> nodes;
  std::vector<cplx> s(strands.size());
  std::vector<double> error(strands.size());
  for (const Place* place : window(places, p, q)) {
    const auto at = followed(places, p, *place, strands);
    if (!at) continue;
    double lowest = 0, highest = 0;
    for (std::size_t j = 0; j < s.size(); ++j) {
      const Strand& strand = place->strands().all[(*at)[j]];
      s[j] = strand.s;
      error[j] = strand.error;
      const double away = folded(s[j] - s[0]).imag();
      lowest = std::min(lowest, away);
      highest = std::max(highest, away);
    }
    if (highest - lowest < 0.5) nodes.push_back(cluster_node(place->x(), s, error));
  }
  if (nodes.size() < 4 || nodes[0].x != p.x() || nodes[1].x != q.x()) return std::nullopt;
  return ClusterModel(std::move(nodes));
}

std::optional<GrowthModel> partner_model(const Places& places, const Place& p, std::size_t k, const Place& q) {
  std::size_t partner = no_strand;
  double least = HUGE_VAL;
  for (std::size_t other = 0; other < p.strands().all.size(); ++other) {
    if (other == k) continue;
    const double distance = apart(p.strands(), k, other);
    if (distance < least) {
      least = distance;
      partner = other;
    }
  }
  if (partner == no_strand) return std::nullopt;
  return pair_model(places, p, k, partner, q);
}

}  // namespace hb
