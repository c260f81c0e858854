#include "hb/analysis/static_deflection.hpp"

#include <cmath>

#include "hb/analysis/linkage_analysis.hpp"
#include "hb/analysis/nearest_resonance.hpp"

namespace hb {
namespace {

constexpr double above_rounding = 1e-15;  // harmonics of q that count, of the largest

// Of C = C0 + Omega C1 + Omega^2 C2 and h alike only C0 q = h0 is left at Omega = 0.
std::optional<RodPeak> with_modes(const Body& link, const RodCoefficients& rod, Eigen::Index num_modes) {
  const HillSystem system = ritz_system(link, rod, num_modes);
  if (system.load[0].c.size() == 0) return RodPeak{};
  const std::optional<Eigen::MatrixXd> q = quasi_static_motion(system, num_modes, 0);
  if (!q) return std::nullopt;
  const FourierSeries series = fourier::analyse(*q);
  return largest_deflection(link, rod, 0,
                            fourier::resized(series, fourier::significant_harmonics(series, above_rounding)));
}

}  // namespace

std::optional<StaticDeflection> static_deflection(const Body& link, const RodCoefficients& rod,
                                                  Eigen::Index num_modes) {
  const std::optional<RodPeak> peak = with_modes(link, rod, num_modes),
                               finer = with_modes(link, rod, comparison_modes(num_modes));
  if (!peak || !finer) return std::nullopt;
  constexpr double safety = 2;  // as of the error of the cut
  return StaticDeflection{*peak, safety * std::abs(peak->max_abs - finer->max_abs)};
}

}  // namespace hb
