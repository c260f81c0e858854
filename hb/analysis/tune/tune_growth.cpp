#include "hb/analysis/tune/tune_growth.hpp"

#include <algorithm>
#include <cmath>

#include "hb/analysis/accuracy.hpp"
#include "hb/analysis/tune/tune_quantities.hpp"
#include "hb/engine/boundaries/interval_search.hpp"
#include "hb/engine/exponents/growth_bound.hpp"

namespace hb {
namespace {

class GrowthSearch {
 public:
  GrowthSearch(const HillSystem& system, const std::vector<RequiredDecay>& required, const Settings& settings,
               const Work& work, const std::vector<double>& speeds)
      : system_(system), required_(required), settings_(settings), work_(work), speeds_(speeds) {
    sweep_.stability = exponent_options(settings);
    // The largest decay first: where that holds the others do.
    std::ranges::stable_sort(required_, std::ranges::greater(),
                             [&](const RequiredDecay& r) { return r.at(speeds[0]); });
  }

  std::vector<double> run(std::vector<double>& growth) {
    const std::size_t count = speeds_.size();
    prove();
    known_.resize(count);
    work_.for_each(count, [&](std::size_t k) {
      const ScaledSystem scaled = scale_system(system_, speeds_[k]);
      known_[k] = searched_near(k) ? analyse_stability(scaled, exponent_options(settings_))
                                   : leading_stability(scaled, settings_);
    });
    growth.clear();
    for (const Stability& stability : known_) growth.push_back(growth_of(stability));
    const bool unstable = std::ranges::any_of(growth, [](double g) { return g > 0; });
    std::vector<std::vector<double>> found(count);
    for (const RequiredDecay& decay : required_) {
      // Beside an instability what decays too slowly is not the worst.
      if (unstable && decay.bound > 0) continue;
      search(decay, found);
    }
    std::vector<double> all;
    for (const std::vector<double>& speeds : found) all.insert(all.end(), speeds.begin(), speeds.end());
    std::ranges::sort(all);
    all.erase(std::ranges::unique(all).begin(), all.end());
    return all;
  }

 private:
  double largest_decay(double speed) const {
    double most = 0;
    for (const RequiredDecay& decay : required_) most = std::max(most, decay.at(speed));
    return most;
  }
  // On the whole interval: all are linear in the speed.
  bool is_largest(const RequiredDecay& decay, std::size_t k) const {
    return decay.at(speeds_[k]) == largest_decay(speeds_[k]) &&
           decay.at(speeds_[k + 1]) == largest_decay(speeds_[k + 1]);
  }
  // Upper bound of the growth rate, 1/time, over what is asked for: negative is enough.
  double bound_at(double speed) const {
    return speed * growth_bound(scale_system(system_, speed)) + largest_decay(speed);
  }

  // Intervals with more to spare at both ends and in the middle than the bound changes.
  void prove() {
    const std::size_t count = speeds_.size();
    std::vector<double> bounds(count);
    work_.for_each(count, [&](std::size_t k) { bounds[k] = bound_at(speeds_[k]); });
    clear_.assign(count - 1, 0);
    work_.for_each(count - 1, [&](std::size_t k) {
      const double a = bounds[k], b = bounds[k + 1];
      if (!(std::max(a, b) + std::abs(a - b) < 0)) return;
      const double m = bound_at(0.5 * (speeds_[k] + speeds_[k + 1]));
      clear_[k] = std::max({a, b, m}) + std::max(std::abs(a - m), std::abs(b - m)) < 0 ? 1 : 0;
    });
  }

  // Searches of intervals look at two speeds on either side.
  bool searched_near(std::size_t k) const {
    const std::size_t first = k < 2 ? 0 : k - 2, last = std::min(k + 2, clear_.size());
    for (std::size_t j = first; j < last; ++j)
      if (clear_[j] == 0) return true;
    return false;
  }

  void search(const RequiredDecay& decay, std::vector<std::vector<double>>& found) {
    const std::size_t count = speeds_.size();
    std::vector<StabilitySample> samples;
    for (std::size_t k = 0; k < count; ++k)
      samples.push_back({speeds_[k], speeds_[k], shifted(known_[k], decay.at(speeds_[k])), {}});
    const SystemAt at = [&](double speed) {
      return std::optional<ScaledSystem>(scale_system(shifted(system_, decay.at(speed)), speed));
    };
    work_.for_each(count - 1, [&](std::size_t k) {
      if (clear_[k] != 0) return;
      const SearchedInterval interval =
          search_interval(at, samples[k], samples[k + 1], k > 0 ? &samples[k - 1] : nullptr,
                          k + 2 < count ? &samples[k + 2] : nullptr, sweep_);
      for (const StabilitySample& sample : interval.samples) found[k].push_back(sample.x);
      const bool stable =
          samples[k].stability.verdict == Verdict::stable && samples[k + 1].stability.verdict == Verdict::stable;
      if (stable && interval.boundaries.empty() && interval.not_excluded.empty() && is_largest(decay, k)) clear_[k] = 1;
    });
  }

  const HillSystem& system_;
  std::vector<RequiredDecay> required_;
  const Settings& settings_;
  const Work& work_;
  const std::vector<double>& speeds_;
  SweepOptions sweep_;
  std::vector<Stability> known_;
  std::vector<char> clear_;  // intervals in which nothing decays slower than is still to be looked for
};

}  // namespace

std::vector<double> unstable_speeds(const HillSystem& system, const std::vector<RequiredDecay>& required,
                                    const Settings& settings, const Work& work, const std::vector<double>& speeds,
                                    std::vector<double>& growth) {
  return GrowthSearch(system, required, settings, work, speeds).run(growth);
}

}  // namespace hb
