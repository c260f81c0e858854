#include "hb/analysis/expected_time.hpp"

#include <algorithm>
#include <cmath>

namespace hb {

namespace {

// Harmonics above rounding.
Eigen::Index harmonics_that_count(const FourierSeries& series) {
  constexpr double negligible = 1e-14;
  const double largest = series.c.size() == 0 ? 0 : series.c.cwiseAbs().maxCoeff();
  Eigen::Index H = series.num_harmonics();
  while (H > 0 && !(series.c.col(H).cwiseAbs().maxCoeff() > negligible * largest)) --H;
  return H;
}

}  // namespace

// With H harmonics and I modes H^1.5 (I^2 + 4), fitted to slider-cranks with H from 800 to 4100 and I from 2 to 8,
// which took 0.7 to 1.4 times as long; 0.6 of it for the exponents.
double expected_seconds(const SceneModel& model, const Settings& settings) {
  constexpr double per_harmonic = 1.2e-4, harmonics = 4096, for_exponents = 0.6;
  double seconds = 0;
  for (const RodModel& rod : model.rods) {
    Eigen::Index most = 0;
    for (const FourierSeries& series : rod.system.stiffness) most = std::max(most, harmonics_that_count(series));
    const auto H = std::min(static_cast<double>(most), harmonics), I = static_cast<double>(rod.num_modes);
    seconds += per_harmonic * H * std::sqrt(H / harmonics) * (I * I + 4);
  }
  const Only& only = settings.only;
  if (only.stability && settings.stability_method == StabilityMethod::determinant) {
    // Three circles, more are rare, and one for the winding, I + 2 values on each; harmonics are limited (measured).
    constexpr double circles = 4, per_value = 0.004, longest_value = 0.3;
    for (const RodModel& rod : model.rods) {
      const auto I = static_cast<double>(rod.system.num_modes());
      seconds += circles * (I + 2) * std::min(per_value * I * I, longest_value);
    }
    return seconds;
  }
  const bool response = only.response();
  return seconds * ((only.all_exponents() ? for_exponents : 0) + (response ? 1 - for_exponents : 0));
}

}  // namespace hb
