#include "hb/analysis/sweep/resonances.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "lib/constants.hpp"

namespace hb {
namespace {

// A peak this far from n = omega/Omega, in orders, is not named after that mode.
constexpr double most_detuning = 0.3;
// A maximum lower than this above its valleys, relative, is not told from rounding.
constexpr double least_prominence = 1e-8;

std::optional<ResponseSample> sample_at(const RodAlong& rod, double x) {
  const std::optional<FourierSeries> q = rod.rough_response(x);
  if (!q) return std::nullopt;
  const Eigen::VectorXd largest = fourier::largest_values(*q);
  return ResponseSample{x, {largest.begin(), largest.end()}};
}

// Samples of q_j about x, on both flanks, and where it still climbs there a few steps beyond, as far as the ends of the
// interval: whether there is a top the values at these tell, too. None where no linkage or no response is.
std::vector<ResponseSample> round_top(const RodAlong& rod, double x, double flank, double low, double high,
                                      std::size_t j) {
  constexpr int most_steps = 3;
  std::vector<ResponseSample> samples;
  const auto add = [&](double place) {
    std::optional<ResponseSample> sample = sample_at(rod, place);
    if (!sample) return false;
    samples.insert(std::ranges::lower_bound(samples, place, {}, &ResponseSample::x), std::move(*sample));
    return true;
  };
  if (!add(x - flank) || !add(x) || !add(x + flank)) return {};
  const auto height = [j](const ResponseSample& sample) { return sample.max_abs[j]; };
  for (int step = 0; step <= most_steps; ++step) {
    const auto top = std::ranges::max_element(samples, {}, height);
    const bool first = top == samples.begin(), last = top + 1 == samples.end();
    const double next = first ? samples.front().x - flank : samples.back().x + flank;
    if ((!first && !last) || !(next > low && next < high)) break;
    if (!add(next)) return {};
  }
  return samples;
}

// The interval between two places.
struct Interval {
  const RodAlong& rod;
  const ResponsePlace &a, &b;
  Eigen::VectorXd mean_a, mean_b;  // frequencies of the averaged system at the ends, over the speed
};

// Where mode j is met by n Omega, given that it is: by the averaged system's frequency, off by what it is off at both
// ends in proportion; without it on a straight line.
double crossing(const Interval& interval, std::size_t j, double n) {
  constexpr int most_steps = 8;
  constexpr double enough = 1e-3;  // of the interval
  const auto& [rod, a, b, mean_a, mean_b] = interval;
  const auto of_mode = [mode = static_cast<Eigen::Index>(j)](const Eigen::VectorXd& frequencies) {
    return frequencies.size() > 0 ? frequencies(mode) : nan;
  };
  const double first = a.modes[j].frequency / a.speed - n, last = b.modes[j].frequency / b.speed - n;
  const double off_a = first + n - of_mode(mean_a), off_b = last + n - of_mode(mean_b);
  double low = 0, high = 1, f_low = first, f_high = last, t = first / (first - last);
  for (int step = 0; step < most_steps; ++step) {
    const double f = of_mode(rod.mean_frequencies(a.x + t * (b.x - a.x))) + off_a + t * (off_b - off_a) - n;
    if (!std::isfinite(f)) break;
    (f * f_low > 0 ? low : high) = t;
    (f * f_low > 0 ? f_low : f_high) = f;
    const double next = low + (high - low) * f_low / (f_low - f_high);
    const bool settled = std::abs(next - t) < enough;
    t = next;
    if (settled) break;
  }
  return a.x + t * (b.x - a.x);
}

int largest_component(const std::vector<double>& values) {
  return static_cast<int>(std::max_element(values.begin(), values.end()) - values.begin());
}

void add_maxima(const std::vector<ResponseSample>& samples, int component, std::vector<Maximum>& maxima) {
  const auto value = [&](std::size_t k) { return samples[k].max_abs[static_cast<std::size_t>(component)]; };
  for (std::size_t k = 1; k + 1 < samples.size(); ++k) {
    if (!(value(k) > value(k - 1) && value(k) >= value(k + 1))) continue;
    if (largest_component(samples[k].max_abs) != component) continue;
    // Valleys: down to where it climbs again on either side.
    std::size_t left = k - 1, right = k + 1;
    while (left > 0 && value(left - 1) <= value(left)) --left;
    while (right + 1 < samples.size() && value(right + 1) <= value(right)) ++right;
    const double prominence = 1 - std::max(value(left), value(right)) / value(k);
    if (prominence > least_prominence)
      maxima.push_back({component, samples[k - 1].x, samples[k].x, samples[k + 1].x, prominence});
  }
}

}  // namespace

std::vector<ResponseSample> resonances_between(const RodAlong& rod, const ResponsePlace& a, const ResponsePlace& b) {
  constexpr double least_flank = 0.02;  // of the interval: crossings are foretold better than that
  constexpr double on_point = 1e-6;  // of the interval: rounding makes tops of samples that lie closer together
  std::vector<ResponseSample> found;
  std::optional<Interval> interval;
  const int most = std::max(a.num_harmonics, b.num_harmonics);
  for (std::size_t j = 0; j < a.modes.size() && j < std::max(a.max_abs.size(), b.max_abs.size()); ++j) {
    const double first = a.modes[j].frequency / a.speed, last = b.modes[j].frequency / b.speed;
    if (!std::isfinite(first) || !std::isfinite(last)) continue;
    const double low = std::min(first, last), high = std::max(first, last);
    const double half_width = 0.5 * std::abs(a.modes[j].damping() / a.speed + b.modes[j].damping() / b.speed);
    // Wide enough to show on the points themselves.
    if (!(half_width < 2 * (high - low))) continue;
    for (double n = std::max(1.0, std::floor(low) + 1); n < high && n <= most; ++n) {
      if (!interval) interval.emplace(Interval{rod, a, b, rod.mean_frequencies(a.x), rod.mean_frequencies(b.x)});
      const double x = crossing(*interval, j, n), width = b.x - a.x;
      const double flank =
          std::min({std::max(3 * half_width / (high - low), least_flank) * width, 0.5 * (x - a.x), 0.5 * (b.x - x)});
      if (flank < on_point * width) continue;  // a or b is a sample itself
      std::vector<ResponseSample> here = round_top(rod, x, flank, a.x, b.x, j);
      found.insert(found.end(), std::make_move_iterator(here.begin()), std::make_move_iterator(here.end()));
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& p, const auto& q) { return p.x < q.x; });
  return found;
}

std::vector<ResponseSample> samples_inside(const RodAlong& rod, double a, double b) {
  constexpr int parts = 3;
  std::vector<ResponseSample> samples;
  for (int part = 1; part < parts; ++part)
    if (std::optional<ResponseSample> sample = sample_at(rod, a + (b - a) * part / parts))
      samples.push_back(std::move(*sample));
  return samples;
}

std::vector<ResponseSample> beside_pole(const RodAlong& rod, double x, double distance) {
  std::vector<ResponseSample> samples;
  constexpr double nearer = 0.7;
  for (const double place : {x - distance, x + nearer * distance})
    if (std::optional<ResponseSample> sample = sample_at(rod, place)) samples.push_back(std::move(*sample));
  return samples.size() == 2 ? samples : std::vector<ResponseSample>();
}

std::vector<Maximum> local_maxima(const std::vector<ResponseSample>& samples, int num_components) {
  std::vector<Maximum> maxima;
  for (int component = 0; component < num_components; ++component) add_maxima(samples, component, maxima);
  return maxima;
}

std::optional<int> order_met(const ModeState& mode, double speed) {
  const double turns = mode.frequency / speed;
  if (!(std::isfinite(turns) && turns >= 0.5 && std::abs(turns - std::round(turns)) <= most_detuning))
    return std::nullopt;
  return static_cast<int>(std::lround(turns));
}

}  // namespace hb
