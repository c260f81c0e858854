#include "hb/engine/boundaries/mode_tracks.hpp"

#include <algorithm>
#include <cmath>

#include "lib/constants.hpp"

namespace hb {

namespace {

// Beside distances in units of the crank's speed: an exponent that the solver gave to another mode is believed less.
constexpr double renaming_penalty = 0.05;
// ... and not at all beyond this.
constexpr double farthest_renamed = 0.5;

// Two exponents of one mode: a conjugate pair, or two that are locked to the crank (or overdamped).
struct Pair {
  double growth, growth_low;
  double folded;  // |Im|
  double frequency;  // as named
  int mode;
};

std::vector<Pair> pairs_of(const Stability& stability) {
  const std::vector<Exponent>& all = stability.exponents;
  std::vector<bool> used(all.size(), false);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (used[i]) continue;
    used[i] = true;
    // The partner: its conjugate; else the next one of the same mode.
    std::size_t partner = all.size();
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      if (used[j]) continue;
      const double bar = all[i].error + all[j].error + 1e-13 * std::abs(all[i].value);
      if (all[i].value.imag() != 0 && std::abs(all[j].value - std::conj(all[i].value)) <= bar) {
        partner = j;
        break;
      }
      if (partner == all.size() && all[j].mode == all[i].mode) partner = j;
    }
    Pair pair{all[i].value.real(), all[i].value.real(), std::abs(all[i].value.imag()), all[i].frequency, all[i].mode};
    if (partner < all.size()) {
      used[partner] = true;
      pair.growth_low = all[partner].value.real();
    }
    pairs.push_back(pair);
  }
  return pairs;
}

// Of |+-folded + k Omega| the one that continues what is expected; where two nearly do, the one nearer to the frequency
// that the solver named, so that a wrong turn is not followed further and further.
double unfolded(const Pair& pair, double speed, double expected) {
  constexpr double weight_of_name = 0.3;  // chosen by experiment
  double best = pair.frequency, least = HUGE_VAL;
  for (const double near : {expected, pair.frequency}) {
    for (const double sign : {1.0, -1.0}) {
      const double middle = std::round((near - sign * pair.folded) / speed);
      for (const double k : {middle - 1, middle, middle + 1}) {
        const double frequency = std::abs(sign * pair.folded + k * speed);
        const double distance = std::abs(frequency - expected) + weight_of_name * std::abs(frequency - pair.frequency);
        if (distance < least) {
          least = distance;
          best = frequency;
        }
      }
    }
  }
  // The motion's main harmonic is the one followed or one beside it; further off the expectation has gone astray.
  constexpr double farthest_from_name = 1.25;
  const double off = std::abs(best - pair.frequency);
  return off <= 1e-9 * speed || off > farthest_from_name * speed ? pair.frequency : best;
}

}  // namespace

std::vector<ModeState> modes_by_name(const Stability& stability, int num_modes) {
  std::vector<ModeState> states(static_cast<std::size_t>(num_modes), ModeState{nan, nan, nan});
  std::vector<Pair> homeless;
  for (const Pair& pair : pairs_of(stability)) {
    const auto mode = static_cast<std::size_t>(pair.mode);
    if (mode < states.size() && std::isnan(states[mode].frequency)) {
      states[mode] = {pair.frequency, pair.growth, pair.growth_low};
    } else {
      homeless.push_back(pair);
    }
  }
  for (const Pair& pair : homeless) {
    const auto free =
        std::find_if(states.begin(), states.end(), [](const ModeState& s) { return std::isnan(s.frequency); });
    if (free != states.end()) *free = {pair.frequency, pair.growth, pair.growth_low};
  }
  return states;
}

std::vector<ModeState> modes_by_continuity(const Stability& stability, double speed,
                                           const std::vector<ModeState>& expected) {
  const std::vector<Pair> pairs = pairs_of(stability);
  struct Match {
    double distance;
    std::size_t pair, mode;
    double frequency;
  };
  std::vector<Match> matches;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (std::size_t m = 0; m < expected.size(); ++m) {
      const bool renamed = pairs[p].mode != static_cast<int>(m);
      const ModeState& state = expected[m];
      if (std::isnan(state.frequency)) {  // nothing to be near to: the name decides, after all others
        if (!renamed) matches.push_back({1e3, p, m, pairs[p].frequency});
        continue;
      }
      const double frequency = unfolded(pairs[p], speed, state.frequency);
      const double damping = -0.5 * (pairs[p].growth + pairs[p].growth_low);
      const double distance =
          std::hypot(frequency - state.frequency, damping - state.damping()) / speed + (renamed ? renaming_penalty : 0);
      if (renamed && distance > farthest_renamed) continue;
      matches.push_back({distance, p, m, frequency});
    }
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Match& a, const Match& b) { return a.distance < b.distance; });
  std::vector<ModeState> states(expected.size(), ModeState{nan, nan, nan});
  std::vector<bool> used(pairs.size(), false), taken(expected.size(), false);
  for (const Match& match : matches) {
    if (used[match.pair] || taken[match.mode]) continue;
    used[match.pair] = taken[match.mode] = true;
    states[match.mode] = {match.frequency, pairs[match.pair].growth, pairs[match.pair].growth_low};
  }
  return states;
}

std::vector<std::vector<ModeState>> track_modes(const std::vector<TrackedPlace>& places, int num_modes) {
  const std::vector<ModeState> unknown(static_cast<std::size_t>(num_modes), ModeState{nan, nan, nan});
  std::vector<std::vector<ModeState>> tracks(places.size(), unknown);
  // Last two places where each mode was seen.
  struct Seen {
    double x;
    ModeState state;
  };
  std::vector<std::vector<Seen>> seen(static_cast<std::size_t>(num_modes));
  bool started = false;
  for (std::size_t p = 0; p < places.size(); ++p) {
    const TrackedPlace& place = places[p];
    if (place.stability == nullptr) continue;
    if (!started) {
      tracks[p] = modes_by_name(*place.stability, num_modes);
      started = true;
    } else {
      std::vector<ModeState> expected = unknown;
      for (std::size_t m = 0; m < expected.size(); ++m) {
        if (seen[m].empty()) continue;
        const Seen& last = seen[m].back();
        expected[m] = last.state;
        if (seen[m].size() == 2 && last.x > seen[m].front().x) {
          const Seen& first = seen[m].front();
          const double reach = (place.x - last.x) / (last.x - first.x);
          // Frequencies go on straight, unless they have just been unfolded anew; growth rates have corners where pairs
          // lock.
          const bool steady = std::abs(last.state.frequency - first.state.frequency) <= 0.75 * place.speed;
          if (reach <= 3 && steady) expected[m].frequency += reach * (last.state.frequency - first.state.frequency);
        }
        expected[m].frequency = std::abs(expected[m].frequency);
      }
      tracks[p] = modes_by_continuity(*place.stability, place.speed, expected);
    }
    for (std::size_t m = 0; m < seen.size(); ++m) {
      if (std::isnan(tracks[p][m].frequency)) continue;
      if (seen[m].size() == 2) seen[m].erase(seen[m].begin());
      seen[m].push_back({place.x, tracks[p][m]});
    }
  }
  return tracks;
}

}  // namespace hb
