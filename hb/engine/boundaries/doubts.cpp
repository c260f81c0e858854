#include "hb/engine/boundaries/doubts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hb/engine/boundaries/place_models.hpp"
#include "lib/constants.hpp"
#include "lib/golden_section.hpp"

namespace hb {

namespace {

// Two exponents move by this part of a turn against each other at most from place to place, where they may excite each
// other.
constexpr double most_motion = 0.25, most_motion_while_unstable = 0.15, most_motion_while_locked = 0.5;
// ... and by this part at most otherwise than their means.
constexpr double most_unpredicted_motion = 0.05;
// Where two meet is not looked at again as near as this part of the interval to where it was, until more is known.
constexpr double near_centre = 1e-3;

// The lowest places between neighbours of each place where f is lower than at both.
template <class Function>
std::vector<double> notches(const Function& f, std::vector<double> places, int steps) {
  std::ranges::sort(places);
  std::vector<double> values, found;
  for (const double x : places) values.push_back(f(x));
  for (std::size_t k = 1; k + 1 < places.size(); ++k)
    if (values[k] <= values[k - 1] && values[k] <= values[k + 1])
      found.push_back(largest_between(
          places[k - 1], places[k + 1], [&](double x) { return -f(x); }, steps));
  return found;
}

std::pair<double, double> highest(const GrowthModel& model, const Place& p, const Place& q) {
  double worst = -HUGE_VAL, where = 0.5 * (p.x() + q.x());
  std::vector<double> all = probes(p.x(), q.x());
  all.push_back(model.centre());
  for (const double x : all) {
    const double high = model(x).high;
    if (!(high <= worst)) {
      worst = high;
      where = x;
    }
  }
  return {where, worst};
}

// How near to an end, as a part of the interval, it is divided so that a bound there that is `high` falls to
// `wanted`: it is about in proportion to the width of what is left. Not so near that the places would be taken for
// one.
double margin_towards(double wanted, double high) {
  constexpr double least = 3e-4, most = 0.02;
  return std::clamp(0.3 * wanted / high, least, most);
}

double clamped(double x, const Place& p, const Place& q, double part = 0.02) {
  const double margin = part * (q.x() - p.x());
  return std::clamp(x, p.x() + margin, q.x() - margin);
}

}  // namespace

// Where two meet at an end of the interval and growth is doubtful next to that: three places close to each other, there
// and on either side, show how Q turns. NaN: they are there.
double Doubts::beside_centre(const Place& p, const Place& q, double centre, double doubtful) const {
  constexpr double least = 3e-4, next_to = 0.15, close = 8;
  const double width = q.x() - p.x(), known = std::min(centre - p.x(), q.x() - centre);
  const bool at_p = centre - p.x() < q.x() - centre;
  const double end = at_p ? p.x() : q.x(), step = std::max(least * width, 3 * known);
  if (known > near_centre * width || std::abs(doubtful - end) > next_to * width) return nan;
  const auto at = places_.find(end);
  const auto beyond = at_p ? (at == places_.begin() ? places_.end() : std::prev(at)) : std::next(at);
  if (beyond != places_.end() && std::abs(beyond->first - end) <= close * step) return nan;
  return at_p ? end + step : end - step;
}

double Doubts::while_stable(const Place& p, const Place& q) const {
  const double middle = 0.5 * (p.x() + q.x());
  if (p.strands().all.empty() || q.strands().all.empty()) return middle;
  if (!encounters_.resolved(p, q, most_motion)) return middle;
  // Where it is the modulation that moves them, what they do between the places is not known from their means.
  if (std::ranges::any_of(unpredicted_motions(p, q), [](double part) { return part > most_unpredicted_motion; }))
    return middle;
  const double least = least_growth(p, q);
  double worst = least, where = nan, untold = 0;
  const auto meeting = encounters_.meetings(p, q, least);
  for (const Meeting& m : meeting) {
    const std::optional<GrowthModel> model = pair_model(places_, p, m.a, m.b, q);
    if (!model) return clamped(m.x, p, q, 0.2);
    // A growth of this pair that is not told from none.
    untold = std::max(untold, 2 * model->error());
    const double told = std::max(worst, 2 * model->error());
    const double far = std::max(-model->mean_growth(), told), centre = model->centre(), width = q.x() - p.x();
    const double known = std::min(centre - p.x(), q.x() - centre);  // how near the centre was looked for before
    const bool inside = known > 1e-7 * width;
    const auto [x, high] = highest(*model, p, q);
    if (inside && model->rise() > 0.25 * far * far && (known > near_centre * width || (*model)(centre).low > told))
      return centre;
    if (high > told) {
      const double closely = beside_centre(p, q, centre, x);
      where = !std::isnan(closely)                    ? closely
              : inside && known > near_centre * width ? centre
                                                      : clamped(x, p, q, margin_towards(told, high));
      worst = high;
    }
  }
  if (!std::isnan(where)) return where;
  if (const double x = in_crowds(p, q, meeting, std::max(worst, untold)); !std::isnan(x)) return x;
  if (level(p, q, least)) return nan;
  worst = std::max(worst, untold);
  // One that decays several times as fast as the leading one does not rise above zero by itself.
  constexpr double several = 4;
  const double slowest = std::min(p.growth(), q.growth());
  for (std::size_t k = 0; k < p.strands().all.size() && p.strands().all[k].s.real() > several * slowest - least; ++k) {
    double high = HUGE_VAL, x = middle;
    for (const std::optional<GrowthModel>& model : {single_model(places_, p, k, q), partner_model(places_, p, k, q)}) {
      if (!model) continue;
      if (const auto [x_model, high_model] = highest(*model, p, q); high_model < high) {
        high = high_model;
        x = x_model;
      }
    }
    if (high > worst) {
      worst = high;
      where = clamped(x, p, q);
    }
  }
  return where;
}

// What a pair's model tells does not hold where others come near: all of them together tell.
double Doubts::in_crowds(const Place& p, const Place& q, const std::vector<Meeting>& meetings, double told) const {
  constexpr int steps = 24;
  constexpr double central = 0.3;  // errors fall with the fourth power of the width
  double where = nan, worst = told;
  for (const std::vector<std::size_t>& crowd : encounters_.crowds(p, q, meetings)) {
    const std::optional<ClusterModel> model = cluster_model(places_, p, crowd, q);
    if (!model) return 0.5 * (p.x() + q.x());
    const auto look = [&](double x) {
      const ClusterModel::Bounds at_x = (*model)(x, told);
      if (at_x.growth > worst) {
        where = clamped(x, p, q, central);
        worst = at_x.growth;
      }
      return at_x.apart;
    };
    for (const double x : notches(look, probes(p.x(), q.x()), steps)) look(x);
  }
  return where;
}

double Doubts::while_unstable(const Place& p, const Place& q) const {
  const double middle = 0.5 * (p.x() + q.x());
  if (p.strands().all.empty() || q.strands().all.empty()) return middle;
  // While a pair is locked so much more deeply than it moves it stays so; half a turn farther it may have left one
  // order, where multipliers are near +1, for the next, -1, but not for the one after that.
  const double most =
      std::clamp(std::min(p.growth(), q.growth()), most_motion_while_unstable, most_motion_while_locked);
  if (!encounters_.resolved(p, q, most)) return middle;
  if (locks_.hold(p, q) || level_lock(p, q)) return nan;
  const std::vector<GrowthModel> models = models_of_growth(p, q);
  if (models.empty()) return middle;
  double worst = HUGE_VAL, where = middle;
  const auto lowest = [&](double x) {
    double low = -HUGE_VAL;
    for (const GrowthModel& model : models) low = std::max(low, model(x).low);
    return low;
  };
  const auto look = [&](double x, double nearest) {
    if (const double low = lowest(x); low < worst) {
      worst = low;
      where = clamped(x, p, q, nearest);
    }
  };
  const std::vector<double> places = probes(p.x(), q.x());
  for (const double x : places) look(x, 0.02);
  // A pair's growth has a notch where the two pass each other, that of several one where another takes the lead.
  for (const GrowthModel& model : models) look(model.centre(), 1e-6);
  // It is looked at closely where a change of verdict is foretold.
  const auto foretold = [&](double x) {
    return std::ranges::all_of(models, [&](const GrowthModel& model) { return model(x).low + model(x).high <= 0; });
  };
  for (const double x : notches(lowest, places, 36)) look(x, foretold(x) ? 1e-6 : 0.02);
  return worst > 0 ? nan : where;
}

// Of exponents that grow by themselves, or with one other, locked to it or not.
std::vector<GrowthModel> Doubts::models_of_growth(const Place& p, const Place& q) const {
  std::vector<GrowthModel> models;
  for (const Place* place : {&p, &q}) {
    const Place& other = place == &p ? q : p;
    for (std::size_t k = 0; k < place->strands().all.size(); ++k) {
      const Strand& strand = place->strands().all[k];
      if (!(strand.s.real() > std::max(coupling_.least_growth(), strand.error))) continue;
      std::vector<std::size_t> near = encounters_.neighbours(*place, other, k);
      if (strand.partner != no_strand) {
        const std::vector<std::size_t> of_partner = encounters_.neighbours(*place, other, strand.partner);
        near.insert(near.end(), of_partner.begin(), of_partner.end());
        std::erase_if(near, [&](std::size_t n) { return n == k || n == strand.partner; });
        near.push_back(strand.partner);
      }
      if (near.size() > 1) continue;
      const std::optional<GrowthModel> model =
          near.empty() ? single_model(places_, *place, k, other) : pair_model(places_, *place, k, near.front(), other);
      if (model) models.push_back(*model);
    }
  }
  return models;
}

// The largest growth that any exponent has by itself hardly changes.
bool Doubts::level(const Place& p, const Place& q, double least) const {
  double low = HUGE_VAL, high = -HUGE_VAL;
  const std::vector<const Place*> places = window(places_, p, q);
  if (places.size() < 3) return false;
  for (const Place* place : places) {
    double growth = -HUGE_VAL;
    for (std::size_t k = 0; k < place->strands().all.size(); ++k)
      growth = std::max(growth, growth_by_itself(place->strands(), k));
    low = std::min(low, growth);
    high = std::max(high, growth);
  }
  return high + 2 * (high - low) <= least;
}

// Two exponents are locked alike at p and q and at a place on either side, with growth that hardly changes: beside a
// gap Q would fall in proportion to the distance from it.
bool Doubts::level_lock(const Place& p, const Place& q) const {
  constexpr double nearest = 0.25, farthest = 4, most_ratio = 1.15;
  const double width = q.x() - p.x();
  std::vector<const Place*> places = {&p, &q};
  for (auto it = places_.find(p.x()); it != places_.begin();) {
    --it;
    if (p.x() - it->first < nearest * width) continue;
    if (p.x() - it->first <= farthest * width) places.push_back(&it->second);
    break;
  }
  for (auto it = std::next(places_.find(q.x())); it != places_.end(); ++it) {
    if (it->first - q.x() < nearest * width) continue;
    if (it->first - q.x() <= farthest * width) places.push_back(&it->second);
    break;
  }
  if (places.size() < 4 || !locks_.undisturbed(p, 0, q) || !locks_.undisturbed(q, 0, p)) return false;
  double low = HUGE_VAL, high = 0;
  for (const Place* place : places) {
    if (!place->unstable || !locked_alike(*place, p)) return false;
    low = std::min(low, place->growth());
    high = std::max(high, place->growth());
  }
  return high <= most_ratio * low;
}

// A growth that is not told from none between two places.
double Doubts::least_growth(const Place& p, const Place& q) const {
  double least = coupling_.least_growth();
  for (const Place* place : {&p, &q})
    if (place->growth_error() < 1 && !is_far_from_zero(place->growth())) least = std::max(least, place->growth_error());
  return least;
}

}  // namespace hb
