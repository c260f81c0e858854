#include "hb/engine/boundaries/mode_tracks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/constants.hpp"

namespace hb {

namespace {

// Beside distances in units of the crank's speed: an exponent that the solver gave to another mode is believed less.
constexpr double renaming_penalty = 0.05;
// ... and not at all beyond this.
constexpr double farthest_renamed = 0.5;

constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();

// Two exponents that may be one mode's: a conjugate pair, or two real multipliers of one sign (locked to the crank, or
// overdamped), each with the name and frequency that the solver gave it; or one whose partner is not there.
struct Pair {
  std::size_t first, second;  // places among the exponents
  double growth, growth_low;
  double folded;  // |Im|
  bool locked;
  std::array<double, 2> frequency;
  std::array<int, 2> mode;

  [[nodiscard]] bool named(int m) const { return mode[0] == m || mode[1] == m; }
  // Of the two frequencies the one nearer to this.
  [[nodiscard]] double frequency_near(double expected) const {
    return std::abs(frequency[1] - expected) < std::abs(frequency[0] - expected) ? frequency[1] : frequency[0];
  }
};

Pair pair_of(const std::vector<Exponent>& all, std::size_t i, std::size_t j, bool locked) {
  const Exponent &a = all[i], &b = j == nobody ? all[i] : all[j];
  return {i,
          j,
          std::max(a.value.real(), b.value.real()),
          std::min(a.value.real(), b.value.real()),
          std::abs(a.value.imag()),
          locked,
          {a.frequency, b.frequency},
          {a.mode, b.mode}};
}

// Conjugates belong together. Those without one have real multipliers: any two of one sign may be a mode's.
std::vector<Pair> pairs_of(const Stability& stability) {
  const std::vector<Exponent>& all = stability.exponents;
  const auto bar = [&](std::size_t i, std::size_t j) {
    return all[i].error + all[j].error + 1e-13 * std::abs(all[i].value);
  };
  std::vector<bool> used(all.size(), false);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size() && !used[i]; ++j)
      if (!used[j] && all[i].value.imag() != 0 && std::abs(all[j].value - std::conj(all[i].value)) <= bar(i, j)) {
        used[i] = used[j] = true;
        pairs.push_back(pair_of(all, i, j, false));
      }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (used[i]) continue;
    bool alone = true;
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (j == i || used[j]) continue;
      const double apart = std::abs(std::abs(all[i].value.imag()) - std::abs(all[j].value.imag()));
      if (!(apart <= bar(i, j) + 1e-9 * std::abs(all[i].value.imag()))) continue;
      alone = false;
      if (j > i) pairs.push_back(pair_of(all, i, j, true));
    }
    if (alone) pairs.push_back(pair_of(all, i, nobody, true));
  }
  return pairs;
}

// Of |+-folded + k Omega| the one that continues what is expected; where two nearly do, the one nearer to the frequency
// that the solver named, so that a wrong turn is not followed further and further.
double unfolded(const Pair& pair, double speed, double expected) {
  constexpr double weight_of_name = 0.3;  // chosen by experiment
  const double name = pair.frequency_near(expected);
  double best = name, least = HUGE_VAL;
  for (const double near : {expected, name}) {
    for (const double sign : {1.0, -1.0}) {
      const double middle = std::round((near - sign * pair.folded) / speed);
      for (const double k : {middle - 1, middle, middle + 1}) {
        const double frequency = std::abs(sign * pair.folded + k * speed);
        const double distance = std::abs(frequency - expected) + weight_of_name * std::abs(frequency - name);
        if (distance < least) {
          least = distance;
          best = frequency;
        }
      }
    }
  }
  // The motion's main harmonic is the one followed or one beside it; further off the expectation has gone astray.
  constexpr double farthest_from_name = 1.25;
  const double off = std::abs(best - name);
  return off <= 1e-9 * speed || off > farthest_from_name * speed ? name : best;
}

