#include "tools/output/shape_rows.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "tools/output/wording.hpp"

namespace hb::tools {
namespace {

std::string peak_row(const char* name, const RodPeak& peak, std::optional<double> error, double factor,
                     const std::string& unit, const OutputUnits& units) {
  constexpr int unjudged = 4;
  const double value = peak.max_abs * factor;
  const int digits = error ? std::min(8, trusted_digits(value, *error * factor)) : unjudged;
  return fmt::format("  {:<16}  {:.{}g} {} at x = {:.4g} {}, crank angle {:.2f} deg{}\n", name, value, digits, unit,
                     peak.x, units.length, peak.crank_angle * degrees_per_radian,
                     error ? fmt::format("; error {:.1e} {}", *error * factor, unit) : "");
}

}  // namespace

std::string deflection_row(const RodPeak& peak, const std::optional<PeakErrors>& errors, const OutputUnits& units) {
  return peak_row("deflection", peak, errors ? std::optional(errors->deflection) : std::nullopt, 1, units.length,
                  units);
}

std::string moment_row(const RodPeak& peak, const std::optional<PeakErrors>& errors, const OutputUnits& units) {
  return peak_row("bending moment", peak, errors ? std::optional(errors->bending_moment) : std::nullopt, units.moment,
                  "N m", units);
}

}  // namespace hb::tools
