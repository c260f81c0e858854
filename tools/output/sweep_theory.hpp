// Theory errors along a sweep of what belongs to the whole mechanism, joint forces, torque and growth rate, beside
// those of each rod's q and deflection.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "hb/analysis/sweep_analysis.hpp"
#include "tools/output/csv_output.hpp"

namespace hb::tools {

// Adds joints_theory_error, torque_theory_error, growth_theory_error, each over the points, where asked for.
void add_theory(nlohmann::ordered_json& document, const SweepScene& scene, const SweepResult& result);

// Lines of the table: the largest of each, and where; where the growth rate's is not less than the rate itself.
[[nodiscard]] std::string theory_rows(const SweepScene& scene, const SweepResult& result);

// Of each point and refined point all theory errors.
[[nodiscard]] CsvFile sweep_theory_csv(const SweepScene& scene, const SweepResult& result);

}  // namespace hb::tools
