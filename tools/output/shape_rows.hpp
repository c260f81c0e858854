// Rows of tables for the largest deflection and bending moment of a rod.
#pragma once

#include <optional>
#include <string>

#include "hb/analysis/cut_error.hpp"
#include "tools/output/output_units.hpp"

namespace hb::tools {

// With as many digits as the errors leave; without errors, as many as a picture needs.
[[nodiscard]] std::string deflection_row(const RodPeak& peak, const std::optional<PeakErrors>& errors,
                                         const OutputUnits& units);
[[nodiscard]] std::string moment_row(const RodPeak& peak, const std::optional<PeakErrors>& errors,
                                     const OutputUnits& units);

}  // namespace hb::tools
