#include "hb/analysis/sweep/resonances.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "hb/analysis/accuracy.hpp"

namespace hb {
namespace {

// A peak this far from n = omega/Omega, in orders, is not named after that mode.
constexpr double most_detuning = 0.3;
// A maximum lower than this above its valleys, relative, is not told from rounding.
constexpr double least_prominence = 1e-8;

std::optional<ResponseSample> sample_at(const RodAlong& rod, double x) {
  const std::optional<FourierSeries> q = rod.response(x, peak_accuracy(rod.settings()).rough);
  if (!q) return std::nullopt;
  ResponseSample sample{x, {}};
  for (Eigen::Index i = 0; i < q->num_components(); ++i) sample.max_abs.push_back(fourier::max_abs(*q, i).value);
  return sample;
}

// Samples on both flanks and on top, or none where no linkage or no response is.
std::vector<ResponseSample> flanks_and_top(const RodAlong& rod, double x, double flank) {
  std::vector<ResponseSample> samples;
  for (const double place : {x - flank, x, x + flank}) {
    std::optional<ResponseSample> sample = sample_at(rod, place);
    if (!sample) return {};
    samples.push_back(std::move(*sample));
  }
  return samples;
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
  std::vector<ResponseSample> found;
  const int most = std::max(a.num_harmonics, b.num_harmonics);
  for (std::size_t j = 0; j < a.modes.size() && j < std::min(a.max_abs.size(), b.max_abs.size()); ++j) {
    const double first = a.modes[j].frequency / a.speed, last = b.modes[j].frequency / b.speed;
    if (!std::isfinite(first) || !std::isfinite(last)) continue;
    const double low = std::min(first, last), high = std::max(first, last);
    const double half_width = 0.5 * (a.modes[j].damping() / a.speed + b.modes[j].damping() / b.speed);
    // Wide enough to show on the points themselves, or growing.
    if (!(half_width > 0 && half_width < 2 * (high - low))) continue;
    for (double n = std::max(1.0, std::floor(low) + 1); n < high && n <= most; ++n) {
      const double t = (n - first) / (last - first), x = a.x + t * (b.x - a.x);
      const double flank = std::min({3 * half_width / (high - low) * (b.x - a.x), 0.5 * (x - a.x), 0.5 * (b.x - x)});
      std::vector<ResponseSample> here = flanks_and_top(rod, x, flank);
      if (!here.empty() && here[1].max_abs[j] > std::max(a.max_abs[j], b.max_abs[j]))
        found.insert(found.end(), std::make_move_iterator(here.begin()), std::make_move_iterator(here.end()));
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& p, const auto& q) { return p.x < q.x; });
  return found;
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
