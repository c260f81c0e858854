#include "hb/analysis/tune/tune_stress.hpp"

#include <fmt/core.h>

#include "hb/analysis/request.hpp"
#include "hb/analysis/rod_stress.hpp"

namespace hb {
namespace {

// sigma(x, tau) = N/F + side M h/(2 J), N = EJ (f4 + f3 x - f2 x^2/2) of lib/README.md (M4).
RodFunctional fibre_stress(const Body& link, const RodCoefficients& rod, double speed, Eigen::Index num_modes,
                           Eigen::Index num_harmonics, double x, int side, double crank_angle) {
  const Elastic& elastic = *link.elastic;
  const Eigen::VectorXd f = fourier::evaluate(axial_series(rod, speed), crank_angle);
  const double N = elastic.youngs_modulus * elastic.second_moment * (f(2) + x * f(1) - 0.5 * x * x * f(0));
  RodFunctional result =
      rod_functional(link, rod, speed, num_modes, num_harmonics, RodQuantity::bending_moment, x, crank_angle);
  const double per_moment = side * elastic.section_height / (2 * elastic.second_moment);
  result.offset = N / elastic.area + per_moment * result.offset;
  result.g.c *= per_moment;
  return result;
}

}  // namespace

StressPeak stress_peak(MetricKind kind, const StressCycle& cycle, const Strength& strength) {
  StressPeak peak{cycle.max_abs,     cycle.error, cycle.x, cycle.side, cycle.crank_angle,
                  cycle.crank_angle, false,       false,   ""};
  if (kind == MetricKind::total_stress) return peak;
  peak.value = 0;
  if (cycle.yield) {
    peak.value = cycle.max_abs / strength.yield;
    peak.error = cycle.error / strength.yield;
    peak.against = "yielding";
  }
  if (!cycle.fatigue) return peak;
  const FatigueSafety& fatigue = *cycle.fatigue;
  const double usage = fatigue_usage(strength, fatigue.mean, fatigue.amplitude);
  if (usage <= peak.value) return peak;
  return {usage,
          fatigue_usage(strength, cycle.error, cycle.error),
          fatigue.x,
          fatigue.side,
          fatigue.largest_at,
          fatigue.smallest_at,
          true,
          fatigue.mean > 0,
          fmt::format("fatigue ({})", to_string(fatigue_line(strength)))};
}

void require_strength(const Body& link, const Metric& metric) {
  const Strength& strength = link.elastic->strength;
  if (metric.kind != MetricKind::safety || strength.yield > 0 || fatigue_line(strength) != FatigueLine::none) return;
  const std::string& name = link.name;
  const std::string found = strength.endurance > 0 ? fmt::format("{0}.endurance without {0}.tensile or {0}.yield", name)
                            : strength.tensile > 0 ? fmt::format("{0}.tensile without {0}.endurance", name)
                                                   : fmt::format("no strength of {}", name);
  throw RequestError(metric.text, found,
                     fmt::format("{0}.yield (against yielding), {0}.endurance beside {0}.tensile or {0}.yield (against "
                                 "fatigue): keys of its elastic table, or @set {0}.yield=\"250 MPa\"",
                                 name));
}

RodFunctional stress_functional(MetricKind kind, const Body& link, const RodCoefficients& rod, double speed,
                                Eigen::Index num_modes, Eigen::Index num_harmonics, const StressPeak& peak,
                                double part_of_length) {
  const auto at = [&](double crank_angle) {
    return fibre_stress(link, rod, speed, num_modes, num_harmonics, part_of_length * link.length, peak.side,
                        crank_angle);
  };
  RodFunctional largest = at(peak.largest_at);
  const Strength& strength = link.elastic->strength;
  if (!peak.fatigue) {
    const double factor = kind == MetricKind::safety ? 1 / strength.yield : 1;
    largest.offset *= factor;
    largest.g.c *= factor;
    return largest;
  }
  // 1/n = (s - t)/(2 S_e) + max(s + t, 0)/(2 S) of the largest s and the smallest t
  const double most = fatigue_line(strength) == FatigueLine::goodman ? strength.tensile : strength.yield;
  const double of_mean = peak.mean_counts ? 1 / (2 * most) : 0, of_amplitude = 1 / (2 * strength.endurance);
  const RodFunctional smallest = at(peak.smallest_at);
  RodFunctional result = largest;
  result.offset = (of_mean + of_amplitude) * largest.offset + (of_mean - of_amplitude) * smallest.offset;
  result.g.c = (of_mean + of_amplitude) * largest.g.c + (of_mean - of_amplitude) * smallest.g.c;
  return result;
}

}  // namespace hb