// A locked mode stays at its multiple of half the speed for as long as it is locked.
double locked_frequency(const Pair& pair, double speed, double expected) {
  double best = pair.folded;
  for (const double sign : {1.0, -1.0}) {
    const double k = std::round((expected - sign * pair.folded) / speed);
    const double frequency = std::abs(sign * pair.folded + k * speed);
    if (std::abs(frequency - expected) < std::abs(best - expected)) best = frequency;
  }
  return best;
}

bool taken(const Pair& pair, const std::vector<bool>& used) {
  return used[pair.first] || (pair.second != nobody && used[pair.second]);
}

void take(const Pair& pair, std::vector<bool>& used) {
  used[pair.first] = true;
  if (pair.second != nobody) used[pair.second] = true;
}

}  // namespace

// The leading exponents first; one with a real multiplier pairs with another of its name before any other.
std::vector<ModeState> modes_by_name(const Stability& stability, int num_modes) {
  const std::vector<Exponent>& all = stability.exponents;
  const std::vector<Pair> pairs = pairs_of(stability);
  std::vector<ModeState> states(static_cast<std::size_t>(num_modes), ModeState{nan, nan, nan}), homeless;
  std::vector<bool> used(all.size(), false);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (used[i]) continue;
    Pair pair = pair_of(all, i, nobody, true);
    bool found = false;
    for (const Pair& other : pairs) {
      if ((other.first != i && other.second != i) || taken(other, used)) continue;
      if (!found || (pair.mode[0] != pair.mode[1] && other.mode[0] == other.mode[1])) pair = other;
      found = true;
    }
    take(pair, used);
    bool housed = false;
    for (std::size_t k = 0; k < 2 && !housed; ++k) {
      const auto mode = static_cast<std::size_t>(pair.mode[k]);
      housed = mode < states.size() && std::isnan(states[mode].frequency);
      if (housed) states[mode] = {pair.frequency[k], pair.growth, pair.growth_low, pair.locked};
    }
    if (!housed) homeless.push_back({pair.frequency[0], pair.growth, pair.growth_low, pair.locked});
  }
  for (const ModeState& state : homeless) {
    const auto free =
        std::find_if(states.begin(), states.end(), [](const ModeState& s) { return std::isnan(s.frequency); });
    if (free != states.end()) *free = state;
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
      const Pair& pair = pairs[p];
      const bool renamed = !pair.named(static_cast<int>(m));
      const ModeState& state = expected[m];
      if (std::isnan(state.frequency)) {  // nothing to be near to: the name decides, after all others
        if (!renamed) matches.push_back({1e3, p, m, pair.frequency[0]});
        continue;
      }
      const bool stays = state.locked && pair.locked;
      const double frequency =
          stays ? locked_frequency(pair, speed, state.frequency) : unfolded(pair, speed, state.frequency);
      const double damping = -0.5 * (pair.growth + pair.growth_low);
      // Which two of several belong together: their mean stays, and where they were locked before, how far they are
      // apart.
      const double spread = stays ? 0.5 * ((pair.growth - pair.growth_low) - (state.growth - state.growth_low)) : 0;
      const double distance = std::hypot(frequency - state.frequency, damping - state.damping(), spread) / speed +
                              (renamed ? renaming_penalty : 0);
      if (renamed && distance > farthest_renamed) continue;
      matches.push_back({distance, p, m, frequency});
    }
  }
  if (!std::ranges::is_sorted(matches, {}, &Match::distance)) std::ranges::stable_sort(matches, {}, &Match::distance);
  std::vector<ModeState> states(expected.size(), ModeState{nan, nan, nan});
  std::vector<bool> used(stability.exponents.size(), false), settled(expected.size(), false);
  for (const Match& match : matches) {
    const Pair& pair = pairs[match.pair];
    if (taken(pair, used) || settled[match.mode]) continue;
    take(pair, used);
    settled[match.mode] = true;
    states[match.mode] = {match.frequency, pair.growth, pair.growth_low, pair.locked};
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
