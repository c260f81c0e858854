#include "hb/engine/boundaries/place_models.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace hb {

namespace {

using cplx = std::complex<double>;

// Models take places no farther away than that.
constexpr double most_motion_of_models = 0.5;

bool usable(const Place& place, const Place& like) { return !place.strands.all.empty() && !like.strands.all.empty(); }

// Where strands of p are at another place of its window, from place to place.
std::optional<std::vector<std::size_t>> followed(const Places& places, const Place& p, const Place& to,
                                                 std::vector<std::size_t> strands) {
  auto it = places.find(p.x());
  const bool up = to.x() > p.x();
  while (it->first != to.x()) {
    const auto next = up ? std::next(it) : std::prev(it);
    if (!usable(next->second, p)) return std::nullopt;
    const std::vector<std::size_t> onward = continued(it->second.strands, next->second.strands);
    for (std::size_t& k : strands) {
      k = onward[k];
      if (k == no_strand) return std::nullopt;
    }
    it = next;
  }
  return strands;
}

using Two = std::array<std::size_t, 2>;

// Two strands at a place as near to each other as they can be, no farther than most_motion_of_models from p.
std::optional<GrowthNode> near_node(const Place& p, Two of_p, const Place& place, const std::vector<std::size_t>& at,
                                    const std::vector<GrowthNode>& before) {
  const Strand &s = place.strands.all[at[0]], &t = place.strands.all[at[1]];
  // Farther apart they are nearer on the other side.
  constexpr double farthest = 0.4;
  if (!(std::abs(folded(s.s - t.s).imag()) <= farthest)) return std::nullopt;
  if (before.size() >= 2 &&
      mean_motion(p.strands, place.strands, of_p[0]) + mean_motion(p.strands, place.strands, of_p[1]) >
          most_motion_of_models)
    return std::nullopt;
  GrowthNode node = pair_node(place.x(), s.s, t.s, std::round(s.s.imag() - t.s.imag()), s.error, t.error);
  if (!before.empty()) node.angle -= std::round(node.angle - before.front().angle);
  return node;
}

// Two strands of a place with one name each, by which the turns between them are counted at others.
struct Unfolding {
  Two names;
  std::array<double, 2> mean, seen;  // imaginary parts
};

double frequency_of(const Place& place, std::size_t n) {
  return place.mean[n].frozen != 0 ? place.mean[n].frozen : place.mean[n].value.imag();
}

std::optional<Unfolding> unfolding_of(const Place& place, Two strands) {
  Unfolding unfolding{};
  for (std::size_t k = 0; k < 2; ++k) {
    const Strand& strand = place.strands.all[strands[k]];
    if (strand.mean.empty()) return std::nullopt;
    unfolding.names[k] = strand.mean.front();
    unfolding.mean[k] = frequency_of(place, unfolding.names[k]);
    unfolding.seen[k] = strand.s.imag();
  }
  if (unfolding.names[0] == unfolding.names[1]) return std::nullopt;
  unfolding.seen[0] -= std::round(unfolding.seen[0] - unfolding.seen[1]);
  return unfolding;
}

// The two at a place as far apart as their names tell; empty where these do not agree. Two that are as good as one may
// have exchanged their names.
std::optional<GrowthNode> far_node(const Unfolding& of, const Place& place, Two strands, bool is_named) {
  constexpr double most_off = 0.1;
  std::array<cplx, 2> nearest;
  double least = most_off;
  for (const Two at : {strands, Two{strands[1], strands[0]}}) {
    std::array<cplx, 2> s;
    double off = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const Strand& strand = place.strands.all[at[k]];
      const std::size_t name = of.names[k];
      if (name >= place.mean.size() || (is_named && std::ranges::count(strand.mean, name) == 0)) off = HUGE_VAL;
      if (std::isinf(off)) break;
      const double expected = of.seen[k] + frequency_of(place, name) - of.mean[k];
      s[k] = strand.s + cplx(0, std::round(expected - strand.s.imag()));
      off = std::max(off, std::abs(s[k].imag() - expected));
    }
    if (!(off < least)) continue;
    least = off;
    nearest = s;
  }
  if (!(least < most_off)) return std::nullopt;
  return pair_node(place.x(), nearest[0], nearest[1], 0, place.strands.all[strands[0]].error,
                   place.strands.all[strands[1]].error);
}

