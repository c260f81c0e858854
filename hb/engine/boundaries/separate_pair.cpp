#include "hb/engine/boundaries/separate_pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hb/engine/boundaries/pair_model.hpp"
#include "lib/constants.hpp"

namespace hb {

namespace {

// The pair moves by this part of a turn at most from place to place: its half trace is sampled twice a period.
constexpr double most_turns = 0.4;
constexpr std::size_t fewest_nodes = 4;
// For another exponent's sake an interval is divided once, or several times where that one decays so much faster that
// the search with all exponents would divide it as often.
constexpr double most_too_far = 2, much_faster = 0.25, most_too_far_of_those = 16;

// Without damping nothing is apart.
bool is_apart(const std::optional<LeadingPair>& pair, Apart what, const StabilitySample& sample) {
  if (!pair || !(pair->lower > pair->others)) return false;
  return is_unstable(sample) || (what == Apart::pair && sample.stability.verdict == Verdict::stable);
}

const std::optional<LeadingPair>& pair_of(const Place& place, Apart what) {
  return what == Apart::pair ? place.pair : place.alone();
}

// Upper estimate of the growth of all other exponents between p and q.
double others_between(const LeadingPair& p, const LeadingPair& q) {
  return p.others == q.others ? p.others : std::max(p.others, q.others) + std::abs(p.others - q.others);
}

// The two mean exponents that decay slowest; both the same if a third one decays as slowly.
std::array<std::size_t, 2> slowest(const std::vector<MeanExponent>& mean) {
  const auto growth = [&](std::size_t n) { return mean[n].value.real(); };
  std::size_t first = 0, second = 1;
  double third = -HUGE_VAL;  // the growth of the next one
  if (growth(second) > growth(first)) std::swap(first, second);
  for (std::size_t n = 2; n < mean.size(); ++n) {
    third = std::max(third, std::min(growth(n), growth(second)));
    if (growth(n) > growth(second)) second = n;
    if (growth(second) > growth(first)) std::swap(first, second);
  }
  if (mean.size() > 2 && !(growth(second) > third)) return {first, first};
  return {std::min(first, second), std::max(first, second)};
}

PairModel model_of(const std::vector<const Place*>& places, Apart what) {
  const Place& first = *places[0];
  const auto turned = [&](const Place& place) {
    if (what == Apart::alone || &place == &first) return 0.0;
    if (place.mean().size() != first.mean().size()) return HUGE_VAL;
    const auto [a, b] = slowest(first.mean());
    return std::copysign(std::max(moved(first.mean()[a], place.mean()[a]), moved(first.mean()[b], place.mean()[b])),
                         place.x() - first.x());
  };
  std::vector<PairNode> nodes;
  for (const Place* place : places) nodes.push_back({place->x(), *pair_of(*place, what), turned(*place)});
  return PairModel(std::move(nodes));
}

// Whether places are near enough to each other to show what happens between them: the pair moves by `most_turns` at
// most, and no other exponent moves against it by more than it decays faster, wherever modulation may shift them.
enum class Motion { unknown, too_far, followed };
Motion motion_between(const Place& p, const Place& q) {
  if (p.mean().size() != q.mean().size() || p.mean().size() < 2) return Motion::unknown;
  const std::array<std::size_t, 2> slow = slowest(p.mean());
  if (slow[0] == slow[1] || slow != slowest(q.mean())) return Motion::unknown;
  double pair = 0, growth = HUGE_VAL;
  for (const std::size_t n : slow) {
    pair = std::max(pair, moved(p.mean()[n], q.mean()[n]));
    for (const MeanExponent* mean : {&p.mean()[n], &q.mean()[n]})
      growth = std::min(growth, mean->value.real() - mean->drift);
  }
  bool followed = pair <= most_turns;
  for (std::size_t n = 0; n < p.mean().size(); ++n) {
    if (n == slow[0] || n == slow[1]) continue;
    const MeanExponent &a = p.mean()[n], &b = q.mean()[n];
    const double faster = growth - std::max(a.value.real() + a.drift, b.value.real() + b.drift),
                 against = moved(p.mean()[n], q.mean()[n]) + pair;
    if (against <= faster) continue;
    followed = false;
    if (!(against <= (faster >= much_faster ? most_too_far_of_those : most_too_far) * faster)) return Motion::unknown;
  }
  return followed ? Motion::followed : pair <= most_too_far * most_turns ? Motion::too_far : Motion::unknown;
}

// The growth at either end of the interval is no more than the straight line from the nearest place beyond the other
// end foretells. Two zeros of c next to each other between p and q, whose logarithm the growth contains, turn it
// upwards.
bool is_concave(const std::vector<const Place*>& places) {
  const Place &p = *places[0], &q = *places[1];
  const auto below_line = [&](const Place& from, const Place& by, const Place& to) {
    const double slope = (by.growth() - from.growth()) / (by.x() - from.x());
    return to.growth() <= by.growth() + slope * (to.x() - by.x());
  };
  const auto beside = [&](bool above) {
    return std::find_if(places.begin() + 2, places.end(), [&](const Place* r) { return (r->x() > q.x()) == above; });
  };
  const auto left = beside(false), right = beside(true);
  if (left == places.end() || right == places.end()) return false;
  return below_line(**left, p, q) && below_line(**right, q, p);
}

}  // namespace

bool is_apart(const Place& place, Apart what) { return is_apart(pair_of(place, what), what, place.sample); }

bool is_apart(const StabilitySample& sample) {
  return is_apart(leading_pair(sample), Apart::pair, sample) || is_apart(leading_alone(sample), Apart::alone, sample);
}

std::optional<double> doubtful_while_apart(const std::vector<const Place*>& places, Apart what, double least) {
  const Place &p = *places[0], &q = *places[1];
  const double middle = 0.5 * (p.x() + q.x());
  const double others = others_between(*pair_of(p, what), *pair_of(q, what));
  if (!(std::min(pair_of(p, what)->lower, pair_of(q, what)->lower) > others)) return std::nullopt;
  const Motion motion = motion_between(p, q);
  if (motion == Motion::unknown) return std::nullopt;
  if (motion == Motion::too_far || places.size() < fewest_nodes) return middle;
  const PairModel model = model_of(places, what);
  double worst = p.unstable ? 0 : least, where = nan;
  for (const double x : model.telling()) {
    const auto [growth, lowest] = model.bounds(x);
    if (!(lowest > others))
      return what == Apart::alone || model.lower(x) > others ? std::optional(middle) : std::nullopt;
    const double beyond = p.unstable ? -growth.low : growth.high;
    if (beyond < worst) continue;
    worst = beyond;
    where = x;
  }
  if (std::isnan(where)) return where;
  // A change that is foretold is looked at where it should be.
  const bool foretold = (model.predicted(where) > 0) != p.unstable;
  const double margin = (foretold ? 1e-6 : 0.02) * (q.x() - p.x());
  return std::clamp(where, p.x() + margin, q.x() - margin);
}

bool stays_leading(const std::vector<const Place*>& places, Apart what) {
  const LeadingPair &a = *pair_of(*places[0], what), &b = *pair_of(*places[1], what);
  if (std::min(a.half_trace, b.half_trace) < -1 && std::max(a.half_trace, b.half_trace) > 1) return false;
  if (what == Apart::alone && !is_concave(places)) return false;
  return std::min(a.lower, b.lower) - std::abs(a.lower - b.lower) > others_between(a, b);
}

bool foretold(const std::vector<const Place*>& places, Apart what, const Place& between) {
  if (!is_apart(between, what) || between.unstable != places[0]->unstable) return false;
  if (what == Apart::alone && between.alone()->half_trace != places[0]->alone()->half_trace) return false;
  const GrowthBounds growth = model_of(places, what).leading(between.x());
  return growth.low <= between.growth() + between.growth_error() &&
         between.growth() - between.growth_error() <= growth.high;
}

std::optional<std::array<double, 2>> expected_change(const std::vector<const Place*>& places) {
  if (places.size() < fewest_nodes) return std::nullopt;
  const PairModel model = model_of(places, Apart::pair);
  const double from = places[0]->x(), width = places[1]->x() - from;
  const bool unstable = places[0]->unstable;
  constexpr int looks = 32, halvings = 30;
  double low = 0, high = 1.0 / looks;  // parts of the interval
  const auto beyond = [&](double part) { return (model.predicted(from + part * width) > 0) != unstable; };
  while (high < 1 && !beyond(high)) {
    low = high;
    high += 1.0 / looks;
  }
  if (high >= 1) return std::nullopt;
  for (int k = 0; k < halvings; ++k) (beyond(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  // As far as a third of the growth's error moves it: what the last term alone would tell, or more.
  const double x = from + high * width, step = 1e-4 * width;
  const GrowthBounds growth = model.leading(x);
  const double slope = std::abs(model.predicted(x + step) - model.predicted(x - step)) / (2 * step);
  const double off = (growth.high - growth.low) / (6 * slope);
  if (!(off < 0.25 * width)) return std::nullopt;
  return std::array{x - off, x + off};
}

}  // namespace hb