// p, q and up to three more on either side, each a quarter of the interval farther than the one before, nearest first.
std::vector<const Place*> wide_window(const Places& places, const Place& p, const Place& q) {
  constexpr std::size_t on_a_side = (GrowthModel::most_nodes - 2) / 2;
  const auto low = places.find(std::min(p.x(), q.x())), high = places.find(std::max(p.x(), q.x()));
  const double room = 0.25 * (high->first - low->first);
  std::vector<const Place*> chosen = {&p, &q};
  double last = low->first;
  for (auto it = low; it != places.begin() && chosen.size() < 2 + on_a_side;) {
    --it;
    if (last - it->first > room && usable(it->second, p)) chosen.push_back(&it->second), last = it->first;
  }
  const std::size_t most = chosen.size() + on_a_side;
  last = high->first;
  for (auto it = std::next(high); it != places.end() && chosen.size() < most; ++it)
    if (it->first - last > room && usable(it->second, p)) chosen.push_back(&it->second), last = it->first;
  const auto away = [&](const Place* place) { return std::max(low->first - place->x(), place->x() - high->first); };
  std::stable_sort(chosen.begin() + 2, chosen.end(), [&](const Place* a, const Place* b) { return away(a) < away(b); });
  return chosen;
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
  constexpr double far = 4;
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
    return is_apart(place, what) && (what == Apart::pair || place.alone->half_trace == p.alone->half_trace);
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

namespace {

// Of the places about p and q at which the two strands are where their names at one of them tell, most of all.
std::vector<GrowthNode> wide_nodes(const Places& places, const Place& p, Two of_p, const Place& q) {
  struct Followed {
    const Place* place;
    Two strands;
  };
  std::vector<Followed> all;
  for (const Place* place : wide_window(places, p, q))
    if (const auto at = followed(places, p, *place, {of_p[0], of_p[1]})) all.push_back({place, {(*at)[0], (*at)[1]}});
  std::vector<GrowthNode> most;
  for (const Followed& named : all) {
    const std::optional<Unfolding> unfolding = unfolding_of(*named.place, named.strands);
    if (!unfolding) continue;
    std::vector<GrowthNode> nodes;
    for (const auto& [place, strands] : all)
      if (const auto node = far_node(*unfolding, *place, strands, place != &p && place != &q)) nodes.push_back(*node);
    if (nodes.size() > most.size()) most = std::move(nodes);
  }
  return most;
}

}  // namespace

std::optional<GrowthModel> single_model(const Places& places, const Place& p, std::size_t k, const Place& q) {
  std::vector<GrowthNode> nodes;
  for (const Place* place : window(places, p, q)) {
    const auto at = followed(places, p, *place, {k});
    if (!at) continue;
    if (place != &p && place != &q && mean_motion(p.strands, place->strands, k) > most_motion_of_models) continue;
    const Strand& s = place->strands.all[(*at)[0]];
    const double turned = nodes.empty() ? 0 : std::round(s.s.imag() - nodes.front().angle);
    nodes.push_back({place->x(), s.s.real(), s.s.imag() - turned, 0, s.error, 0});
  }
  return consistent_model(std::move(nodes), p, q);
}

std::optional<GrowthModel> pair_model(const Places& places, const Place& p, std::size_t a, std::size_t b,
                                      const Place& q) {
  std::vector<GrowthNode> nodes;
  for (const Place* place : window(places, p, q))
    if (const auto at = followed(places, p, *place, {a, b}))
      if (const auto node = near_node(p, {a, b}, *place, *at, nodes)) nodes.push_back(*node);
  std::optional<GrowthModel> model = consistent_model(nodes, p, q);
  std::vector<GrowthNode> wide = wide_nodes(places, p, {a, b}, q);
  const double middle = 0.5 * (p.x() + q.x());
  for (; wide.size() > 3; wide.pop_back())
    if (std::optional<GrowthModel> wider = consistent_model(wide, p, q);
        wider && (!model || wider->Q_error(middle) < model->Q_error(middle)))
      model = std::move(wider);
  return model;
}

std::optional<GrowthModel> partner_model(const Places& places, const Place& p, std::size_t k, const Place& q) {
  std::size_t partner = no_strand;
  double least = HUGE_VAL;
  for (std::size_t other = 0; other < p.strands.all.size(); ++other) {
    if (other == k) continue;
    const double distance = apart(p.strands, k, other);
    if (distance < least) {
      least = distance;
      partner = other;
    }
  }
  if (partner == no_strand) return std::nullopt;
  return pair_model(places, p, k, partner, q);
}

}  // namespace hb
